#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "dvi/objects/other_times.h"

namespace dvi::objects {

/// What a comparison says of the pixels of a view at half size: masks, 255 where it holds.
struct ImageDifference {
  Usual usual;        ///< what others show
  cv::Mat1b differs;  ///< from what others show there
  cv::Mat1b untold;   ///< others did not see it
  cv::Mat1b ground;
  cv::Mat1b shown;  ///< as others show it
};

/// Compares a view with what others of its drive show at other times.
class Comparison {
 public:
  /// The masks of `views` say where their backgrounds are hidden; `standing`: as of static_depth().
  Comparison(const Views& views, Lazy<cv::Mat1f> standing, std::shared_ptr<const ground::ScanGround> ground);

  const Views& views() const { return others_.views(); }
  const ground::ScanGround& ground() const { return *ground_; }
  std::shared_ptr<const HalfView> half(std::size_t view) const { return others_.half(view); }

  /// Of the pixels of `band` (255, half size). `every`: so many pixels each way are judged by one of them.
  ImageDifference compare(std::size_t target, const cv::Mat1b& band, int every = 1) const;

 private:
  std::vector<HalfSizePixel> places_of(std::size_t target, const cv::Mat1b& where, int every) const;

  OtherTimes others_;
  Lazy<cv::Mat1f> standing_;
  std::shared_ptr<const ground::ScanGround> ground_;
};

}  // namespace dvi::objects
