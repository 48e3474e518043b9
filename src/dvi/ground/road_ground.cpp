#include "dvi/ground/road_ground.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "dvi/core/median.h"
#include "dvi/drive/view.h"
#include "dvi/ground/road_frame.h"
#include "dvi/map/static_map.h"

namespace dvi::ground {
namespace {

constexpr int kSquaresAcross = static_cast<int>(2 * RoadFrame::kHalfWidthM / kRoadGround.square_m);

struct Mean {
  double sum = 0;
  int count = 0;
  void add(double v) {
    sum += v;
    ++count;
  }
};

int to_index(double meters) { return static_cast<int>(std::floor(meters / kRoadGround.square_m)); }

template <class Visit>
void for_each_level_point(const map::StaticMap& map, const RoadFrame& road, const Visit& visit) {
  for (const map::MapPoint& point : map.points) {
    if (point.normal.z() < kRoadGround.min_normal_z) continue;
    const Eigen::Vector3d x = point.position.cast<double>();
    if (const auto at = road.locate(x.head<2>())) visit(*at, x.z());
  }
}

/// Interpolates linearly between the known squares and continues constantly before and after them.
std::vector<float> interpolate_gaps(const std::vector<Mean>& means) {
  std::vector<float> out(means.size());
  int before = -1;
  for (int i = 0; i < static_cast<int>(means.size()); ++i) {
    if (means[i].count < kRoadGround.min_points) continue;
    out[i] = static_cast<float>(means[i].sum / means[i].count);
    for (int k = before + 1; k < i; ++k)
      out[k] = before < 0
                   ? out[i]
                   : out[before] + (out[i] - out[before]) * static_cast<float>(k - before) / static_cast<float>(i - before);
    before = i;
  }
  if (before < 0) return {};
  std::fill(out.begin() + before + 1, out.end(), out[before]);
  return out;
}

}  // namespace

RoadGround::RoadGround(const map::StaticMap& map, const Views& views) : road_(views) {
  std::vector<float> cameras(to_index(road_.length()) + 1);  // height of the nearest camera, per square
  std::vector<Mean> heights(cameras.size()), lane(cameras.size());
  const auto [first, last] = views.of_sequence(0);
  for (std::size_t i = first; i < last; ++i) {
    const Eigen::Vector3d center = views[i].camera_from_world.inverse().t;
    if (const auto at = road_.locate(center.head<2>()))
      for (int k = 0; k < kRoadGround.min_points; ++k) heights[to_index(at->x())].add(center.z());
  }
  cameras = interpolate_gaps(heights);
  if (cameras.empty()) return;
  // The road is level and below the camera by the median distance.
  std::vector<float> below;
  for_each_level_point(map, road_, [&](const Eigen::Vector2d& at, double z) {
    if (std::abs(at.y()) < kRoadGround.lane_half_width_m && below.size() < 1000000)
      below.push_back(cameras[to_index(at.x())] - static_cast<float>(z));
  });
  const double camera_height = median(below);
  if (camera_height < kRoadGround.min_camera_m || camera_height > kRoadGround.max_camera_m) return;
  for_each_level_point(map, road_, [&](const Eigen::Vector2d& at, double z) {
    if (std::abs(at.y()) < kRoadGround.lane_half_width_m && std::abs(cameras[to_index(at.x())] - camera_height - z) < 1)
      lane[to_index(at.x())].add(z);
  });
  lane_ = interpolate_gaps(lane);
  if (lane_.empty()) return;
  std::vector<Mean> beside(lane_.size() * kSquaresAcross);
  for_each_level_point(map, road_, [&](const Eigen::Vector2d& at, double z) {
    const int i = to_index(at.x()), j = std::clamp(to_index(at.y() + RoadFrame::kHalfWidthM), 0, kSquaresAcross - 1);
    const double rise = z - lane_[i];
    if (std::abs(rise) < kRoadGround.max_curb_m + kRoadGround.max_slope * std::abs(at.y()))
      beside[static_cast<std::size_t>(i) * kSquaresAcross + j].add(rise);
  });
  beside_.resize(beside.size());
  for (std::size_t i = 0; i < lane_.size(); ++i) {
    float* row = &beside_[i * kSquaresAcross];
    const Mean* means = &beside[i * kSquaresAcross];
    const auto set = [&](int j, int inner) {
      row[j] = means[j].count >= kRoadGround.min_points ? static_cast<float>(means[j].sum / means[j].count)
               : inner < 0                              ? 0
                                                        : row[inner];
    };
    set(kSquaresAcross / 2, -1);
    for (int j = kSquaresAcross / 2 + 1; j < kSquaresAcross; ++j) set(j, j - 1);
    for (int j = kSquaresAcross / 2 - 1; j >= 0; --j) set(j, j + 1);
  }
}

double RoadGround::square_height(int along, int left) const {
  const int i = std::clamp(along, 0, static_cast<int>(lane_.size()) - 1), j = std::clamp(left, 0, kSquaresAcross - 1);
  return lane_[i] + beside_[static_cast<std::size_t>(i) * kSquaresAcross + j];
}

double RoadGround::height(double along, double left) const {
  const double x = along / kRoadGround.square_m - 0.5, y = (left + RoadFrame::kHalfWidthM) / kRoadGround.square_m - 0.5;
  const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
  const double u = x - i, v = y - j;
  return (square_height(i, j) * (1 - u) + square_height(i + 1, j) * u) * (1 - v) +
         (square_height(i, j + 1) * (1 - u) + square_height(i + 1, j + 1) * u) * v;
}

std::optional<double> RoadGround::height(const Eigen::Vector2d& position) const {
  const std::optional<Eigen::Vector2d> at = road_.locate(position);
  if (!at || !found()) return std::nullopt;
  const double beyond_m = RoadFrame::kExtensionM - std::min(at->x(), road_.length() - at->x());
  return beyond_m < kRoadGround.max_beyond_m ? std::optional(height(at->x(), at->y())) : std::nullopt;
}

std::optional<RoadPlane> RoadPlane::below(const RoadGround& ground, const SE3& world_from_camera) {
  const Eigen::Vector2d camera = world_from_camera.t.head<2>();
  const std::optional<Eigen::Vector2d> here = ground.found() ? ground.road().locate(camera) : std::nullopt;
  if (!here) return std::nullopt;
  RoadPlane out(ground.road());
  out.camera_ = camera;
  out.along_ = ground.road().direction(here->x());
  out.below_m_ = world_from_camera.t.z() - ground.height(here->x() + kRoadGround.plane_ahead_m, 0);
  return out;
}

std::optional<Eigen::Vector2d> RoadPlane::meet(const Eigen::Vector3d& ray, double max_m) const {
  if (!(ray.z() < 0)) return std::nullopt;
  const double scale = below_m_ / -ray.z();
  if (scale > max_m) return std::nullopt;
  return scale * ray.head<2>();
}

bool RoadPlane::is_in_lane(const Eigen::Vector3d& ray) const {
  const std::optional<Eigen::Vector2d> found = meet(ray, kRoadGround.max_lane_m);
  const std::optional<Eigen::Vector2d> at = found ? road_->locate(camera_ + *found) : std::nullopt;
  return at && std::abs(at->y()) < kRoadGround.lane_half_width_m;
}

}  // namespace dvi::ground
