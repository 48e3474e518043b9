#include "dvi/synth/street_ground.h"

#include <cmath>

#include <opencv2/imgproc.hpp>

#include "dvi/core/threads.h"

namespace dvi::synth {
namespace {

constexpr double kTexelM = 0.016, kChunkM = 10, kMarginM = 0.64;  // the margin keeps coarse mip levels free of seams
constexpr double kTopM = 9.6, kBottomM = -13.2;                   // d of the picture's upper and lower edge

/// Paints one chunk in street coordinates.
class GroundPainter {
 public:
  GroundPainter(double s0, std::uint64_t seed, const Noise& noise)
      : s0_(s0),
        seed_(seed),
        noise_(noise),
        picture_(make_plain_picture(pixels(kTopM - kBottomM), pixels(kChunkM + 2 * kMarginM), {106, 105, 103})) {}

  cv::Mat3b paint(int number, const GroundPlan& plan) {
    roughen(picture_, noise_, 12, offset(0));
    for (int cell = number - 1; cell <= number + 1; ++cell) paint_wear(cell);
    paint_wheel_tracks();
    paint_lines();
    for (const double curb : {kLeftCurbM, kRightCurbM}) {
      const double side = curb > 0 ? -1 : 1;
      box({-1e3, curb, 2e3, side * 0.35}, {70, 72, 74});  // gutter
    }
    paint_pavement(kLeftCurbM, kTopM);
    paint_pavement(kBottomM, kRightCurbM);
    if (plan.wet) paint_water();
    for (const Shade& shade : plan.shades) paint_shade(shade);
    return picture_;
  }

 private:
  struct Lines {
    cv::Mat color, cover;  // `cover` shows which pixels are painted
  };

  static int pixels(double meters) { return static_cast<int>(std::lround(meters / kTexelM)); }
  cv::Point at(double s, double d) const { return {pixels(std::clamp(s - s0_, -50.0, 60.0)), pixels(kTopM - d)}; }
  // The noise is continuous over the whole street: its pixels are counted from s = 0.
  cv::Point offset(int shift) const { return {pixels(s0_) + shift, 3 * shift}; }
  // `area` is s, d, length, and width, in meters.
  void box(const cv::Rect2d& area, const cv::Scalar& color, cv::Mat* target = nullptr) {
    cv::Mat& on = target ? *target : picture_;
    const cv::Rect rect = cv::Rect(at(area.x, area.y), at(area.x + area.width, area.y + area.height)) & cv::Rect({}, on.size());
    if (!rect.empty()) cv::rectangle(on, rect, color, cv::FILLED);
  }

  void paint_wear(int cell) {
    Random random = make_random(seed_, 11, cell);
    const double s = cell * kChunkM;
    const auto place = [&] { return cv::Point2d(s + random.uniform(0, kChunkM), random.uniform(kRightCurbM, kLeftCurbM)); };
    for (int i = 0; i < 6; ++i) {  // patches
      const cv::Point2d p = place();
      const double length = random.uniform(0.5, 4.5), width = random.uniform(0.4, 1.9), tone = random.uniform(-30, 24);
      const cv::Rect rect = cv::Rect(at(p.x, p.y), at(p.x + length, p.y + width)) & cv::Rect({}, picture_.size());
      if (rect.empty()) continue;
      cv::add(picture_(rect), cv::Scalar::all(tone), picture_(rect));
      cv::rectangle(picture_, at(p.x, p.y), at(p.x + length, p.y + width), {46, 45, 45}, 2, cv::LINE_AA);
    }
    for (int i = 0; i < 10; ++i) {  // cracks
      cv::Point2d p = place();
      const double along = random.uniform(-0.3, 0.3), across = random.uniform(-0.2, 0.2);
      std::vector<cv::Point> line;
      for (int k = 0; k < 14; ++k) {
        line.push_back(at(p.x, p.y));
        p += cv::Point2d(along + random.uniform(-0.2, 0.2), across + random.uniform(-0.15, 0.15));
      }
      cv::polylines(picture_, line, false, {40, 39, 38}, 1 + random.below(3), cv::LINE_AA);
    }
    for (int i = 0; i < 9; ++i) {  // stains and covers
      const cv::Point center = at(s + random.uniform(0, kChunkM), random.uniform(kRightCurbM + 0.6, kLeftCurbM - 0.6));
      if (i < 7) {
        const cv::Size axes(pixels(random.uniform(0.1, 0.6)), pixels(random.uniform(0.05, 0.3)));
        cv::ellipse(picture_, center, axes, random.uniform(0, 180), 0, 360, cv::Scalar::all(random.uniform(58, 84)), cv::FILLED,
                    cv::LINE_AA);
        continue;
      }
      cv::circle(picture_, center, pixels(0.34), {66, 62, 60}, cv::FILLED, cv::LINE_AA);
      for (int k = -15; k <= 15; k += 5)
        cv::line(picture_, center + cv::Point(k, -12), center + cv::Point(k, 12), {104, 102, 98}, 2, cv::LINE_AA);
    }
  }

  // Wet asphalt is darker, and puddles are darkest.
  void paint_water() {
    for (int y = 0; y < picture_.rows; ++y)
      for (int x = 0; x < picture_.cols; ++x) {
        const cv::Point at = cv::Point(x, y) + offset(0);
        const bool puddle = noise_(at.x / 3 + 300, at.y / 3) > 1.1F;
        picture_(y, x) *= puddle ? 0.42 : 0.62;
      }
  }

  // Tires polish two bands of each lane.
  void paint_wheel_tracks() {
    for (int y = 0; y < picture_.rows; ++y) {
      const double d = kTopM - (y + 0.5) * kTexelM, in_lane = d - kLaneWidthM * std::floor(d / kLaneWidthM) - 0.5 * kLaneWidthM;
      const double off = (std::abs(in_lane) - 0.8) / 0.28;
      picture_.row(y) -= cv::Scalar::all(std::round(9 * std::exp(-0.5 * off * off)));
    }
  }

  void paint_lines() {
    Lines lines{picture_.clone(), cv::Mat1b::zeros(picture_.size())};
    const auto stripe = [&](const cv::Rect2d& area, const cv::Scalar& ink) {
      box(area, ink, &lines.color);
      box(area, 255, &lines.cover);
    };
    const cv::Scalar white(214, 217, 216), yellow(75, 175, 212);
    for (const double d : {0.08, -0.2}) stripe({-1e3, d, 2e3, 0.12}, yellow);
    stripe({-1e3, kLaneWidthM - 0.06, 2e3, 0.12}, white);
    stripe({-1e3, -2 * kLaneWidthM - 0.06, 2e3, 0.12}, white);
    for (double s = -60; s < s0_ + 20; s += 6) stripe({s, -kLaneWidthM - 0.07, 2.4, 0.14}, white);
    for (double s = -56; s < s0_ + 20; s += 6.2)  // parking bays
      for (const double d : {kLaneWidthM, kRightCurbM}) stripe({s, d, 0.1, 2.2}, white);
    for (int k = -1; crossing(k) < s0_ + 20; ++k) {
      for (double d = kRightCurbM + 0.5; d < kLeftCurbM - 0.6; d += 0.95) stripe({crossing(k), d, 3.2, 0.48}, white);
      for (const double d : {-0.5 * kLaneWidthM, -1.5 * kLaneWidthM}) stripe({crossing(k) - 1.6, d - 1.5, 0.4, 3.0}, white);
      for (const double d : {-0.5 * kLaneWidthM, -1.5 * kLaneWidthM}) arrow(crossing(k) + 16, d, lines, white);
    }
    for (int y = 0; y < picture_.rows; ++y)
      for (int x = 0; x < picture_.cols; ++x) {
        if (lines.cover.at<uchar>(y, x) == 0) continue;
        const cv::Point seed = offset(77);
        const float share = std::clamp(0.82F + 0.2F * noise_(x + seed.x, y + seed.y), 0.2F, 1.0F);
        for (int c = 0; c < 3; ++c)
          picture_(y, x)[c] = cv::saturate_cast<uchar>(static_cast<float>(picture_(y, x)[c]) * (1 - share) +
                                                       static_cast<float>(lines.color.at<cv::Vec3b>(y, x)[c]) * share);
      }
  }

  void arrow(double s, double d, Lines& lines, const cv::Scalar& ink) const {
    if (std::abs(s - s0_) > 40) return;
    const std::vector<cv::Point> outline = {at(s, d + 0.08),      at(s + 2.4, d + 0.08), at(s + 2.4, d + 0.3), at(s + 3.9, d),
                                            at(s + 2.4, d - 0.3), at(s + 2.4, d - 0.08), at(s, d - 0.08)};
    cv::fillPoly(lines.color, std::vector<std::vector<cv::Point>>{outline}, ink);
    cv::fillPoly(lines.cover, std::vector<std::vector<cv::Point>>{outline}, 255);
  }

  void paint_pavement(double low, double high) {
    constexpr double kSlabM = 0.5;
    box({-1e3, low, 2e3, high - low}, {140, 146, 150});
    const int first = static_cast<int>(std::floor(s0_ / kSlabM));
    for (int i = first; i < first + static_cast<int>((kChunkM + 2 * kMarginM) / kSlabM) + 2; ++i)
      for (int j = 0; low + j * kSlabM < high; ++j) {
        Random random = make_random(seed_, 12 + (low > 0 ? 1 : 0), i * 64 + j);
        const double width = std::min(kSlabM, high - low - j * kSlabM), tone = random.uniform(-16, 14);
        box({i * kSlabM, low + j * kSlabM, kSlabM, width}, {140 + tone, 146 + tone, 149 + tone});
        box({i * kSlabM, low + j * kSlabM, 0.025, width}, {88, 92, 94});
        box({i * kSlabM, low + j * kSlabM, kSlabM, 0.025}, {88, 92, 94});
      }
    const cv::Rect rect = cv::Rect(0, at(0, high).y, picture_.cols, pixels(high - low)) & cv::Rect({}, picture_.size());
    cv::Mat3b part = picture_(rect);
    roughen(part, noise_, 6, offset(200) + rect.tl());
  }

  void paint_shade(const Shade& shade) {
    std::vector<cv::Point> outline;
    for (const Eigen::Vector2d& corner : shade.corners) outline.push_back(at(corner.x(), corner.y()));
    const int soft = std::max(1, pixels(shade.softness_m));
    const cv::Rect round = cv::boundingRect(outline) + cv::Size(4 * soft, 4 * soft) - cv::Point(2 * soft, 2 * soft);
    const cv::Rect rect = round & cv::Rect(cv::Point(-4 * soft, -4 * soft), picture_.size() + cv::Size(8 * soft, 8 * soft));
    const cv::Rect inside = rect & cv::Rect({}, picture_.size());
    if (inside.empty()) return;
    cv::Mat1f dark(rect.size(), 0.0F);
    cv::fillPoly(dark, std::vector<std::vector<cv::Point>>{outline}, 1.0, cv::LINE_8, 0, -rect.tl());
    // Two box filters are nearly a Gaussian, at a cost that does not grow with softness.
    for (int i = 0; i < 2; ++i) cv::blur(dark, dark, {2 * soft / 2 + 1, 2 * soft / 2 + 1}, {-1, -1}, cv::BORDER_REPLICATE);
    for (int y = inside.y; y < inside.br().y; ++y)
      for (int x = inside.x; x < inside.br().x; ++x) {
        const float keep = 1 - static_cast<float>(shade.strength) * dark(y - rect.y, x - rect.x);
        for (int c = 0; c < 3; ++c) picture_(y, x)[c] = cv::saturate_cast<uchar>(static_cast<float>(picture_(y, x)[c]) * keep);
      }
  }

  double s0_;
  std::uint64_t seed_;
  const Noise& noise_;
  cv::Mat3b picture_;
};

}  // namespace

double crossing(int number) { return 26 + 70.0 * number; }

Ground::Ground(const Street& street, const Noise& noise, const GroundPlan& plan)
    : street_(street), begin_(kChunkM * std::floor(plan.s_begin / kChunkM)) {
  const auto count = static_cast<std::size_t>(std::ceil((plan.s_end - begin_) / kChunkM));
  chunks_.reserve(count);
  for_blocks(count, [&](std::size_t first, std::size_t last) {
    std::vector<cv::Mat3b> pictures(last - first);
    parallel_for(pictures.size(), [&](std::size_t i) {
      const double s = begin_ + kChunkM * static_cast<double>(first + i);
      pictures[i] = GroundPainter(s - kMarginM, plan.seed, noise).paint(static_cast<int>(std::lround(s / kChunkM)), plan);
    });
    for (const cv::Mat3b& picture : pictures) chunks_.emplace_back(picture);
    Texture::page_out();
  });
}

Ground::Place Ground::trace(const Ray& ray) const {
  Place place;
  if (ray.direction.z() >= -1e-9 || chunks_.empty()) return place;
  for (const double height : {kPavementHeightM, 0.0}) {
    const double t = (height - ray.origin.z()) / ray.direction.z();
    const Eigen::Vector2d there = street_.locate(ray.at(t).head<2>());
    place = {t, height > 0, there.x(), there.y()};
    if (there.y() > kLeftCurbM || there.y() < kRightCurbM) break;
  }
  return place;
}

cv::Vec3f Ground::shade(const Ray& ray, const Place& place, const Light& light, double pixel_share) const {
  const double along = (place.s - begin_) / kChunkM;
  const double chunk = std::clamp(std::floor(along), 0.0, static_cast<double>(chunks_.size() - 1));
  const double x = ((along - chunk) * kChunkM + kMarginM) / kTexelM, y = (kTopM - place.d) / kTexelM;
  const double height = place.t * ray.direction.z(), heading = street_.heading(place.s);
  const double c = std::cos(heading) / kTexelM, s = std::sin(heading) / kTexelM;
  Eigen::Vector2d steps[2];
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector3d direction = ray.direction + pixel_share * (i == 0 ? ray.step_x : ray.step_y);
    double t = height / direction.z();
    if (!(t > 0 && t < 4 * place.t)) t = 4 * place.t;
    const Eigen::Vector3d step = t * direction - place.t * ray.direction;
    steps[i] = {c * step.x() + s * step.y(), s * step.x() - c * step.y()};
  }
  return chunks_[static_cast<std::size_t>(chunk)].sample(x, y, steps[0], steps[1]).mul(light.on(Eigen::Vector3d::UnitZ()));
}

}  // namespace dvi::synth
