#include "dvi/synth/models.h"

#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

namespace dvi::synth {

using Eigen::Vector3d;

void add_frustum(Solid& solid, const Rectangle& low, const Rectangle& high, const Faces& faces) {
  const auto corner = [](const Rectangle& r, bool front, bool left) {
    return Vector3d(front ? r.front : r.back, left ? r.half_width : -r.half_width, r.z);
  };
  const auto face = [&](bool front0, bool left0, bool front1, bool left1, const TexturePtr& texture, bool mirrored) {
    if (!texture) return;
    Surface& surface = solid.add(
        {corner(low, front0, left0), corner(low, front1, left1), corner(high, front0, left0), corner(high, front1, left1)},
        texture);
    if (mirrored) surface.part = cv::Rect2d(texture->width(), 0, -texture->width(), texture->height());
  };
  face(true, true, false, true, faces.left, false);
  face(false, false, true, false, faces.right, faces.mirrored);
  face(true, false, true, true, faces.front, false);
  face(false, true, false, false, faces.back, false);
  if (faces.top)
    solid.add({corner(high, false, true), corner(high, false, false), corner(high, true, true), corner(high, true, false)},
              faces.top);
}

void add_limb(Solid& solid, const Limb& limb, const TexturePtr& cloth) {
  const auto& [low, high, half_width] = limb;
  Solid part;
  add_frustum(part, {low.x() - half_width, low.x() + half_width, half_width, low.z()},
              {high.x() - half_width, high.x() + half_width, half_width, high.z()}, {cloth, cloth, cloth, cloth, cloth});
  solid.add(part, {Eigen::Matrix3d::Identity(), {0, low.y(), 0}});
}

TexturePtr paint_plain(Random random, const Noise& noise, const cv::Scalar& color, double amplitude) {
  cv::Mat3b picture = make_plain_picture(128, 128, color);
  roughen(picture, noise, amplitude, {random.below(512), random.below(512)});
  return std::make_shared<Texture>(picture);
}

TexturePtr paint_leaves(Random random, double cover) {
  constexpr int kSize = 256;
  cv::Mat3b picture = make_plain_picture(kSize, kSize, {32, 62, 44});
  cv::Mat1b alpha(kSize, kSize, uchar{0});
  const double autumn = random.uniform(-12, 18);
  // The mean area of a clump of leaves below is 510 pixels; clumps are placed at random and overlap.
  const double clumps = -std::log(1 - cover) * kSize * kSize / 510;
  for (int i = 0; i < 1500; ++i) {
    const cv::Point at(random.below(kSize), random.below(kSize));
    const double shade = random.uniform(0.55, 1.35);
    const cv::Scalar color(38 * shade, (92 + autumn) * shade, (62 + 2 * autumn) * shade);
    const cv::Size axes(5 + random.below(7), 3 + random.below(4));
    const double angle = random.uniform(0, 180);
    cv::ellipse(picture, at, axes, angle, 0, 360, color, cv::FILLED, cv::LINE_AA);
    if (i < clumps) cv::ellipse(alpha, at, axes * 2, angle, 0, 360, 255, cv::FILLED);
  }
  // The boundary is round, so that crossing planes do not show their rectangles.
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      constexpr double kMiddle = kSize / 2.0;
      const double r = std::hypot(x - kMiddle, y - kMiddle) / kMiddle;
      if (r > 0.86 + 0.1 * std::sin(7 * std::atan2(y - kSize / 2, x - kSize / 2))) alpha(y, x) = 0;
    }
  return std::make_shared<Texture>(picture, alpha);
}

Model make_tree(Random random, const TexturePtr& bark, const TexturePtr& leaves) {
  Model model{"tree", {}, {3.6, 3.6, 7}};
  const double trunk = random.uniform(2.2, 2.8);
  model.solid.add_cylinder({0, 0, 0}, random.uniform(0.11, 0.18), trunk + 1.2, bark);
  for (int i = 0; i < 18; ++i) {
    const double angle = random.uniform(0, 2 * std::numbers::pi), reach = random.uniform(0.2, 1.1);
    const Vector3d center(reach * std::cos(angle), reach * std::sin(angle), trunk + random.uniform(0.5, 2.9));
    const Eigen::Matrix3d turn = so3_exp({random.uniform(-0.9, 0.9), random.uniform(-0.9, 0.9), random.uniform(0, 6.28)});
    const double half = random.uniform(0.7, 1.15);
    const Vector3d right = turn * Vector3d(half, 0, 0), up = turn * Vector3d(0, 0, half);
    Surface& surface =
        model.solid.add({center - right - up, center + right - up, center - right + up, center + right + up}, leaves);
    surface.lit = false;
    // The crown is darker inside.
    const auto shade = static_cast<float>(0.72 + 0.25 * reach + 0.08 * (center.z() - trunk));
    surface.tint = {shade, shade, shade};
  }
  model.solid.finish();
  return model;
}

Model make_hedge(double length, const TexturePtr& planter, const TexturePtr& leaves) {
  Model model{"hedge", {}, {length, 0.6, 1.3}};
  const double half = 0.5 * length;
  add_frustum(model.solid, {-half, half, 0.28, 0}, {-half, half, 0.3, 0.42}, {planter, planter, planter, planter, planter});
  for (int layer = 0; layer < 3; ++layer)
    for (double x = -half; x < half - 0.1; x += 0.55) {
      const double y = 0.22 * (layer - 1), top = 1.1 + 0.1 * std::sin(9 * x + 2 * layer);
      Surface& surface =
          model.solid.add({{x - 0.2, y, 0.25}, {x + 0.75, y, 0.25}, {x - 0.2, y, top}, {x + 0.75, y, top}}, leaves);
      surface.lit = false;
      if (layer == 1) surface.tint = {0.7F, 0.7F, 0.7F};
    }
  model.solid.finish();
  return model;
}

}  // namespace dvi::synth
