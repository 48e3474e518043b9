#include "dvi/objects/comparison.h"

#include <array>
#include <optional>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace dvi::objects {
namespace {

// Seconds, both ways. The nearest show the background least displaced, the later ones after the object has left it.
constexpr std::array kTimes{0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0};
constexpr int kSharp = 1;         // half pixels across: roof rails and mirrors are thin
constexpr int kLightGrid = 12;    // half pixels between the places at which light is compared
constexpr double kEndless = 1e4;  // meters: of what no scan reached

}  // namespace

Comparison::Comparison(const Views& views, Lazy<cv::Mat1f> standing, std::shared_ptr<const ground::ScanGround> ground)
    : others_(views, kSharp), standing_(std::move(standing)), ground_(std::move(ground)) {}

ImageDifference Comparison::compare(std::size_t target, const cv::Mat1b& band, int every) const {
  const auto half = others_.half(target);
  const std::vector<HalfSizePixel> places = places_of(target, band, every);
  const auto seen = others_.colors(target, kTimes, places, places_of(target, cv::Mat1b(half->mask == 0), kLightGrid));
  const int displaced = 2 * every + 1;  // what poses and depth are wrong by, each way one
  ImageDifference out{Usual(places, seen, band.size(), displaced), {}, {}, {}, {}};
  for (cv::Mat1b* mask : {&out.differs, &out.untold, &out.ground, &out.shown}) *mask = cv::Mat1b(band.size(), uchar{0});
  for (std::size_t i = 0; i < places.size(); ++i) {
    const cv::Point at = places[i].at;
    const cv::Rect judged = cv::Rect(at.x, at.y, every, every) & cv::Rect({}, band.size());
    if (places[i].on_ground) out.ground(judged) = 255;
    if (seen[i].size() < kFewestViews)
      out.untold(judged) = 255;
    else if (out.usual.excludes(at, half->image(at)))
      out.differs(judged) = 255;
    else if (out.usual.shows(at, half->image(at)))
      out.shown(judged) = 255;
  }
  cv::medianBlur(out.differs, out.differs, 3);
  return out;
}

// Pixels with what stands there: the nearer of the ground and what rises from it, or else something endlessly far.
std::vector<HalfSizePixel> Comparison::places_of(std::size_t target, const cv::Mat1b& where, int every) const {
  std::vector<HalfSizePixel> out;
  const View& view = views()[target];
  const SE3 world_from_camera = view.camera_from_world.inverse();
  const auto standing = standing_[target];
  for (int y = 0; y < where.rows; y += every)
    for (int x = 0; x < where.cols; x += every) {
      if (where(y, x) == 0) continue;
      const auto ground = on_ground(view, world_from_camera, *ground_, {x, y});
      const double z = (*standing)(y, x) > 0 ? static_cast<double>((*standing)(y, x)) : kEndless;
      const bool on_it = ground && (view.camera_from_world * *ground).z() < z;
      out.push_back(
          {{x, y}, on_it ? *ground : world_from_camera * Eigen::Vector3d(z * view.camera.ray(full_size({x, y}))), on_it});
    }
  return out;
}

}  // namespace dvi::objects
