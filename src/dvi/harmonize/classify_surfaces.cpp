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

/// Parameters of the classification.
struct SurfaceClassParams {
  /// Height in the image up to which a class is propagated; higher parts are far in front of their neighbors.
  double max_foot_px = 16;
  float max_relative_sigma = 0.03F;  ///< Relative uncertainty of the depth above which the pixel may show another object.
  int margin_px = 24;                ///< Width of the classified area around the hole.
  /// Vertical smoothness of the propagation. It is small, because the end of the ground continues from one side of the hole to
  /// the other, whatever is above and below.
  float vertical_weight = 0.01F;
  float prior_weight = 1e-6F;  ///< Weight that makes the equation solvable without known surroundings.
};
constexpr SurfaceClassParams kSurfaceClass;

struct PixelClass {
  SurfaceClass surface = SurfaceClass::unknown;
  bool propagates = false;  ///< Whether unknown neighbors may have the same class.
};

class Classifier {
 public:
  Classifier(const depth::Target& target, const sample::Candidates& candidates, const ground::RoadGround& ground)
      : view_(target.view()),
        depth_(target.depth),
        candidates_(candidates),
        ground_(ground),
        world_from_camera_(view_.camera_from_world.inverse()),
        road_(ground::RoadPlane::below(ground, world_from_camera_)) {}

  /// Classifies a pixel. The depth of a copied pixel is used in spite of its uncertainty, because it was verified by the
  /// source.
  PixelClass classify(cv::Point p) const {
    const int i = candidates_.hole.index(p);
    const bool copied = i >= 0 && candidates_.leading[i].found();
    const float z = depth_.z(p);
    if (z == depth::DepthMap::kInfinity) return {SurfaceClass::upright, true};
    const Eigen::Vector3d ray = view_.camera.ray(Eigen::Vector2d(p.x, p.y));
    if (!depth::DepthMap::is_solid(z) || (!copied && depth_.sigma(p) > kSurfaceClass.max_relative_sigma * z))
      return classify_without_depth(world_from_camera_.R * ray, i >= 0);
    const Eigen::Vector3d point = world_from_camera_ * Eigen::Vector3d(z * ray);
    const std::optional<double> ground = ground_.height(Eigen::Vector2d(point.head<2>()));
    if (!ground) return {};
    const double height = point.z() - *ground;
    if (height <= ground::kRoadGround.max_surface_m) return {SurfaceClass::ground, true};
    return {SurfaceClass::upright, height * view_.camera.fy < kSurfaceClass.max_foot_px * z};
  }

 private:
  /// Unobserved pixels without depth show the road as far as the lane reaches.
  PixelClass classify_without_depth(const Eigen::Vector3d& ray, bool is_hole) const {
    if (ray.z() > 0) return {SurfaceClass::upright, true};
    if (is_hole && road_ && road_->is_in_lane(ray)) return {SurfaceClass::ground, true};
    return {};
  }

  const View& view_;
  const depth::DepthMap& depth_;
  const sample::Candidates& candidates_;
  const ground::RoadGround& ground_;
  SE3 world_from_camera_;
  std::optional<ground::RoadPlane> road_;
};

constexpr uchar to_byte(SurfaceClass c) { return static_cast<uchar>(c); }

/// Gives the pixels of `unknown` the prevailing class around them: the sign of a membrane between 1 (ground) and -1 (upright)
/// at the pixels of `propagates`.
void propagate_classes(const cv::Mat1b& unknown, const cv::Mat1b& propagates, cv::Mat1b& classes) {
  const std::array<cv::Point, 4> steps{cv::Point(-1, 0), cv::Point(1, 0), cv::Point(0, -1), cv::Point(0, 1)};
  const cv::Rect inside({}, classes.size());
  PoissonSystem system{Region(unknown), {}, {}, kSurfaceClass.vertical_weight};
  for (const cv::Point p : system.region.pixels) {
    float diagonal = kSurfaceClass.prior_weight, right = 0;
    for (const cv::Point step : steps) {
      const cv::Point q = p + step;
      if (!inside.contains(q) || (unknown(q) == 0 && propagates(q) == 0)) continue;
      const float weight = step.y == 0 ? 1 : kSurfaceClass.vertical_weight;
      diagonal += weight;
      if (unknown(q) == 0) right += classes(q) == to_byte(SurfaceClass::ground) ? weight : -weight;
    }
    system.diagonal.push_back(diagonal);
    system.right.push_back(cv::Vec3f::all(right));
  }
  std::vector<cv::Vec3f> x(system.region.size());
  solve_poisson(system, x, 1e-3);
  for (std::size_t i = 0; i < x.size(); ++i)
    if (x[i][0] != 0) classes(system.region.pixels[i]) = to_byte(x[i][0] > 0 ? SurfaceClass::ground : SurfaceClass::upright);
}

}  // namespace

cv::Mat1b classify_surfaces(const depth::Target& target, const sample::Candidates& candidates,
                            const ground::RoadGround& ground) {
  const Region& hole = candidates.hole;
  cv::Mat1b classes(hole.index.size(), to_byte(SurfaceClass::unknown)), unknown(hole.index.size(), uchar{0});
  cv::Mat1b propagates = unknown.clone();
  if (!ground.found() || target.view().sensor != Sensor::lidar) return classes;
  const Classifier classifier(target, candidates, ground);
  for (const cv::Point p : Region(grown(cv::Mat1b(hole.index >= 0), kSurfaceClass.margin_px)).pixels) {
    const PixelClass found = classifier.classify(p);
    classes(p) = to_byte(found.surface);
    propagates(p) = found.propagates ? 255 : 0;
    if (found.surface == SurfaceClass::unknown) unknown(p) = 255;
  }
  propagate_classes(unknown, propagates, classes);
  return classes;
}

}  // namespace dvi::harmonize
