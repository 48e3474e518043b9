#include "dvi/synthesize/grain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/core/median.h"
#include "dvi/core/random.h"
#include "dvi/depth/depth_map.h"
#include "dvi/harmonize/surface_class.h"
#include "dvi/image/blur.h"

namespace dvi::synthesize {
namespace {

using harmonize::SurfaceClass;

constexpr int kOctaves = 4;
constexpr int kSky = 3, kClasses = 4;  // the sky, and those of SurfaceClass
constexpr int kSmaller = 4;            // contrast changes slowly: a value for so many pixels each way

/// Means over a Gaussian of what a weight tells.
class WeightedMean {
 public:
  WeightedMean(const cv::Mat1f& weight, double sigma_x, double sigma_y)
      : weight_(weight), all_(blurred(weight, sigma_x, sigma_y)), sigma_x_(sigma_x), sigma_y_(sigma_y) {}

  /// Far from all that has a weight, `otherwise`.
  cv::Mat1f of(const cv::Mat& image, float otherwise = 0) const {
    constexpr float kNothing = 1e-6F;
    cv::Mat sum;
    cv::multiply(image, weight_, sum);
    sum = blurred(sum, sigma_x_, sigma_y_);
    cv::divide(sum + kNothing * otherwise, all_ + kNothing, sum);
    return {sum};
  }

 private:
  cv::Mat1f weight_, all_;
  double sigma_x_, sigma_y_;
};

cv::Mat1f smaller(const cv::Mat1f& image) {
  cv::Mat1f out;
  const cv::Size size((image.cols + kSmaller - 1) / kSmaller, (image.rows + kSmaller - 1) / kSmaller);
  cv::resize(image, out, size, 0, 0, cv::INTER_AREA);
  return out;
}

using Octaves = std::array<cv::Mat1f, kOctaves>;

/// Standard deviation of each octave of what is known near each pixel, made smaller, of each class of surfaces; of
/// SurfaceClass::unknown, of them all. The harmonic mean of what is found there: on a wall with cars before it grain stands
/// out, among leaves the lack of some does not.
std::array<Octaves, kClasses> contrasts(const cv::Mat1f& gray, const cv::Mat1f& known, const cv::Mat1b& classes) {
  constexpr double kAlongRows = 40, kAlongColumns = 12;  // px; what is beside a pixel is more often of its surface
  constexpr float kMeanToSigma = 1.25F;                  // of the absolute values of a normal distribution
  constexpr float kLeast = 0.5F;                         // gray levels: rounding alone
  constexpr float kOthers = 1e-3F;                       // weight of other classes: where nothing is near of its own
  std::vector<WeightedMean> of_classes;
  for (int c = 0; c < kClasses; ++c) {
    cv::Mat1f of_class = known.clone();
    if (c != static_cast<int>(SurfaceClass::unknown)) of_class.setTo(0, classes != c);
    of_classes.emplace_back(cv::Mat1f(smaller(of_class) + kOthers * smaller(known)), kAlongRows / kSmaller,
                            kAlongColumns / kSmaller);
  }
  std::array<Octaves, kClasses> out;
  cv::Mat1f finer = gray;
  WeightedMean near(known, 1, 1);
  for (int octave = 0; octave < kOctaves; ++octave) {
    const double next = 2 << octave;
    const cv::Mat1f coarser = near.of(gray);
    near = {known, next, next};
    const cv::Mat1f here = near.of(cv::abs(finer - coarser));
    cv::Mat1f inverse;
    cv::divide(1, kMeanToSigma * here + kLeast, inverse);
    inverse = smaller(inverse);
    for (int c = 0; c < kClasses; ++c) {
      cv::divide(1, of_classes[c].of(inverse, 1 / kLeast), out[c][octave]);
      out[c][octave] -= kLeast;
    }
    finer = coarser;
  }
  return out;
}

/// A number between -1 and 1 for each corner of a lattice.
float at_corner(std::uint64_t seed, const Eigen::Matrix<std::int64_t, 3, 1>& corner) {
  for (const std::int64_t c : corner) seed = Random(seed ^ static_cast<std::uint64_t>(c)).next();
  return static_cast<float>(Random(seed).uniform(-1, 1));
}

/// Smooth noise with cells of 1, standard deviation 1 on average. The corners of the last cell are kept for the next place.
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : seed_(seed) {}

  float at(const Eigen::Vector3d& place) {
    constexpr float kToOne = 2.7F;  // corners have sqrt(1 / 3), of which between eight of them sqrt(0.41) is left
    const Eigen::Array3d low = place.array().floor(), in = place.array() - low, s = in * in * (3 - 2 * in);
    look_at(low.cast<std::int64_t>());
    double sum = 0;
    for (int k = 0; k < 8; ++k) {
      double weight = 1;
      for (int a = 0; a < 3; ++a) weight *= (k >> a & 1) != 0 ? s[a] : 1 - s[a];
      sum += weight * corners_[k];
    }
    return kToOne * static_cast<float>(sum);
  }

 private:
  using Cell = Eigen::Matrix<std::int64_t, 3, 1>;

  void look_at(const Cell& cell) {
    if (cell_ == cell) return;
    cell_ = cell;
    for (int k = 0; k < 8; ++k) corners_[k] = at_corner(seed_, cell + Cell(k & 1, k >> 1 & 1, k >> 2));
  }

  std::uint64_t seed_;
  Cell cell_ = Cell::Constant(std::numeric_limits<std::int64_t>::max());
  std::array<float, 8> corners_{};
};

/// Meters of the camera above the ground, from the depth of the ground's pixels, so that those without depth have one that
/// fits; 0 where none has. `descent`: meters that a pixel's ray falls for each meter ahead.
template <class Descent>
double height_above_ground(const Region& region, const cv::Mat1f& z, const cv::Mat1b& classes, const Descent& descent) {
  std::vector<float> heights;
  for (const cv::Point p : region.pixels)
    if (classes(p) == static_cast<uchar>(SurfaceClass::ground) && depth::DepthMap::is_solid(z(p)))
      heights.push_back(static_cast<float>(z(p) * descent(p)));
  return heights.empty() ? 0 : median(std::move(heights));
}

}  // namespace

Grain::Grain(const Views& views) {
  constexpr double kStep = 10;  // meters
  const auto [first, last] = views.of_sequence(0);
  for (std::size_t i = first; i < last; ++i) {
    const SE3 world_from_camera = views[i].camera_from_world.inverse();
    const Eigen::Vector3d& center = world_from_camera.t;
    way_.push_back(i == first ? 0 : way_.back() + (center - centers_.back()).norm() / kStep);
    centers_.push_back(center);
    if (i == first) places_ = {center - kStep * world_from_camera.R.col(2)};
    while (way_.back() >= static_cast<double>(places_.size() - 1)) places_.push_back(center);
  }
}

std::vector<cv::Vec3f> Grain::at(const harmonize::FilledFrame& frame, const Region& region, const View& view,
                                 const cv::Mat1b& surface_classes) const {
  constexpr double kCell = 1.5;      // px of the finest octave's cells
  constexpr double kFarthest = 200;  // meters; also where nothing is known
  constexpr double kFlat = 5;        // times as wide as high: the ground is seen at a slant
  constexpr float kDark = 8;         // gray levels, from which on contrast goes with the light
  cv::Mat1f known(frame.kind.size(), 0.0F), gray;
  known.setTo(1, frame.kind < static_cast<uchar>(harmonize::Kind::interpolated));
  cv::transform(frame.color, gray, cv::Matx13f::all(1.0F / 3));
  cv::Mat1b kinds = surface_classes.clone();
  kinds.setTo(kSky, frame.depth >= depth::DepthMap::kInfinity);
  const std::array<Octaves, kClasses> contrast = contrasts(gray, known, kinds);
  const SE3 world_from_camera = view.camera_from_world.inverse();
  const auto nearest = std::min_element(centers_.begin(), centers_.end(), [&](const auto& a, const auto& b) {
    return (a - world_from_camera.t).squaredNorm() < (b - world_from_camera.t).squaredNorm();
  });
  // From one panorama to the next; both lie behind the camera.
  const double way = way_[static_cast<std::size_t>(nearest - centers_.begin())], turn = way - std::floor(way);
  const auto before = static_cast<std::size_t>(way);
  const std::array<float, 2> share{std::cos(static_cast<float>(turn * std::numbers::pi / 2)),
                                   std::sin(static_cast<float>(turn * std::numbers::pi / 2))};  // keep the deviation
  const auto descent = [&](cv::Point p) { return -(world_from_camera.R * view.camera.ray({p.x, p.y})).z(); };
  const double height = height_above_ground(region, frame.depth, kinds, descent);
  std::vector<Noise> noise;  // of either panorama, by octaves
  for (std::size_t k = 0; k < 2 * kOctaves; ++k) noise.emplace_back(before * kOctaves + k);
  std::vector<cv::Vec3f> out;
  out.reserve(region.size());
  for (const cv::Point p : region.pixels) {
    const bool ground = kinds(p) == static_cast<uchar>(SurfaceClass::ground);
    double z = depth::DepthMap::is_solid(frame.depth(p)) ? std::min<double>(frame.depth(p), kFarthest) : kFarthest;
    if (ground && height > 0 && descent(p) > 0) z = std::min(height / descent(p), kFarthest);
    const Eigen::Vector3d at = world_from_camera * Eigen::Vector3d(z * view.camera.ray({p.x, p.y}));
    float sum = 0;
    for (std::size_t side = 0; side < 2; ++side) {
      Eigen::Vector3d direction = (at - places_[before + side]).normalized() * (view.camera.fx / kCell);
      if (ground) direction.head<2>() /= kFlat;
      for (int octave = 0; octave < kOctaves; ++octave)
        sum += share[side] * contrast[kinds(p)][octave](p / kSmaller) *
               noise[side * kOctaves + octave].at(direction * std::exp2(-octave));
    }
    out.push_back(frame.color(p) * (sum / std::max(gray(p), kDark)));
  }
  return out;
}

}  // namespace dvi::synthesize
