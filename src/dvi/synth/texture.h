#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "dvi/core/scratch.h"

namespace dvi::synth {

/// A picture on a surface: color at all scales, and holes. Positions are in pixels of the picture, whose corners are
/// (0, 0) and (width, height).
///
/// All textures of the process share a bound of memory, beyond which they are paged to unlinked temporary files: a long street
/// has more of them than fit.
class Texture {
 public:
  explicit Texture(const cv::Mat3b& picture, const cv::Mat1b& alpha = {});
  Texture(Texture&&) = default;
  Texture& operator=(Texture&&) = default;
  /// Lets what does not fit into memory leave it until it is looked at again.
  static void page_out();

  int width() const { return levels_.front().cols; }
  int height() const { return levels_.front().rows; }
  /// Whether there is something at a position; decided at the finest scale, so that geometry does not change with distance.
  bool solid(double x, double y) const;
  /// Mean color (BGR) over the parallelogram of the two steps round a position, filtered along the longer step.
  cv::Vec3f sample(double x, double y, const Eigen::Vector2d& step_x, const Eigen::Vector2d& step_y) const;
  /// Color at the finest scale.
  cv::Vec3f at(double x, double y) const { return bilinear(0, static_cast<float>(x), static_cast<float>(y)); }

 private:
  cv::Vec3f bilinear(int level, float x, float y) const;
  cv::Vec3f trilinear(float level, float x, float y) const;

  ScratchVector<cv::Vec3b> pixels_;  // of all levels, which lie in it
  std::vector<cv::Mat3b> levels_;
  cv::Mat1b alpha_;
};

using TexturePtr = std::shared_ptr<const Texture>;

}  // namespace dvi::synth
