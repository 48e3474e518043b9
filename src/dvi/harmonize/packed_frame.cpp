#include "dvi/harmonize/packed_frame.h"

#include "dvi/core/cache_budget.h"

namespace dvi::harmonize {
namespace {

/// Calls use(pixel) for the pixels of a mask, in raster order.
template <class Use>
void for_each_pixel(const cv::Mat1b& mask, const Use& use) {
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
      if (mask(y, x) != 0) use(cv::Point(x, y));
}

}  // namespace

PackedFrame::PackedFrame(const FilledFrame& frame) : mask_(frame.mask), depth_(frame.depth), gain_(frame.gain) {
  hole_.reserve(static_cast<std::size_t>(cv::countNonZero(mask_)));
  for_each_pixel(mask_, [&](cv::Point p) {
    hole_.push_back({frame.color(p), frame.provenance(p), frame.used(p), frame.kind(p), frame.confidence(p)});
  });
}

FilledFrame PackedFrame::unpack(const cv::Mat3b& image) const {
  FilledFrame out = make_unfilled_frame(image, mask_, depth_, gain_);
  std::size_t i = 0;
  for_each_pixel(mask_, [&](cv::Point p) {
    const Pixel& pixel = hole_[i++];
    out.color(p) = pixel.color;
    out.provenance(p) = pixel.provenance;
    out.used(p) = pixel.used;
    out.kind(p) = pixel.kind;
    out.confidence(p) = pixel.confidence;
  });
  return out;
}

std::size_t PackedFrame::bytes() const { return bytes_of(hole_) + bytes_of(mask_) + bytes_of(depth_); }

}  // namespace dvi::harmonize
