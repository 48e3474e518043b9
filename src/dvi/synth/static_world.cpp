#include "dvi/synth/static_world.h"

#include <array>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "dvi/core/threads.h"
#include "dvi/geometry/angles.h"
#include "dvi/synth/facade.h"
#include "dvi/synth/models.h"
#include "dvi/synth/room.h"

namespace dvi::synth {
namespace {

using Eigen::Vector3d;

constexpr double kBeginM = -50, kViewM = 110;  // houses close the street at both ends

Street make_street(const SynthOptions& options) {
  if (options.turn_deg == 0) return {};
  const double turn = to_radians(options.turn_deg);
  // The radius is limited by the houses on the inner side.
  const double length = std::max(0.6 * options.distance(), 24 * std::abs(turn));
  return {0.2 * options.distance() + 4, length, turn};
}

// Odd days are clear, the others overcast. The position of the sun differs between pairs of days.
bool is_clear(int day) { return day % 2 == 1; }

Light make_light(int day) {
  const int pair = (day - 1) / 2;
  const Eigen::Matrix3d later = so3_exp({0, 0, 0.6 * pair});
  if (is_clear(day)) return {later * Vector3d(-0.35, -0.55, 0.75).normalized(), {0.44F, 0.5F, 0.54F}, {0.68F, 0.63F, 0.6F}};
  return {later * Vector3d(0.5, 0.45, 0.75).normalized(), {0.27F, 0.26F, 0.25F}, {0.65F, 0.6F, 0.56F}};
}

struct House {
  int side = 1, number = 0;  ///< side: +1 left, -1 right, 0 across the street
  double begin = 0, end = 0, height = 0;
};

std::vector<House> make_row(std::uint64_t seed, int side, double begin, double end) {
  std::vector<House> row;
  Random random = make_random(seed, 31 + side, 0);
  for (double s = begin; s < end;) {
    House house{side, static_cast<int>(row.size()), s, s + random.uniform(8, 16), random.uniform(7.5, 15)};
    s = house.end;
    row.push_back(house);
  }
  return row;
}

/// Adds the objects of a street to one Solid and collects their shade.
class Builder {
 public:
  Builder(const SynthOptions& options, const Noise& noise, const Street& street)
      : options_(options),
        noise_(noise),
        street_(street),
        seed_(static_cast<std::uint64_t>(options.seed)),
        sun_(make_light(options.day).to_sun),
        end_(options.distance() + kViewM) {}

  void build() {
    std::vector<House> houses = make_row(seed_, 1, kBeginM, end_ + 12);
    for (const House& house : make_row(seed_, -1, kBeginM, end_ + 12)) houses.push_back(house);
    std::vector<TexturePtr> fronts(houses.size());
    for_blocks(houses.size(), [&](std::size_t first, std::size_t last) {
      parallel_for(last - first, [&](std::size_t i) { fronts[first + i] = paint(houses[first + i]); });
      Texture::page_out();
    });
    for (std::size_t i = 0; i < houses.size(); ++i) place_house(houses[i], fronts[i]);
    close(kBeginM, 0);
    close(end_, 1);
    place_curbs();
    place_furniture();
    place_parked_cars();
    if (options_.changes) place_sites();
    solid.finish();
  }

  double end() const { return end_; }
  Solid solid;
  std::vector<Shade> shades;

 private:
  Random random(std::uint64_t kind, int number) const { return make_random(seed_, kind, number); }
  Vector3d at(double s, double d, double z) const {
    const Eigen::Vector2d p = street_.point(s, d);
    return {p.x(), p.y(), z};
  }

  // A house with a changed front is another house of the same shape.
  bool is_changed(const House& house) const { return options_.changes && random(55 + house.side, house.number).below(3) == 0; }

  TexturePtr paint(const House& house) const {
    return paint_facade(random((is_changed(house) ? 48 : 41) + house.side, house.number), noise_, house.end - house.begin,
                        house.height);
  }

  void place_house(const House& house, const TexturePtr& front) {
    const bool left = house.side > 0;
    const double d = left ? kLeftFacadeM : kRightFacadeM, back = d + (left ? 9 : -9), h = house.height;
    const double s0 = left ? house.begin : house.end, s1 = left ? house.end : house.begin;
    solid.add({at(s0, d, 0), at(s1, d, 0), at(s0, d, h), at(s1, d, h)}, front);
    // Gables are visible above lower neighbors.
    const TexturePtr wall = paint_plain(random(51, 2 * house.number + left), noise_, {120, 130, 142});
    for (const double s : {house.begin, house.end}) solid.add({at(s, back, 0), at(s, d, 0), at(s, back, h), at(s, d, h)}, wall);
    place_signs(house, d, left ? -1 : 1);
    const double reach = h / sun_.z();
    const bool toward_street = left ? sun_.y() > 0 : sun_.y() < 0;
    if (!toward_street) return;
    const double ds = -sun_.x() * reach, dd = -sun_.y() * reach;
    shades.push_back({{{house.begin, back},
                       {house.begin, d},
                       {house.begin + ds, d + dd},
                       {house.end + ds, d + dd},
                       {house.end, d},
                       {house.end, back}},
                      is_clear(options_.day) ? 0.36 : 0.16,
                      is_clear(options_.day) ? 0.12 : 0.4});
  }

  void place_signs(const House& house, double d, double inward) {
    Random dice = random((is_changed(house) ? 65 : 61) + house.side, house.number);
    if (dice.below(3) != 0) {  // a blade sign across the pavement
      const double s = dice.uniform(house.begin + 1, house.end - 1), z = dice.uniform(3.2, 4.4),
                   height = dice.uniform(0.8, 1.9);
      const TexturePtr sign = paint_sign(dice, noise_, 0.9, height);
      const double outer = d + 1.1 * inward, inner = d + 0.15 * inward, l = std::max(inner, outer), r = std::min(inner, outer);
      solid.add({at(s, l, z), at(s, r, z), at(s, l, z + height), at(s, r, z + height)}, sign);
    }
    if (dice.below(2) == 0) {  // an awning
      const double length = dice.uniform(2.2, 3.6), s = dice.uniform(house.begin + 0.5, house.end - length - 0.3),
                   out = d + 1.3 * inward;
      Canvas stripes(length, 1.4, 60, random_color(dice, 60, 220));
      for (double x = 0; x < length; x += 0.5) stripes.box({x, 0, 0.25, 1.4}, {225, 228, 230});
      roughen(stripes.picture, noise_, 5, {dice.below(512), dice.below(512)});
      const double s0 = inward < 0 ? s : s + length, s1 = inward < 0 ? s + length : s;
      solid.add({at(s0, out, 2.45), at(s1, out, 2.45), at(s0, d, 2.95), at(s1, d, 2.95)},
                std::make_shared<Texture>(stripes.picture));
    }
  }

  void close(double s, int number) {
    const double height = 11 + 2.0 * number, l = number == 1 ? kLeftFacadeM + 9 : kRightFacadeM - 9,
                 r = number == 1 ? kRightFacadeM - 9 : kLeftFacadeM + 9;
    const TexturePtr front = paint_facade(random(71, number), noise_, std::abs(l - r), height);
    solid.add({at(s, l, 0), at(s, r, 0), at(s, l, height), at(s, r, height)}, front);
  }

  void place_curbs() {
    const TexturePtr stone = paint_plain(random(72, 0), noise_, {150, 156, 160}, 9);
    for (const double d : {kLeftCurbM, kRightCurbM})
      for (double s = kBeginM; s < end_; s += 2) {
        const double s0 = d > 0 ? s : s + 2, s1 = d > 0 ? s + 2 : s;
        solid.add({at(s0, d, 0), at(s1, d, 0), at(s0, d, kPavementHeightM), at(s1, d, kPavementHeightM)}, stone);
      }
  }

  void stand(const Model& model, double s, double d, double yaw = 0) {
    solid.add(model.solid, street_.world_from_place(s, d, kPavementHeightM, yaw));
  }

  void place_furniture() {
    for (int i = 0; i < 3; ++i) {
      leaves_[i] = paint_leaves(random(81, i), 0.4 + 0.08 * i);
      planters_[i] = paint_plain(random(82, i), noise_, {120, 140, 158}, 10);
    }
    bark_ = paint_plain(random(83, 0), noise_, {62, 74, 86}, 12);
    metal_ = paint_plain(random(84, 0), noise_, {92, 98, 96}, 5);
    const int count = static_cast<int>((end_ - kBeginM) / 6.5);
    for (int i = 0; i < count; ++i)
      for (const int side : {1, -1}) place_thing(i, side);
  }

  void place_thing(int i, int side) {
    Random dice = random(90 + side, i);
    const double s = kBeginM + 3 + 6.5 * i + dice.uniform(-0.8, 0.8), d = side > 0 ? kLeftCurbM + 0.75 : kRightCurbM - 0.75;
    const int kind = (i + (side > 0 ? 0 : 2)) % 4;
    if (kind == 0) {
      stand(make_tree(dice, bark_, leaves_[dice.below(3)]), s, d);
      shades.push_back({round(s, d, 1.7), 0.28, 1.2});
    } else if (kind == 1) {
      place_lamp(s, d, side);
    } else if (kind == 2) {
      const double length = dice.uniform(1.8, 3.6);
      stand(make_hedge(length, planters_[dice.below(3)], leaves_[dice.below(3)]), s, d + 0.3 * side);
      shades.push_back({rectangle(s, d + 0.3 * side, length + 0.2, 0.8), 0.45, 0.2});
    } else {
      place_small(dice, s, d, side);
    }
  }

  void place_lamp(double s, double d, int side) {
    Model lamp;
    lamp.solid.add_cylinder({0, 0, 0}, 0.08, 6.2, metal_);
    const double reach = -1.6 * side;
    add_frustum(lamp.solid, {-0.12, 0.12, 0.05, 6.0}, {-0.12, 0.12, 0.05, 6.12}, {metal_, metal_, metal_, metal_, metal_});
    lamp.solid.add({{-0.05, 0, 6.05}, {-0.05, reach, 6.05}, {-0.05, 0, 6.13}, {-0.05, reach, 6.13}}, metal_);
    lamp.solid.add({{-0.2, reach, 6.02}, {-0.2, reach + 0.6 * side, 6.02}, {0.2, reach, 6.16}, {0.2, reach + 0.6 * side, 6.16}},
                   metal_);
    const TexturePtr board = paint_sign(random(95, static_cast<int>(s)), noise_, 0.7, 0.7);
    lamp.solid.add({{-0.1, 0.35, 2.3}, {-0.1, -0.35, 2.3}, {-0.1, 0.35, 3.0}, {-0.1, -0.35, 3.0}}, board);
    stand(lamp, s, d);
    shades.push_back({round(s, d, 0.2), 0.3, 0.1});
  }

  void place_small(Random& dice, double s, double d, int side) {
    for (int k = 0; k < 3; ++k) {  // bollards
      Model bollard;
      bollard.solid.add_cylinder({0, 0, 0}, 0.07, 0.95, k == 1 ? planters_[0] : metal_);
      stand(bollard, s + 1.1 * k - 1, d);
    }
    Model bin;
    const TexturePtr side_wall = paint_sign(dice, noise_, 0.6, 1.1), lid = paint_plain(dice, noise_, {60, 70, 60});
    add_frustum(bin.solid, {-0.3, 0.3, 0.28, 0}, {-0.34, 0.34, 0.32, 1.1},
                {side_wall, side_wall, side_wall, side_wall, lid, false});
    stand(bin, s + 1.6, d + 1.3 * side);
    shades.push_back({rectangle(s + 1.6, d + 1.3 * side, 0.8, 0.8), 0.4, 0.15});
  }

  void place_parked_cars() {
    const std::uint64_t day = 100 + 10 * options_.day;
    for (int i = 0; -50 + 6.2 * i < end_ - 12; ++i)
      for (const int side : {1, -1}) {
        Random dice = random(day + side, i);
        const double s = -56 + 6.2 * (i + 1) + 3.1, d = side > 0 ? 4.62 : -8.15;
        // Crossings are kept free.
        const double past = s - crossing(0) - 70 * std::floor((s - crossing(0) + 5) / 70);
        if (dice.uniform() > 0.5 || past < 6.5) continue;
        if (options_.changes && side < 0 && on_site(s)) continue;
        const Model car = dice.below(5) == 0 ? make_van(dice, noise_) : make_car(dice, noise_);
        const double drift = dice.uniform(-0.3, 0.3);
        solid.add(car.solid,
                  street_.world_from_place(s + drift, d + dice.uniform(-0.1, 0.1), 0, side > 0 ? std::numbers::pi : 0));
        shades.push_back({rectangle(s + drift, d, car.size.x() + 0.15, car.size.y() + 0.15), 0.62, 0.3});
      }
  }

  // Building sites replace parked cars on the right.
  static constexpr double kSiteBeginM = 8, kSiteLengthM = 9, kSitePeriodM = 50;
  static bool on_site(double s) {
    const double past = s + 4 - kSiteBeginM - kSitePeriodM * std::floor((s + 4 - kSiteBeginM) / kSitePeriodM);
    return past < kSiteLengthM + 8;
  }

  void place_sites() {
    const TexturePtr board = paint_barrier(random(76, 0), noise_), wood = paint_plain(random(76, 1), noise_, {92, 128, 150}, 9),
                     sand = paint_plain(random(76, 2), noise_, {120, 160, 182}, 14);
    Model fence, heap;
    for (const double z : {0.25, 0.75}) {
      fence.solid.add({{-0.9, 0, z}, {0.9, 0, z}, {-0.9, 0, z + 0.25}, {0.9, 0, z + 0.25}}, board);
      fence.solid.add({{0.9, 0.03, z}, {-0.9, 0.03, z}, {0.9, 0.03, z + 0.25}, {-0.9, 0.03, z + 0.25}}, board);
    }
    for (const double x : {-0.8, 0.8}) fence.solid.add_cylinder({x, 0.015, 0}, 0.03, 1.1, wood);
    add_frustum(heap.solid, {-1.8, 1.8, 0.8, 0}, {-0.5, 0.6, 0.15, 0.9}, {sand, sand, sand, sand, sand});
    for (double begin = kSiteBeginM; begin < end_ - 20; begin += kSitePeriodM) {
      const double left = -2 * kLaneWidthM - 0.2, right = kRightCurbM + 0.25, middle = 0.5 * (left + right);
      for (double s = begin + 0.9; s < begin + kSiteLengthM; s += 1.8)
        for (const double d : {left, right}) solid.add(fence.solid, street_.world_from_place(s, d));
      for (const double s : {begin, begin + kSiteLengthM})
        solid.add(fence.solid, street_.world_from_place(s, middle, 0, 0.5 * std::numbers::pi));
      solid.add(heap.solid, street_.world_from_place(begin + 5.5, middle));
      shades.push_back({rectangle(begin + 5.5, middle, 3.8, 1.8), 0.5, 0.2});
    }
  }

  static std::vector<Eigen::Vector2d> rectangle(double s, double d, double length, double width) {
    const double l = 0.5 * length, w = 0.5 * width;
    return {{s - l, d - w}, {s + l, d - w}, {s + l, d + w}, {s - l, d + w}};
  }
  static std::vector<Eigen::Vector2d> round(double s, double d, double radius) {
    std::vector<Eigen::Vector2d> corners;
    for (int k = 0; k < 12; ++k)
      corners.emplace_back(s + radius * std::cos(k * std::numbers::pi / 6), d + radius * std::sin(k * std::numbers::pi / 6));
    return corners;
  }

  const SynthOptions& options_;
  const Noise& noise_;
  const Street& street_;
  std::uint64_t seed_;
  Vector3d sun_;
  double end_;
  std::array<TexturePtr, 3> leaves_, planters_;
  TexturePtr bark_, metal_;
};

// The left and right end of the panorama meet behind the car: toward its right end, it becomes the mirrored left one.
void close_behind(cv::Mat3b& panorama) {
  constexpr int kWidthPx = 96;
  for (int x = panorama.cols - kWidthPx; x < panorama.cols; ++x) {
    const double other = (x - panorama.cols + kWidthPx + 0.5) / kWidthPx;
    cv::addWeighted(panorama.col(x), 1 - other, panorama.col(panorama.cols - 1 - x), other, 0, panorama.col(x));
  }
}

}  // namespace

Sky::Sky(const SynthOptions& options, const Noise& noise) {
  cv::Mat3b picture(256, 1024);
  const bool clear = is_clear(options.day);
  const cv::Vec3f zenith = clear ? cv::Vec3f(212, 160, 112) : cv::Vec3f(188, 176, 164), haze(232, 224, 214),
                  cloud(246, 243, 240);
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      const float up = 1 - static_cast<float>(y) / static_cast<float>(picture.rows);
      const int shift = 100 * options.day;
      float veil = 0.5F * noise(x / 4 + shift, y / 3) + 0.35F * noise(x / 2, y + shift) + 0.12F * noise(x, 2 * y) +
                   (clear ? -0.1F : 0.35F);
      veil = std::clamp(veil, 0.0F, 1.0F) * (clear ? 0.8F : 0.55F);
      const cv::Vec3f blue = haze * (1 - std::sqrt(up)) + zenith * std::sqrt(up), color = blue * (1 - veil) + cloud * veil;
      picture(y, x) =
          cv::Vec3b(cv::saturate_cast<uchar>(color[0]), cv::saturate_cast<uchar>(color[1]), cv::saturate_cast<uchar>(color[2]));
    }
  // Clouds are soft.
  cv::GaussianBlur(picture, picture, {}, 2.5, 0, cv::BORDER_REFLECT);
  close_behind(picture);
  panorama_.emplace(picture);
}

cv::Vec3f Sky::shade(const Ray& ray, double pixel_share) const {
  if (!panorama_) return {};
  const double ahead = std::atan2(ray.direction.y(), ray.direction.x()) / std::numbers::pi;
  const double up = std::atan2(ray.direction.z(), ray.direction.head<2>().norm()) / (0.5 * std::numbers::pi);
  const double width = panorama_->width(), height = panorama_->height(),
               step = pixel_share * ray.step_x.norm() / ray.direction.norm();
  return panorama_->sample((0.5 - 0.5 * ahead) * width, (1 - std::max(up, 0.0)) * height,
                           {step * width / (2 * std::numbers::pi), 0}, {0, step * height / (0.5 * std::numbers::pi)});
}

StaticWorld::StaticWorld(const SynthOptions& options, const Noise& noise) {
  if (options.room) {
    light = make_room_light(options.day);
    solid = make_room(options, noise);
    return;
  }
  street = make_street(options);
  light = make_light(options.day);
  sky = Sky(options, noise);
  Builder builder(options, noise, street);
  builder.build();
  solid = std::move(builder.solid);
  ground = Ground(street, noise,
                  {.seed = static_cast<std::uint64_t>(options.seed),
                   .s_begin = kBeginM,
                   .s_end = builder.end() + 2,
                   .shades = builder.shades,
                   .wet = options.wet});
}

}  // namespace dvi::synth
