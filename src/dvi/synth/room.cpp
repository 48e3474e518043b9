#include "dvi/synth/room.h"

#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "dvi/synth/facade.h"

namespace dvi::synth {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kHalfLengthM = 3.5, kHalfWidthM = 2.7, kHeightM = 2.6;
constexpr double kRoomPixelsPerMeter = 160;

TexturePtr to_texture(Canvas& canvas, Random& random, const Noise& noise, double amplitude = 4) {
  roughen(canvas.picture, noise, amplitude, {random.below(512), random.below(512)});
  return std::make_shared<Texture>(canvas.picture);
}

// Paints wallpaper with a pattern, a skirting board, and pictures.
TexturePtr paint_wallpaper(Random random, const Noise& noise, double length, bool window) {
  const double gray = random.uniform(165, 200);
  const cv::Scalar base(gray * random.uniform(0.82, 1), gray * random.uniform(0.9, 1), gray);
  Canvas canvas(length, kHeightM, kRoomPixelsPerMeter, base);
  const cv::Scalar pattern = base * random.uniform(0.8, 0.9);
  for (double x = 0.1; x < length; x += 0.2)
    for (double z = 0.1; z < kHeightM; z += 0.25) canvas.disc(x + 0.1 * (static_cast<int>(z * 4) % 2), z, 0.02, pattern);
  for (double x = 0; x < length; x += 0.8) canvas.line({x, 0}, {x, kHeightM}, pattern, 2);
  for (double x = random.uniform(0.3, 0.7); x < length - 0.9; x += random.uniform(1.1, 1.6)) {
    const double w = random.uniform(0.45, 0.8), h = random.uniform(0.4, 0.7), z = random.uniform(1.2, 1.6);
    canvas.box({x - 0.05, z - 0.05, w + 0.1, h + 0.1}, {40, 55, 80});
    canvas.box({x, z, w, h}, random_color(random, 60, 220));
    for (int i = 0; i < 14; ++i) {
      const double bw = random.uniform(0.05, 0.3 * w), bh = random.uniform(0.04, 0.3 * h);
      const cv::Scalar color = random_color(random, 20, 240);
      const double above = random.uniform(0, h - bh);
      canvas.box({x + random.uniform(0, w - bw), z + above, bw, bh}, color);
    }
  }
  if (window) {
    const double x = 0.38 * length;
    canvas.box({x - 0.1, 0.85, 1.6, 1.5}, {225, 230, 232});
    canvas.box({x, 0.95, 1.4, 1.3}, {226, 208, 190});
    canvas.box({x, 0.95, 1.4, 0.45}, {120, 150, 120});
    canvas.box({x + 0.67, 0.95, 0.06, 1.3}, {225, 230, 232});
    canvas.box({x, 1.55, 1.4, 0.05}, {225, 230, 232});
  }
  canvas.box({0, 0, length, 0.1}, {90, 110, 130});
  return to_texture(canvas, random, noise);
}

TexturePtr paint_planks(Random random, const Noise& noise) {
  Canvas canvas(2 * kHalfLengthM, 2 * kHalfWidthM, 120, {82, 120, 158});
  for (int row = 0; row * 0.14 < canvas.height(); ++row)
    for (double x = random.uniform(-1.2, 0); x < canvas.width();) {
      const double length = random.uniform(0.7, 1.5);
      canvas.box({x, row * 0.14, length, 0.14}, cv::Scalar(82, 120, 158) * random.uniform(0.75, 1.15));
      canvas.line({x, row * 0.14}, {x, row * 0.14 + 0.14}, {40, 62, 84}, 2);
      x += length;
    }
  for (double z = 0; z < canvas.height(); z += 0.14) canvas.line({0, z}, {canvas.width(), z}, {46, 68, 92}, 1);
  canvas.box({2.1, 1.5, 2.4, 1.7}, {70, 50, 130});  // a rug
  for (double x = 2.2; x < 4.4; x += 0.3)
    for (double z = 1.6; z < 3.1; z += 0.3) canvas.disc(x + 0.1, z + 0.05, 0.09, random_color(random, 60, 210));
  canvas.frame({2.15, 1.55, 2.3, 1.6}, {180, 200, 210}, 5);
  return to_texture(canvas, random, noise, 6);
}

TexturePtr paint_books(Random random, const Noise& noise, double width, double height) {
  Canvas canvas(width, height, kRoomPixelsPerMeter, {52, 72, 96});
  for (double z = 0.06; z + 0.3 < height; z += 0.36) {
    canvas.box({0.04, z, width - 0.08, 0.32}, {30, 38, 46});
    for (double x = 0.05; x < width - 0.1;) {
      const double w = random.uniform(0.025, 0.07), h = random.uniform(0.18, 0.3);
      if (random.below(7) != 0) {
        canvas.box({x, z, w, h}, random_color(random, 30, 220));
        canvas.box({x, z + 0.7 * h, w, 0.015}, {220, 220, 220});
      }
      x += w + 0.004;
    }
  }
  return to_texture(canvas, random, noise);
}

class Furnisher {
 public:
  Furnisher(std::uint64_t seed, const Noise& noise) : seed_(seed), noise_(noise) {}

  Solid furnish() {
    add_walls();
    add_shelf(3.28, -0.9, 1.5, 2.0);
    add_table(1.4, 1.2);
    add_cabinet(2.9, 1.9);
    add_box({2.4, -2.1, 0}, {0.6, 0.55, 0.5}, 0.3);
    add_box({2.45, -2.05, 0.5}, {0.42, 0.4, 0.35}, -0.2);
    add_box({0.6, -1.9, 0}, {0.5, 0.4, 0.45}, 0.7);
    add_stand(1.9, -0.35);
    add_plant(3.0, 0.55);
    room_.finish();
    return std::move(room_);
  }

 private:
  Random random(int number) const { return make_random(seed_, 120, number); }
  TexturePtr make_plain_picture(int number, const cv::Scalar& color) const {
    return paint_plain(random(number), noise_, color, 9);
  }

  void add_walls() {
    const double x = kHalfLengthM, y = kHalfWidthM, z = kHeightM;
    const auto wall = [&](const Vector2d& left, const Vector2d& right, int number) {
      room_.add({{left.x(), left.y(), 0}, {right.x(), right.y(), 0}, {left.x(), left.y(), z}, {right.x(), right.y(), z}},
                paint_wallpaper(random(number), noise_, (right - left).norm(), number == 1));
    };
    wall({x, y}, {x, -y}, 0);
    wall({-x, y}, {x, y}, 1);
    wall({x, -y}, {-x, -y}, 2);
    wall({-x, -y}, {-x, y}, 3);
    room_.add({{-x, -y, 0}, {x, -y, 0}, {-x, y, 0}, {x, y, 0}}, paint_planks(random(4), noise_));
    room_.add({{-x, y, z}, {x, y, z}, {-x, -y, z}, {x, -y, z}}, make_plain_picture(5, {205, 210, 212}));
  }

  struct Block {
    double length, width, low, high;
  };
  void add_block(const Block& block, const Faces& faces, const SE3& place) {
    Solid solid;
    const double l = 0.5 * block.length;
    add_frustum(solid, {-l, l, 0.5 * block.width, block.low}, {-l, l, 0.5 * block.width, block.high}, faces);
    room_.add(solid, place);
  }
  static SE3 at(double x, double y, double yaw = 0) { return {so3_exp({0, 0, yaw}), {x, y, 0}}; }
  static Faces all(const TexturePtr& texture) { return {texture, texture, texture, texture, texture}; }

  void add_shelf(double x, double y, double width, double height) {
    const TexturePtr wood = make_plain_picture(10, {52, 72, 96});
    add_block({0.36, width, 0, height}, {wood, wood, wood, paint_books(random(11), noise_, width, height), wood}, at(x, y));
  }

  void add_table(double x, double y) {
    Random dice = random(12);
    Canvas top(1.5, 0.8, kRoomPixelsPerMeter, {60, 92, 128});
    for (double z = 0; z < 0.8; z += 0.05) top.line({0, z}, {1.5, z + 0.02}, {48, 76, 108}, 2);
    for (int i = 0; i < 6; ++i) {
      const cv::Scalar color = random_color(dice, 90, 235);
      const double z = dice.uniform(0, 0.5);
      top.box({dice.uniform(0, 1.2), z, 0.21, 0.29}, color);
    }
    const TexturePtr wood = make_plain_picture(13, {55, 85, 120});
    add_block({0.8, 1.5, 0.7, 0.75}, {wood, wood, wood, wood, to_texture(top, dice, noise_)}, at(x, y));
    for (const double dx : {-0.34, 0.34})
      for (const double dy : {-0.68, 0.68}) add_block({0.06, 0.06, 0, 0.7}, all(wood), at(x + dx, y + dy));
    add_block({0.25, 0.35, 0.75, 1.0}, all(paint_sign(random(14), noise_, 0.35, 0.25)), at(x + 0.1, y - 0.3, 0.4));
  }

  void add_cabinet(double x, double y) {
    Random dice = random(15);
    Canvas doors(1.2, 1.1, kRoomPixelsPerMeter, {140, 160, 176});
    for (const double left : {0.03, 0.62}) {
      doors.frame({left, 0.06, 0.55, 0.98}, {70, 84, 100}, 4);
      doors.disc(left + (left < 0.5 ? 0.48 : 0.07), 0.55, 0.025, {40, 44, 48});
      for (double z = 0.15; z < 1; z += 0.12) doors.line({left + 0.08, z}, {left + 0.47, z}, {112, 130, 146}, 3);
    }
    const TexturePtr wood = make_plain_picture(16, {130, 150, 168});
    add_block({0.5, 1.2, 0, 1.1}, {wood, wood, wood, to_texture(doors, dice, noise_), wood}, at(x, y));
  }

  void add_box(const Vector3d& foot, const Vector3d& size, double yaw) {
    const TexturePtr side = paint_sign(random(20 + static_cast<int>(100 * (foot.x() + foot.z()))), noise_, size.y(), size.z());
    const TexturePtr lid = make_plain_picture(17, {96, 140, 176});
    add_block({size.x(), size.y(), foot.z(), foot.z() + size.z()}, {side, side, side, side, lid, false},
              at(foot.x(), foot.y(), yaw));
  }

  // The stand is as high as a person, but static.
  void add_stand(double x, double y) {
    const TexturePtr wood = make_plain_picture(18, {44, 58, 78}), cloth = make_plain_picture(19, {60, 50, 120});
    room_.add_cylinder({x, y, 0}, 0.03, 1.75, wood);
    add_block({0.4, 0.4, 0, 0.04}, all(wood), at(x, y));
    Solid coat;
    add_frustum(coat, {-0.14, 0.14, 0.24, 0.75}, {-0.08, 0.08, 0.16, 1.55}, all(cloth));
    room_.add(coat, at(x, y, 0.3));
  }

  void add_plant(double x, double y) {
    const TexturePtr pot = make_plain_picture(21, {70, 90, 160});
    add_block({0.3, 0.3, 0, 0.35}, all(pot), at(x, y));
    const TexturePtr leaves = paint_leaves(random(22), 0.5);
    for (int i = 0; i < 3; ++i) {
      const Eigen::Matrix3d turn = so3_exp({0, 0, i * std::numbers::pi / 3});
      const Vector3d right = turn * Vector3d(0.32, 0, 0), foot(x, y, 0.3), up(0, 0, 0.75);
      Surface& leaf = room_.add({foot - right, foot + right, foot - right + up, foot + right + up}, leaves);
      leaf.lit = false;
      leaf.tint = {0.8F, 0.8F, 0.8F};
    }
  }

  std::uint64_t seed_;
  const Noise& noise_;
  Solid room_;
};

// Moves back and forth between -1 and 1 at constant speed; the period is 4.
double move_back_and_forth(double length) {
  const double phase = length - 4 * std::floor(length / 4);
  return phase < 2 ? phase - 1 : 3 - phase;
}

}  // namespace

Solid make_room(const SynthOptions& options, const Noise& noise) {
  return Furnisher(static_cast<std::uint64_t>(options.seed), noise).furnish();
}

Light make_room_light(int day) {
  const double evening = day % 2 == 1 ? 1 : 0.8;
  const cv::Vec3f lamp(0.5F, 0.54F, 0.58F), walls(0.5F, 0.5F, 0.5F);
  return {Vector3d(-0.35, 0.3, 0.89).normalized(), lamp * evening, walls * evening};
}

SE3 world_from_hand(const SynthOptions& options, double time) {
  const double p = time + 2.3 * (options.day - 1);
  const double side = -1.3 * std::cos(0.42 * p + 0.25), y = side + 0.02 * std::sin(5.1 * p),
               x = -2.9 + 0.25 * std::sin(0.5 * p);
  const double yaw = -0.13 * side + 0.03 * std::sin(1.7 * p), pitch = 0.12 + 0.02 * std::sin(2.3 * p),
               roll = 0.015 * std::sin(1.9 * p + 1);
  return {so3_exp({0, 0, yaw}) * so3_exp({0, pitch, 0}) * so3_exp({roll, 0, 0}), {x, y, 1.45 + 0.02 * std::sin(3.7 * p)}};
}

std::vector<Mover> make_visitors(const SynthOptions& options, const Noise& noise) {
  constexpr double kReachM = 2.2, kSpeedMps = 1.1;
  const double start = 0.3 + 0.7 * (options.day - 1);
  const auto place = [=](double t) { return Vector2d(0.3, kReachM * move_back_and_forth(start + kSpeedMps / kReachM * t)); };
  return {{0, make_walker(make_random(static_cast<std::uint64_t>(options.seed), 23, options.day), noise), place}};
}

cv::Mat1w simulate_depth(const cv::Mat1f& depth, double noise_5m, Random random) {
  cv::Mat1f near, far;
  cv::erode(depth, near, {});
  cv::dilate(depth, far, {});
  cv::Mat1w out(depth.size(), ushort{0});
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x) {
      const double z = depth(y, x), error = noise_5m * (z / 5) * (z / 5) * random.normal();
      const bool beside_jump = noise_5m > 0 && far(y, x) - near(y, x) > 0.1 * z;
      if (z > 0 && !beside_jump) out(y, x) = cv::saturate_cast<ushort>(1000 * (z + error));
    }
  return out;
}

}  // namespace dvi::synth
