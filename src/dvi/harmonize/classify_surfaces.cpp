#include "dvi/harmonize/classify_surfaces.h"

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "dvi/drive/sensor.h"
#include "dvi/geometry/se3.h"
#include "dvi/harmonize/surface_class.h"
#include "dvi/image/poisson.h"
#include "dvi/image/region.h"

namespace dvi::harmonize {
namespace {

constexpr double kStands = 0.35;  // meters above the ground: no curb is higher
constexpr double kFoot = 16;      // px above where it stands: higher parts, as of a trunk, are far before what is beside them
constexpr float kUnsure = 0.03F;  // of the depth, one sigma: behind such a pixel may stand something else
constexpr int kRound = 24;        // px: of the surroundings of a hole

struct Classified {
  SurfaceClass surface = SurfaceClass::unknown;
  bool spreads = false;  ///< what is beside it may be of its class
};

class Classifier {
 public:
  Classifier(const View& view, const depth::DepthMap& depth, const ground::RoadGround& ground)
      : view_(view), depth_(depth), ground_(ground), world_from_camera_(view.camera_from_world.inverse()) {}

  Classified at(cv::Point p, bool sure) const {
    const float z = depth_.z(p);
    if (z == depth::DepthMap::kInfinity) return {SurfaceClass::upright, true};
    const Eigen::Vector3d ray = view_.camera.ray(Eigen::Vector2d(p.x, p.y));
    if (!depth::DepthMap::is_solid(z) || (!sure && depth_.sigma(p) > kUnsure * z))
      return (world_from_camera_.R * ray).z() > 0 ? Classified{SurfaceClass::upright, true} : Classified{};
    const Eigen::Vector3d point = world_from_camera_ * Eigen::Vector3d(z * ray);
    const std::optional<double> ground = ground_.height(Eigen::Vector2d(point.head<2>()));
    if (!ground) return {};
    const double height = point.z() - *ground;
    if (height <= kStands) return {SurfaceClass::ground, true};
    return {SurfaceClass::upright, height * view_.camera.fy < kFoot * z};
  }

 private:
  const View& view_;
  const depth::DepthMap& depth_;
  const ground::RoadGround& ground_;
  SE3 world_from_camera_;
};

constexpr uchar as_byte(SurfaceClass c) { return static_cast<uchar>(c); }

/// Gives the pixels of `unknown` the class that prevails round them: a membrane between 1, ground, and -1, upright, where
/// pixels spread their class.
void propagate(const cv::Mat1b& unknown, const cv::Mat1b& spreads, cv::Mat1b& classes) {
  // The line where the ground ends leads from one side of the hole to the other, whatever lies above and below.
  constexpr float kVertical = 0.01F;
  constexpr float kNothing = 1e-6F;  // where nothing is known round a part
  const std::array<cv::Point, 4> steps{cv::Point(-1, 0), cv::Point(1, 0), cv::Point(0, -1), cv::Point(0, 1)};
  const cv::Rect inside({}, classes.size());
  PoissonSystem system{Region(unknown), {}, {}, kVertical};
  for (const cv::Point p : system.region.pixels) {
    float diagonal = kNothing, right = 0;
    for (const cv::Point step : steps) {
      const cv::Point q = p + step;
      if (!inside.contains(q) || (unknown(q) == 0 && spreads(q) == 0)) continue;
      const float weight = step.y == 0 ? 1 : kVertical;
      diagonal += weight;
      if (unknown(q) == 0) right += classes(q) == as_byte(SurfaceClass::ground) ? weight : -weight;
    }
    system.diagonal.push_back(diagonal);
    system.right.push_back(cv::Vec3f::all(right));
  }
  std::vector<cv::Vec3f> x(system.region.size());
  solve_poisson(system, x, 1e-3);
  for (std::size_t i = 0; i < x.size(); ++i)
    if (x[i][0] != 0) classes(system.region.pixels[i]) = as_byte(x[i][0] > 0 ? SurfaceClass::ground : SurfaceClass::upright);
}

}  // namespace

cv::Mat1b classify_surfaces(const depth::Target& target, const sample::Candidates& candidates,
                            const ground::RoadGround& ground) {
  const Region& hole = candidates.hole;
  cv::Mat1b classes(hole.index.size(), as_byte(SurfaceClass::unknown)), unknown(hole.index.size(), uchar{0});
  cv::Mat1b spreads = unknown.clone();
  if (!ground.found() || target.view().sensor != Sensor::lidar) return classes;
  const Classifier classify(target.view(), target.depth, ground);
  for (const cv::Point p : Region(grown(cv::Mat1b(hole.index >= 0), kRound)).pixels) {
    const int i = hole.index(p);
    const bool copied = i >= 0 && candidates.leading[i].found();
    const Classified found = classify.at(p, copied);
    classes(p) = as_byte(found.surface);
    spreads(p) = found.spreads ? 255 : 0;
    if (found.surface == SurfaceClass::unknown) unknown(p) = 255;
  }
  propagate(unknown, spreads, classes);
  return classes;
}

}  // namespace dvi::harmonize
