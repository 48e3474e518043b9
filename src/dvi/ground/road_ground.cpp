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

constexpr double kSquare = 2;  // meters
constexpr int kAcross = static_cast<int>(2 * RoadFrame::kReach / kSquare);
constexpr double kLane = 2;                    // meters from the way: nothing but the road is there
constexpr double kLevel = 0.9;                 // of a normal upwards
constexpr double kLowest = 0.3, kHighest = 4;  // meters of a camera above the ground
constexpr double kCurb = 0.35, kSlope = 0.06;  // meters beside the lane, and meters a meter
constexpr int kLeast = 3;                      // points

struct Mean {
  double sum = 0;
  int count = 0;
  void add(double v) {
    sum += v;
    ++count;
  }
};

int index(double meters) { return static_cast<int>(std::floor(meters / kSquare)); }

template <class Visit>
void for_level_points(const map::StaticMap& map, const RoadFrame& road, const Visit& visit) {
  for (const map::MapPoint& point : map.points) {
    if (point.normal.z() < kLevel) continue;
    const Eigen::Vector3d x = point.position.cast<double>();
    if (const auto at = road.locate(x.head<2>())) visit(*at, x.z());
  }
}

// Linear between squares that are known, constant before and behind.
std::vector<float> filled(const std::vector<Mean>& means) {
  std::vector<float> out(means.size());
  int before = -1;
  for (int i = 0; i < static_cast<int>(means.size()); ++i) {
    if (means[i].count < kLeast) continue;
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
  std::vector<float> cameras(index(road_.length()) + 1);  // a height by square: of the nearest camera of the way
  std::vector<Mean> heights(cameras.size()), lane(cameras.size());
  const auto [first, last] = views.of_sequence(0);
  for (std::size_t i = first; i < last; ++i) {
    const Eigen::Vector3d center = views[i].camera_from_world.inverse().t;
    if (const auto at = road_.locate(center.head<2>()))
      for (int k = 0; k < kLeast; ++k) heights[index(at->x())].add(center.z());
  }
  cameras = filled(heights);
  if (cameras.empty()) return;
  // The road: level, and below the camera by what most of it is.
  std::vector<float> below;
  for_level_points(map, road_, [&](const Eigen::Vector2d& at, double z) {
    if (std::abs(at.y()) < kLane && below.size() < 1000000) below.push_back(cameras[index(at.x())] - static_cast<float>(z));
  });
  const double usual = median(below);
  if (usual < kLowest || usual > kHighest) return;
  for_level_points(map, road_, [&](const Eigen::Vector2d& at, double z) {
    if (std::abs(at.y()) < kLane && std::abs(cameras[index(at.x())] - usual - z) < 1) lane[index(at.x())].add(z);
  });
  lane_ = filled(lane);
  if (lane_.empty()) return;
  std::vector<Mean> beside(lane_.size() * kAcross);
  for_level_points(map, road_, [&](const Eigen::Vector2d& at, double z) {
    const int i = index(at.x()), j = std::clamp(index(at.y() + RoadFrame::kReach), 0, kAcross - 1);
    const double rise = z - lane_[i];
    if (std::abs(rise) < kCurb + kSlope * std::abs(at.y())) beside[static_cast<std::size_t>(i) * kAcross + j].add(rise);
  });
  beside_.resize(beside.size());
  for (std::size_t i = 0; i < lane_.size(); ++i) {
    float* row = &beside_[i * kAcross];
    const Mean* means = &beside[i * kAcross];
    const auto take = [&](int j, int inner) {
      row[j] = means[j].count >= kLeast ? static_cast<float>(means[j].sum / means[j].count) : inner < 0 ? 0 : row[inner];
    };
    take(kAcross / 2, -1);
    for (int j = kAcross / 2 + 1; j < kAcross; ++j) take(j, j - 1);
    for (int j = kAcross / 2 - 1; j >= 0; --j) take(j, j + 1);
  }
}

double RoadGround::square(int along, int left) const {
  const int i = std::clamp(along, 0, static_cast<int>(lane_.size()) - 1), j = std::clamp(left, 0, kAcross - 1);
  return lane_[i] + beside_[static_cast<std::size_t>(i) * kAcross + j];
}

double RoadGround::height(double along, double left) const {
  const double x = along / kSquare - 0.5, y = (left + RoadFrame::kReach) / kSquare - 0.5;
  const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
  const double u = x - i, v = y - j;
  return (square(i, j) * (1 - u) + square(i + 1, j) * u) * (1 - v) +
         (square(i, j + 1) * (1 - u) + square(i + 1, j + 1) * u) * v;
}

std::optional<double> RoadGround::height(const Eigen::Vector2d& place) const {
  const std::optional<Eigen::Vector2d> at = road_.locate(place);
  return at && found() ? std::optional(height(at->x(), at->y())) : std::nullopt;
}

}  // namespace dvi::ground
