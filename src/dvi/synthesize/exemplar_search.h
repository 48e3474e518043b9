#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/random.h"
#include "dvi/image/region.h"
#include "dvi/synthesize/exemplar_level.h"

namespace dvi::synthesize {

/// A 2 x 2 matrix that transforms offsets in a patch to offsets in its exemplar.
struct PatchWarp {
  float xx = 1, xy = 0, yx = 0, yy = 1;
  bool is_identity() const { return xx == 1 && yy == 1 && xy == 0 && yx == 0; }
  cv::Point2f operator*(cv::Point2f d) const { return {xx * d.x + xy * d.y, yx * d.x + yy * d.y}; }
  /// Returns the half side of the square around the exemplar of a patch with half side 1.
  float extent() const { return std::max(std::abs(xx) + std::abs(xy), std::abs(yx) + std::abs(yy)); }
};

/// The exemplar of a patch, by the pixel that corresponds to the center of the patch.
struct Exemplar {
  cv::Point at{-1, -1};
  float cost =
      std::numeric_limits<float>::infinity();  ///< Mean squared difference in gray levels, plus the cost of position and usage.
  bool found() const { return at.x >= 0; }
};

/// The search for the exemplars of all patches that have unknown pixels, at one level of the pyramid. It changes the colors of
/// the level, which must outlive it, and takes its `prior`. Its steps run on all threads; each patch has random numbers of its
/// own, so that the result does not depend on their number.
class ExemplarSearch {
 public:
  ExemplarSearch(ExemplarLevel& level, std::uint64_t seed);

  /// Returns the centers of the patches.
  const Region& targets() const { return targets_; }
  /// Returns the exemplar of the patch around a target.
  const Exemplar& match(cv::Point p) const { return matches_[targets_.index(p)]; }

  /// Starts with the exemplars of the next coarser level, or with random ones.
  void start(const ExemplarSearch* coarser);
  /// Improves the exemplars by those of neighbors and by random ones, in raster order or in the opposite order.
  void improve(bool forward);
  /// Computes unknown colors from the exemplars of all patches.
  void vote();
  /// Computes them from the patches whose centers are within a square of this radius around a pixel.
  void vote(int radius_px);

 private:
  static Region find_targets(const ExemplarLevel& level);
  bool is_inside(cv::Point p) const { return cv::Rect({}, level_.size()).contains(p); }
  std::size_t tile_index(cv::Point tile) const {
    return static_cast<std::size_t>(tile.y) * static_cast<std::size_t>(tile_grid_.width) + static_cast<std::size_t>(tile.x);
  }
  PatchWarp warp_of(cv::Point target, cv::Point source) const;

  Random random_of(std::size_t target) const;
  void for_each_target(const std::function<void(std::size_t i)>& call) const;
  void for_each_in_order(bool forward, const std::function<void(std::size_t i)>& call) const;

  void try_match(std::size_t i, cv::Point source);
  void try_random(std::size_t i, Random& random);
  void try_row(std::size_t i, Random& random);
  void try_along_road(std::size_t i, Random& random);
  void propagate(std::size_t i, bool forward);
  void search(std::size_t i, Random& random);

  float cost_of_place(cv::Point target, cv::Point source, const PatchWarp& warp) const;
  float cost_of(cv::Point target, cv::Point source, float limit) const;
  void count_usage();

  ExemplarLevel& level_;
  std::uint64_t seed_;
  std::uint64_t round_ = 0;  // number of calls of start() and improve()
  Region targets_;
  std::vector<Exemplar> matches_;                    // one per target
  cv::Size tile_grid_;                               // columns and rows of tiles
  std::vector<std::vector<std::size_t>> tiles_;      // targets of each tile in raster order, row by row
  std::vector<cv::Vec4f> prior_;                     // ExemplarLevel::prior of each target
  std::array<std::vector<cv::Point>, 256> sources_;  // centers of possible exemplars, by group
  cv::Mat1f usage_;                                  // how often a pixel is used, relative to the mean, minus 1
  cv::Mat4f mean_;                                   // mean color of the pixels of each patch
  cv::Mat1f weight_;                                 // sum of the weights of the pixels of each patch
  cv::Mat4f pixel_weight_;                           // weight of each pixel, four times
};

}  // namespace dvi::synthesize
