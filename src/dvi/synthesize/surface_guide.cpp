#include "dvi/synthesize/surface_guide.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/depth/depth_map.h"
#include "dvi/drive/sensor.h"
#include "dvi/geometry/se3.h"
#include "dvi/harmonize/surface_class.h"
#include "dvi/image/enlarge.h"
#include "dvi/image/region.h"

namespace dvi::synthesize {
namespace {

using harmonize::Kind, harmonize::SurfaceClass;

/// Parameters of the surfaces.
struct SurfaceGuideParams {
  double max_blind_m = 15;  ///< Distance of ground up to which no beam of the LiDAR may hit it.
  int median_px = 7;        ///< Side of the square whose prevailing group a pixel of the hole has.
};
constexpr SurfaceGuideParams kSurfaceGuide;

class Surfaces {
 public:
  Surfaces(const ClassifiedFrame& frame, const View& view)
      : frame_(frame.filled),
        view_(view),
        classes_(frame.classes),
        ground_(frame.ground),
        world_from_camera_(view.camera_from_world.inverse()),
        plane_(view.sensor == Sensor::lidar ? ground::RoadPlane::below(ground_, world_from_camera_) : std::nullopt) {}

  Group group_of(cv::Point p) const {
    const float z = frame_.depth(p);
    const bool is_hole = frame_.kind(p) >= static_cast<uchar>(Kind::interpolated);
    if (z == depth::DepthMap::kInfinity) return Group::upright;
    if (!plane_) return Group::upright;
    const Eigen::Vector3d ray = world_from_camera_.R * view_.camera.ray({p.x, p.y});
    if (is_hole && !classes_.empty() && classes_(p) != static_cast<uchar>(SurfaceClass::unknown))
      return classes_(p) == static_cast<uchar>(SurfaceClass::ground) ? Group::ground : Group::upright;
    if (is_hole && plane_->is_in_lane(ray)) return Group::ground;
    if (!depth::DepthMap::is_solid(z)) {
      if (is_hole) return ray.z() < 0 ? Group::ground : Group::upright;
      if (z == depth::DepthMap::kSky || ray.z() >= 0) return Group::upright;
      return -plane_->below_m() / ray.z() < kSurfaceGuide.max_blind_m ? Group::ground : Group::none;
    }
    const Eigen::Vector3d point = world_from_camera_.t + z * ray;
    const auto height = ground_.height(Eigen::Vector2d(point.head<2>()));
    if (!height) return is_hole ? Group::upright : Group::none;
    return point.z() - *height <= ground::kRoadGround.max_surface_m ? Group::ground : Group::upright;
  }

  cv::Vec2f ground_of(cv::Point p) const {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    const auto found = plane_ ? plane_->meet(world_from_camera_.R * view_.camera.ray({p.x, p.y})) : std::nullopt;
    if (!found) return {kNan, kNan};
    const Eigen::Vector2d &at = *found, &along = plane_->along();
    return {static_cast<float>(at.dot(along)), static_cast<float>(along.x() * at.y() - along.y() * at.x())};
  }

 private:
  const harmonize::FilledFrame& frame_;
  const View& view_;
  const cv::Mat1b& classes_;
  const ground::RoadGround& ground_;
  SE3 world_from_camera_;
  std::optional<ground::RoadPlane> plane_;
};

}  // namespace

SurfaceGuide guide_by_surfaces(const ClassifiedFrame& frame, const View& view, const cv::Mat1b& where) {
  const Surfaces surfaces(frame, view);
  const cv::Mat1b& kind = frame.filled.kind;
  const cv::Size size = kind.size();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  SurfaceGuide out{cv::Mat1b(size, uchar{0}), cv::Mat2f(size, cv::Vec2f::all(kNan))};
  const std::vector<cv::Point> pixels = Region(where).pixels;
  if (pixels.empty()) return out;
  for (const cv::Point p : pixels) out.group(p) = static_cast<uchar>(surfaces.group_of(p));
  const cv::Rect box = enlarge(cv::boundingRect(where), kSurfaceGuide.median_px, size);
  cv::Mat1b level(out.group(box) == static_cast<uchar>(Group::ground));
  cv::medianBlur(level, level, kSurfaceGuide.median_px);
  for (const cv::Point p : pixels) {
    if (kind(p) >= static_cast<uchar>(Kind::interpolated))
      out.group(p) = static_cast<uchar>(level(p - box.tl()) != 0 ? Group::ground : Group::upright);
    if (out.group(p) == static_cast<uchar>(Group::ground)) out.ground(p) = surfaces.ground_of(p);
  }
  return out;
}

}  // namespace dvi::synthesize
