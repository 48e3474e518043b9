#include "dvi/exposure/sightings.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "dvi/drive/vignetting.h"
#include "dvi/image/region.h"
#include "dvi/image/saturation.h"

namespace dvi::exposure {
namespace {

constexpr double kBlur = 2.5;  // px: poses are not refined yet
constexpr int kMargin = 6;     // px round masks and saturated pixels that the blur reaches
constexpr uchar kBlack = 8;    // gray levels; darker, noise and the sensor's offset outweigh the light

/// Pixels whose surroundings are unmasked, neither black nor saturated.
cv::Mat1b usable(const cv::Mat3b& image, const cv::Mat1b& mask) {
  cv::Mat1b bad, black, within;
  cv::inRange(image, cv::Scalar::all(0), cv::Scalar::all(kSaturated - 1), within);
  cv::inRange(image, cv::Scalar::all(0), cv::Scalar::all(kBlack - 1), black);
  cv::bitwise_or(mask, black, bad);
  cv::bitwise_or(bad, ~within, bad);
  cv::Mat1b out;
  cv::bitwise_not(grown(bad, kMargin), out);
  return out;
}

}  // namespace

Sightings sightings(const View& view, const std::vector<map::VisiblePoint>& points, const cv::Mat3b& image,
                    const cv::Mat1b& mask) {
  const cv::Mat1b use = usable(image, mask);
  cv::Mat3f colors;
  image.convertTo(colors, CV_32FC3);
  cv::GaussianBlur(colors, colors, {}, kBlur);
  Sightings out;
  for (const map::VisiblePoint& p : points) {
    const cv::Point at(cvRound(p.u), cvRound(p.v));
    if (use(at) == 0) continue;
    const cv::Vec3f& c = colors(at);
    if (std::min({c[0], c[1], c[2]}) < static_cast<float>(kBlack)) continue;
    out.push_back({p.index, {std::log(c[0]), std::log(c[1]), std::log(c[2])}, off_axis(view.camera, {p.u, p.v})});
  }
  std::sort(out.begin(), out.end(), [](const PointObservation& a, const PointObservation& b) { return a.point < b.point; });
  return out;
}

}  // namespace dvi::exposure
