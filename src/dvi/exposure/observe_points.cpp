#include "dvi/exposure/observe_points.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "dvi/drive/vignetting.h"
#include "dvi/image/region.h"
#include "dvi/image/saturation.h"

namespace dvi::exposure {
namespace {

/// Returns the pixels whose neighborhood is unmasked and neither black nor saturated.
cv::Mat1b find_usable_pixels(const cv::Mat3b& image, const cv::Mat1b& mask) {
  cv::Mat1b bad, black, within;
  cv::inRange(image, cv::Scalar::all(0), cv::Scalar::all(kSaturated - 1), within);
  cv::inRange(image, cv::Scalar::all(0), cv::Scalar::all(kObservation.black - 1), black);
  cv::bitwise_or(mask, black, bad);
  cv::bitwise_or(bad, ~within, bad);
  cv::Mat1b out;
  cv::bitwise_not(grown(bad, kObservation.margin_px), out);
  return out;
}

}  // namespace

PointObservations observe_points(const View& view, const std::vector<map::VisiblePoint>& points, const cv::Mat3b& image,
                                 const cv::Mat1b& mask) {
  const cv::Mat1b usable = find_usable_pixels(image, mask);
  cv::Mat3f colors;
  image.convertTo(colors, CV_32FC3);
  cv::GaussianBlur(colors, colors, {}, kObservation.blur_px);
  PointObservations out;
  for (const map::VisiblePoint& p : points) {
    const cv::Point at(cvRound(p.u), cvRound(p.v));
    if (usable(at) == 0) continue;
    const cv::Vec3f& c = colors(at);
    if (std::min({c[0], c[1], c[2]}) < static_cast<float>(kObservation.black)) continue;
    out.push_back({p.index, {std::log(c[0]), std::log(c[1]), std::log(c[2])}, compute_off_axis(view.camera, {p.u, p.v})});
  }
  std::sort(out.begin(), out.end(), [](const PointObservation& a, const PointObservation& b) { return a.point < b.point; });
  return out;
}

}  // namespace dvi::exposure
