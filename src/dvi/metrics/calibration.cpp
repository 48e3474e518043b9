#include "dvi/metrics/calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "dvi/metrics/evaluation.h"

namespace dvi::metrics {
namespace {

using Level = ConfidenceCounts::Level;

/// The sum over the pixels of several levels.
struct LevelPool {
  Level sum;
  std::uint64_t levels = 0;  // sum over the pixels

  void add(std::size_t level, const Level& counts) {
    sum += counts;
    levels += level * counts.pixels;
  }
  double confidence() const { return static_cast<double>(levels) / 255 / static_cast<double>(sum.pixels); }
  double within() const { return static_cast<double>(sum.within) / static_cast<double>(sum.pixels); }
  double mae() const { return static_cast<double>(sum.error) / 3 / static_cast<double>(sum.pixels); }
};

/// The area under the curve of the mean error of the remaining pixels over the removed share, from 0 to 1, divided by the mean
/// error of all pixels. Groups are added in reverse order: the first group added is removed last. Within a group, pixels are
/// removed in no particular order, each with the mean error of the group.
class Sparsification {
 public:
  void add(std::uint64_t pixels, std::uint64_t error) {
    if (pixels == 0) return;
    const double mean = static_cast<double>(error) / static_cast<double>(pixels);
    const double after = left_ + static_cast<double>(pixels);
    area_ += static_cast<double>(error);
    if (left_ > 0) area_ += (error_ - mean * left_) * std::log(after / left_);
    left_ = after;
    error_ += static_cast<double>(error);
  }
  double area() const { return error_ > 0 ? area_ / error_ : std::numeric_limits<double>::quiet_NaN(); }

 private:
  double left_ = 0, error_ = 0, area_ = 0;
};

double compute_ause(const ConfidenceCounts& counts) {
  Sparsification by_confidence, by_error;
  for (std::size_t level = counts.levels.size(); level-- > 0;)
    by_confidence.add(counts.levels[level].pixels, counts.levels[level].error);
  for (std::size_t error = 0; error < counts.pixels_by_error.size(); ++error)
    by_error.add(counts.pixels_by_error[error], error * counts.pixels_by_error[error]);
  return by_confidence.area() - by_error.area();
}

double compute_ece(const ConfidenceCounts& counts, std::size_t pixels) {
  constexpr std::size_t kBins = 10;
  std::array<LevelPool, kBins> bins;
  for (std::size_t level = 0; level < counts.levels.size(); ++level)
    bins[std::min(kBins - 1, level * kBins / 255)].add(level, counts.levels[level]);
  double sum = 0;
  for (const LevelPool& bin : bins)
    if (bin.sum.pixels > 0) sum += static_cast<double>(bin.sum.pixels) * std::abs(bin.within() - bin.confidence());
  return sum / static_cast<double>(pixels);
}

/// Assigns each level to the decile of its middle pixel.
std::vector<Calibration::Decile> compute_deciles(const ConfidenceCounts& counts, std::size_t pixels) {
  std::array<LevelPool, 10> pools;
  std::size_t below = 0;
  for (std::size_t level = 0; level < counts.levels.size(); ++level) {
    const Level& here = counts.levels[level];
    if (here.pixels == 0) continue;
    pools[pools.size() * (2 * below + here.pixels) / (2 * pixels)].add(level, here);
    below += here.pixels;
  }
  std::vector<Calibration::Decile> out;
  for (const LevelPool& pool : pools)
    if (pool.sum.pixels > 0) out.push_back({pool.confidence(), pool.within(), pool.mae(), pool.sum.pixels});
  return out;
}

}  // namespace

void ConfidenceCounts::add(std::uint8_t confidence, const cv::Vec3b& result, const cv::Vec3b& truth) {
  int sum = 0, largest = 0;
  for (int c = 0; c < 3; ++c) {
    const int difference = std::abs(int{result[c]} - int{truth[c]});
    sum += difference;
    largest = std::max(largest, difference);
  }
  Level& level = levels[confidence];
  ++level.pixels;
  level.within += largest <= Calibration::kMaxDifference ? 1 : 0;
  level.error += static_cast<std::uint64_t>(sum);
  ++pixels_by_error[static_cast<std::size_t>(sum)];
}

Level& Level::operator+=(const Level& other) {
  pixels += other.pixels;
  within += other.within;
  error += other.error;
  return *this;
}

ConfidenceCounts& ConfidenceCounts::operator+=(const ConfidenceCounts& other) {
  for (std::size_t i = 0; i < levels.size(); ++i) levels[i] += other.levels[i];
  for (std::size_t i = 0; i < pixels_by_error.size(); ++i) pixels_by_error[i] += other.pixels_by_error[i];
  return *this;
}

std::optional<Calibration> ConfidenceCounts::compute_calibration() const {
  LevelPool all;
  for (std::size_t level = 0; level < levels.size(); ++level) all.add(level, levels[level]);
  const std::size_t pixels = all.sum.pixels;
  if (pixels == 0) return std::nullopt;
  return Calibration{
      pixels, all.confidence(), all.within(), compute_ece(*this, pixels), compute_ause(*this), compute_deciles(*this, pixels)};
}

ConfidenceCounts count_confidence(const cv::Mat1b& confidence, const cv::Mat3b& result, const cv::Mat3b& truth,
                                  const cv::Mat1b& pixels) {
  ConfidenceCounts counts;
  for (int y = 0; y < pixels.rows; ++y)
    for (int x = 0; x < pixels.cols; ++x)
      if (pixels(y, x)) counts.add(confidence(y, x), result(y, x), truth(y, x));
  return counts;
}

}  // namespace dvi::metrics
