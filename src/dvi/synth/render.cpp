#include "dvi/synth/render.h"

#include <cmath>

#include "dvi/core/threads.h"

namespace dvi::synth {
namespace {

using Eigen::Vector3d;

constexpr int kEdgeSamples = 3;  // per side

struct Layer {
  cv::Mat1i id;
  cv::Mat1f depth;
  cv::Mat1b dynamic;
  cv::Mat3b image;
};

class Painter {
 public:
  explicit Painter(const ExposedCamera& exposed)
      : camera_(exposed.camera),
        world_from_camera_(exposed.camera_from_world.inverse()),
        gain_(static_cast<float>(exposed.gain)) {}

  /// Paints the pixels of `wanted`.
  void paint(const Tracer& tracer, const cv::Mat1b& wanted, Layer& canvas) const {
    std::vector<std::vector<Tracer::Seen>> seen(static_cast<std::size_t>(wanted.rows));
    parallel_for(seen.size(), [&](std::size_t row) {
      const int y = static_cast<int>(row);
      seen[row].resize(static_cast<std::size_t>(wanted.cols));
      for (int x = 0; x < wanted.cols; ++x) {
        if (!wanted(y, x)) continue;
        Tracer::Seen& center = seen[row][static_cast<std::size_t>(x)];
        center = tracer.trace(ray(x, y));
        canvas.id(y, x) = center.id;
        canvas.depth(y, x) = std::isfinite(center.t) ? static_cast<float>(center.t) : 0.0F;
        canvas.dynamic(y, x) = center.dynamic ? 255 : 0;
      }
    });
    parallel_for(seen.size(), [&](std::size_t row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < wanted.cols; ++x) {
        if (!wanted(y, x)) continue;
        const cv::Vec3f color = at_edge(canvas.id, x, y) ? average(tracer, x, y, canvas.dynamic(y, x))
                                                         : tracer.shade(ray(x, y), seen[row][static_cast<std::size_t>(x)]);
        for (int c = 0; c < 3; ++c) canvas.image(y, x)[c] = cv::saturate_cast<uchar>(color[c] * gain_);
      }
    });
  }

  /// Marks the pixels that a mover or its shadow may change.
  void mark(const PlacedMover& placed, const Vector3d& to_sun, cv::Mat1b& wanted) const {
    if (camera_.is_wide()) {  // the hull of the corners is not that of their images
      wanted.setTo(255);
      return;
    }
    const Vector3d size = placed.model->size + Vector3d::Constant(2 * kShadowReachM);
    const Box box{placed.world_from_mover * SE3{Eigen::Matrix3d::Identity(), {0, 0, 0.5 * placed.model->size.z()}}, size};
    std::vector<Vector3d> corners;
    for (const Vector3d& corner : box.corners()) {
      corners.push_back(corner);
      if (placed.mover->walks()) corners.emplace_back(corner - to_sun * (size.z() / to_sun.z()));
    }
    const SE3 camera_from_world = world_from_camera_.inverse();
    Eigen::AlignedBox2d area;
    std::size_t behind = 0;
    for (const Vector3d& corner : corners) {
      const Vector3d x = camera_from_world * corner;
      if (x.z() < 0.3)
        ++behind;
      else
        area.extend(camera_.project(x));
    }
    if (behind == corners.size()) return;
    if (behind > 0) area.extend(Eigen::Vector2d::Zero()).extend(Eigen::Vector2d(wanted.cols, wanted.rows));
    const Eigen::Vector2d limit(wanted.cols, wanted.rows);
    const Eigen::Vector2d low = area.min().cwiseMax(-2.0).cwiseMin(limit), high = area.max().cwiseMax(-2.0).cwiseMin(limit);
    const cv::Rect rect(cv::Point(static_cast<int>(low.x()) - 2, static_cast<int>(low.y()) - 2),
                        cv::Point(static_cast<int>(high.x()) + 3, static_cast<int>(high.y()) + 3));
    const cv::Rect inside = rect & cv::Rect({}, wanted.size());
    if (!inside.empty()) wanted(inside).setTo(255);
  }

 private:
  Ray ray(double x, double y) const {
    if (camera_.is_distorted()) {
      const Vector3d here = camera_.ray({x, y});
      const Eigen::Matrix3d& R = world_from_camera_.R;
      return {world_from_camera_.t, R * here, R * (camera_.ray({x + 1, y}) - here), R * (camera_.ray({x, y + 1}) - here)};
    }
    const Vector3d step_x = world_from_camera_.R.col(0) / camera_.fx, step_y = world_from_camera_.R.col(1) / camera_.fy;
    const Vector3d direction = world_from_camera_.R.col(2) + step_x * (x - camera_.cx) + step_y * (y - camera_.cy);
    return {world_from_camera_.t, direction, step_x, step_y};
  }

  static bool at_edge(const cv::Mat1i& id, int x, int y) {
    const int here = id(y, x);
    return (x > 0 && id(y, x - 1) != here) || (x + 1 < id.cols && id(y, x + 1) != here) || (y > 0 && id(y - 1, x) != here) ||
           (y + 1 < id.rows && id(y + 1, x) != here);
  }

  cv::Vec3f average(const Tracer& tracer, int x, int y, uchar& dynamic) const {
    cv::Vec3f sum(0, 0, 0);
    for (int i = 0; i < kEdgeSamples * kEdgeSamples; ++i) {
      const int column = i % kEdgeSamples, row = i / kEdgeSamples;
      const double u = (column + 0.5) / kEdgeSamples - 0.5, v = (row + 0.5) / kEdgeSamples - 0.5;
      const Ray sample = ray(x + u, y + v);
      const Tracer::Seen seen = tracer.trace(sample);
      if (seen.dynamic) dynamic = 255;
      sum += tracer.shade(sample, seen, 1.0 / kEdgeSamples);
    }
    return sum * (1.0F / (kEdgeSamples * kEdgeSamples));
  }

  const Camera& camera_;
  SE3 world_from_camera_;
  float gain_;
};

}  // namespace

SynthFrame render(const StaticWorld& world, std::vector<PlacedMover> movers, const ExposedCamera& exposed) {
  const cv::Size size(exposed.camera.width, exposed.camera.height);
  const Painter painter(exposed);
  Layer still{cv::Mat1i(size), cv::Mat1f(size), cv::Mat1b(size), cv::Mat3b(size)};
  painter.paint(Tracer(world, {}), cv::Mat1b(size, 255), still);

  cv::Mat1b wanted(size, uchar{0});
  for (const PlacedMover& mover : movers) painter.mark(mover, world.light.to_sun, wanted);
  Layer busy{still.id.clone(), still.depth.clone(), cv::Mat1b(size, uchar{0}), still.image.clone()};
  painter.paint(Tracer(world, std::move(movers)), wanted, busy);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      if (busy.image(y, x) != still.image(y, x)) busy.dynamic(y, x) = 255;
  return {busy.image, still.image, still.depth, busy.depth, busy.dynamic};
}

}  // namespace dvi::synth
