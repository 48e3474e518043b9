#include "dvi/synthesize/noise_texture.h"

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
constexpr int kSkyClass = 3, kClasses = 4;  // the sky, in addition to the values of SurfaceClass

/// Parameters of the noise texture.
struct NoiseParams {
  int contrast_cell_px = 4;  ///< Contrast is stored at this reduced resolution, because it changes slowly.
  double row_sigma_px = 40;  ///< Horizontal standard deviation of the mean of contrast; neighbors in a row are often similar.
  double column_sigma_px = 12;  ///< Vertical standard deviation of the mean of contrast.
  float min_levels = 0.5F;      ///< Contrast in gray levels that is due to rounding.
  /// Relative weight of other classes, which counts where no pixel of the same class is near.
  float other_class_weight = 1e-3F;
  double panorama_step_m = 10;  ///< Distance between panoramas along the path.
  double cell_px = 1.5;         ///< Size of the noise cells of the finest octave.
  double max_distance_m = 200;  ///< Largest distance of surfaces; pixels without depth have it.
  double ground_aspect = 5;     ///< Ratio of width to height of the noise on the ground, which is viewed at a grazing angle.
  float dark_levels = 8;        ///< Brightness in gray levels above which contrast is proportional to brightness.
};
constexpr NoiseParams kNoise;

/// Weighted means over a Gaussian window.
class WeightedMean {
 public:
  WeightedMean(const cv::Mat1f& weight, double sigma_x, double sigma_y)
      : weight_(weight), all_(blurred(weight, sigma_x, sigma_y)), sigma_x_(sigma_x), sigma_y_(sigma_y) {}

  /// Computes the means of an image; `otherwise` far from all pixels with a weight.
  cv::Mat1f compute(const cv::Mat& image, float otherwise = 0) const {
    constexpr float kPriorWeight = 1e-6F;
    cv::Mat sum;
    cv::multiply(image, weight_, sum);
    sum = blurred(sum, sigma_x_, sigma_y_);
    cv::divide(sum + kPriorWeight * otherwise, all_ + kPriorWeight, sum);
    return {sum};
  }

 private:
  cv::Mat1f weight_, all_;
  double sigma_x_, sigma_y_;
};

/// Reduces an image to the resolution of contrast.
cv::Mat1f downsample(const cv::Mat1f& image) {
  cv::Mat1f out;
  constexpr int kCell = kNoise.contrast_cell_px;
  const cv::Size size((image.cols + kCell - 1) / kCell, (image.rows + kCell - 1) / kCell);
  cv::resize(image, out, size, 0, 0, cv::INTER_AREA);
  return out;
}

using Octaves = std::array<cv::Mat1f, kOctaves>;

/// Measures the standard deviation of each octave near each pixel, at reduced resolution, per class of surfaces; for
/// SurfaceClass::unknown over all classes. It is a harmonic mean of the known pixels nearby, because too much noise on a wall
/// with cars in front of it is more visible than too little noise between leaves.
std::array<Octaves, kClasses> measure_contrast(const cv::Mat1f& gray, const cv::Mat1f& known, const cv::Mat1b& classes) {
  constexpr float kSigmaOfMeanAbsolute = 1.25F;  // ratio for a normal distribution
  constexpr double kCell = kNoise.contrast_cell_px;
  std::vector<WeightedMean> of_classes;
  for (int c = 0; c < kClasses; ++c) {
    cv::Mat1f of_class = known.clone();
    if (c != static_cast<int>(SurfaceClass::unknown)) of_class.setTo(0, classes != c);
    of_classes.emplace_back(cv::Mat1f(downsample(of_class) + kNoise.other_class_weight * downsample(known)),
                            kNoise.row_sigma_px / kCell, kNoise.column_sigma_px / kCell);
  }
  std::array<Octaves, kClasses> out;
  cv::Mat1f finer = gray;
  WeightedMean near(known, 1, 1);
  for (int octave = 0; octave < kOctaves; ++octave) {
    const double next = 2 << octave;
    const cv::Mat1f coarser = near.compute(gray);
    near = {known, next, next};
    const cv::Mat1f here = near.compute(cv::abs(finer - coarser));
    cv::Mat1f inverse;
    cv::divide(1, kSigmaOfMeanAbsolute * here + kNoise.min_levels, inverse);
    inverse = downsample(inverse);
    for (int c = 0; c < kClasses; ++c) {
      cv::divide(1, of_classes[c].compute(inverse, 1 / kNoise.min_levels), out[c][octave]);
      out[c][octave] -= kNoise.min_levels;
    }
    finer = coarser;
  }
  return out;
}

/// Returns a pseudo-random number between -1 and 1 for a corner of the lattice.
float value_of_corner(std::uint64_t seed, const Eigen::Matrix<std::int64_t, 3, 1>& corner) {
  for (const std::int64_t c : corner) seed = Random(seed ^ static_cast<std::uint64_t>(c)).next();
  return static_cast<float>(Random(seed).uniform(-1, 1));
}

/// Smooth noise with cells of size 1 and standard deviation 1 on average. It caches the corners of the last cell.
class LatticeNoise {
 public:
  explicit LatticeNoise(std::uint64_t seed) : seed_(seed) {}

  float evaluate(const Eigen::Vector3d& position) {
    // The inverse of the standard deviation: sqrt(1 / 3) of the corners, times sqrt(0.41) by the interpolation of eight.
    constexpr float kScale = 2.7F;
    const Eigen::Array3d low = position.array().floor(), in = position.array() - low, s = in * in * (3 - 2 * in);
    load_corners(low.cast<std::int64_t>());
    double sum = 0;
    for (int k = 0; k < 8; ++k) {
      double weight = 1;
      for (int a = 0; a < 3; ++a) weight *= (k >> a & 1) != 0 ? s[a] : 1 - s[a];
      sum += weight * corners_[k];
    }
    return kScale * static_cast<float>(sum);
  }

 private:
  using Cell = Eigen::Matrix<std::int64_t, 3, 1>;

  void load_corners(const Cell& cell) {
    if (cell_ == cell) return;
    cell_ = cell;
    for (int k = 0; k < 8; ++k) corners_[k] = value_of_corner(seed_, cell + Cell(k & 1, k >> 1 & 1, k >> 2));
  }

  std::uint64_t seed_;
  Cell cell_ = Cell::Constant(std::numeric_limits<std::int64_t>::max());
  std::array<float, 8> corners_{};
};

/// Estimates the height of the camera above the ground in meters, from the depth of ground pixels; 0 if there are none. By it,
/// ground pixels without depth get one. `descent(p)` is the descent of a pixel's ray per meter of depth.
template <class Descent>
double estimate_height(const Region& region, const cv::Mat1f& z, const cv::Mat1b& classes, const Descent& descent) {
  std::vector<float> heights;
  for (const cv::Point p : region.pixels)
    if (classes(p) == static_cast<uchar>(SurfaceClass::ground) && depth::DepthMap::is_solid(z(p)))
      heights.push_back(static_cast<float>(z(p) * descent(p)));
  return heights.empty() ? 0 : median(std::move(heights));
}

}  // namespace

NoiseTexture::NoiseTexture(const Views& views) {
  constexpr double kStep = kNoise.panorama_step_m;
  const auto [first, last] = views.of_sequence(0);
  for (std::size_t i = first; i < last; ++i) {
    const SE3 world_from_camera = views[i].camera_from_world.inverse();
    const Eigen::Vector3d& center = world_from_camera.t;
    path_steps_.push_back(i == first ? 0 : path_steps_.back() + (center - centers_.back()).norm() / kStep);
    centers_.push_back(center);
    if (i == first) panorama_centers_ = {center - kStep * world_from_camera.R.col(2)};
    while (path_steps_.back() >= static_cast<double>(panorama_centers_.size() - 1)) panorama_centers_.push_back(center);
  }
}

std::vector<cv::Vec3f> NoiseTexture::compute(const harmonize::FilledFrame& frame, const Region& region, const View& view,
                                             const cv::Mat1b& surface_classes) const {
  cv::Mat1f known(frame.kind.size(), 0.0F), gray;
  known.setTo(1, frame.kind < static_cast<uchar>(harmonize::Kind::interpolated));
  cv::transform(frame.color, gray, cv::Matx13f::all(1.0F / 3));
  cv::Mat1b classes = surface_classes.clone();
  classes.setTo(kSkyClass, frame.depth >= depth::DepthMap::kInfinity);
  const std::array<Octaves, kClasses> contrast = measure_contrast(gray, known, classes);
  const SE3 world_from_camera = view.camera_from_world.inverse();
  const auto nearest = std::min_element(centers_.begin(), centers_.end(), [&](const auto& a, const auto& b) {
    return (a - world_from_camera.t).squaredNorm() < (b - world_from_camera.t).squaredNorm();
  });
  // The view is between two panoramas, both of which are behind the camera.
  const double steps = path_steps_[static_cast<std::size_t>(nearest - centers_.begin())], progress = steps - std::floor(steps);
  const auto before = static_cast<std::size_t>(steps);
  const std::array<float, 2> share{std::cos(static_cast<float>(progress * std::numbers::pi / 2)),
                                   std::sin(static_cast<float>(progress * std::numbers::pi / 2))};  // the squares add up to 1
  const auto descent = [&](cv::Point p) { return -(world_from_camera.R * view.camera.ray({p.x, p.y})).z(); };
  const double height = estimate_height(region, frame.depth, classes, descent);
  std::vector<LatticeNoise> noise;  // one per panorama and octave
  for (std::size_t k = 0; k < 2 * kOctaves; ++k) noise.emplace_back(before * kOctaves + k);
  std::vector<cv::Vec3f> out;
  out.reserve(region.size());
  for (const cv::Point p : region.pixels) {
    const bool ground = classes(p) == static_cast<uchar>(SurfaceClass::ground);
    double z = depth::DepthMap::is_solid(frame.depth(p)) ? std::min<double>(frame.depth(p), kNoise.max_distance_m)
                                                         : kNoise.max_distance_m;
    if (ground && height > 0 && descent(p) > 0) z = std::min(height / descent(p), kNoise.max_distance_m);
    const Eigen::Vector3d at = world_from_camera * Eigen::Vector3d(z * view.camera.ray({p.x, p.y}));
    float sum = 0;
    for (std::size_t side = 0; side < 2; ++side) {
      Eigen::Vector3d direction = (at - panorama_centers_[before + side]).normalized() * (view.camera.fx / kNoise.cell_px);
      if (ground) direction.head<2>() /= kNoise.ground_aspect;
      for (int octave = 0; octave < kOctaves; ++octave)
        sum += share[side] * contrast[classes(p)][octave](p / kNoise.contrast_cell_px) *
               noise[side * kOctaves + octave].evaluate(direction * std::exp2(-octave));
    }
    out.push_back(frame.color(p) * (sum / std::max(gray(p), kNoise.dark_levels)));
  }
  return out;
}

}  // namespace dvi::synthesize
