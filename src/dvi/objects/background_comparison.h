#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "dvi/objects/background_model.h"

namespace dvi::objects {

/// The result of a comparison with the background model, per pixel of a view at half size. All masks are 255 where their
/// statement holds.
struct ImageDifference {
  BackgroundModel background;
  cv::Mat1b differs;    ///< The view differs from the background.
  cv::Mat1b undecided;  ///< Too few views observe the background.
  cv::Mat1b ground;     ///< The background is the ground.
  cv::Mat1b matches;    ///< The view shows the background.
};

/// Compares views of a drive with the background that other views of the same drive show at other times.
class BackgroundComparison {
 public:
  /// The masks of `views` mark where a view does not show the background. `static_depth` is the result of
  /// render_static_depth().
  BackgroundComparison(const Views& views, Lazy<cv::Mat1f> static_depth, std::shared_ptr<const ground::ScanGround> ground);

  const Views& views() const { return others_.views(); }
  const ground::ScanGround& ground() const { return *ground_; }
  std::shared_ptr<const HalfSizeView> half_size_view(std::size_t view) const { return others_.half_size_view(view); }

  /// Compares the pixels of view `target` that are 255 in `band` (half size).
  ImageDifference compare(std::size_t target, const cv::Mat1b& band) const;

 private:
  std::vector<HalfSizePixel> find_background(std::size_t target, const cv::Mat1b& where, int step) const;

  BackgroundViews others_;
  Lazy<cv::Mat1f> static_depth_;
  std::shared_ptr<const ground::ScanGround> ground_;
};

}  // namespace dvi::objects
