#include "dvi/objects/clusters.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include "dvi/drive/point_labels.h"

namespace dvi::objects {
namespace {

struct ClusterParams {
  double square_m = 0.5;               ///< the gap between returns of one vehicle at 60 m, with its mirrors and hitch
  std::size_t min_moving_returns = 5;  ///< fewer moving returns are noise
};
constexpr ClusterParams kClustering{};

using ClusterSquare = std::pair<int, int>;

ClusterSquare to_square(const Eigen::Vector3d& x, double square_m) {
  return {static_cast<int>(std::floor(x.x() / square_m)), static_cast<int>(std::floor(x.y() / square_m))};
}

// Numbers the groups of squares that touch. On return, `squares` holds the group of each square.
void group_squares(std::map<ClusterSquare, int>& squares) {
  for (auto& [square, group] : squares) group = -1;
  int count = 0;
  for (auto& [seed, group] : squares) {
    if (group >= 0) continue;
    std::vector<ClusterSquare> open{seed};
    group = count;
    while (!open.empty()) {
      const ClusterSquare at = open.back();
      open.pop_back();
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const auto next = squares.find({at.first + dx, at.second + dy});
          if (next == squares.end() || next->second >= 0) continue;
          next->second = count;
          open.push_back(next->first);
        }
    }
    ++count;
  }
}

}  // namespace

void add(Cluster& cluster, const ObstacleReturns& returns, std::size_t i) {
  cluster.returns.push_back({returns.points[i], returns.time_ns[i], returns.ground[i], returns.ray_spacing_m[i]});
}

void measure(Cluster& cluster) {
  const ClusterReturn first = cluster.returns.front();
  Eigen::Vector2d low = first.point.head<2>(), high = low;
  std::int64_t time = 0;
  for (const ClusterReturn& r : cluster.returns) {
    low = low.cwiseMin(r.point.head<2>());
    high = high.cwiseMax(r.point.head<2>());
    time += r.time_ns - first.time_ns;
  }
  cluster.center = 0.5 * (low + high);
  cluster.extent_m = (high - low).maxCoeff();
  cluster.mean_time_ns = first.time_ns + time / static_cast<std::int64_t>(cluster.returns.size());
}

std::vector<int> group_by_distance(const std::vector<Eigen::Vector3d>& points, double square_m) {
  std::map<ClusterSquare, int> squares;
  for (const Eigen::Vector3d& point : points) squares.emplace(to_square(point, square_m), -1);
  group_squares(squares);
  std::vector<int> groups;
  groups.reserve(points.size());
  for (const Eigen::Vector3d& point : points) groups.push_back(squares.at(to_square(point, square_m)));
  return groups;
}

std::vector<Cluster> find_clusters(const ObstacleReturns& returns) {
  std::map<ClusterSquare, int> groups;
  for (std::size_t i = 0; i < returns.points.size(); ++i)
    if (returns.vote[i] == VisibilityVote::moving) groups.emplace(to_square(returns.points[i], kClustering.square_m), -1);
  group_squares(groups);
  struct Counts {
    std::size_t moving = 0, stationary = 0;
  };
  std::map<int, std::pair<Cluster, Counts>> found;
  for (std::size_t i = 0; i < returns.points.size(); ++i) {
    const auto group = groups.find(to_square(returns.points[i], kClustering.square_m));
    if (group == groups.end()) continue;
    auto& [cluster, counts] = found[group->second];
    counts.moving += returns.vote[i] == VisibilityVote::moving;
    counts.stationary += returns.vote[i] == VisibilityVote::stationary;
    if (returns.vote[i] == VisibilityVote::stationary) continue;
    add(cluster, returns, i);
  }
  std::vector<Cluster> clusters;
  for (auto& [group, entry] : found) {
    auto& [cluster, counts] = entry;
    if (counts.moving < kClustering.min_moving_returns) continue;
    cluster.moving_share = static_cast<double>(counts.moving) / static_cast<double>(counts.moving + counts.stationary);
    measure(cluster);
    clusters.push_back(std::move(cluster));
  }
  return clusters;
}

std::vector<Cluster> find_labeled_clusters(const ObstacleReturns& returns) {
  std::map<std::pair<const PointClass*, std::uint32_t>, std::vector<std::size_t>> objects;  // returns by kind and instance
  for (std::size_t i = 0; i < returns.label.size(); ++i)
    if (const std::uint32_t label = returns.label[i]; label != 0)
      objects[{find_point_class(class_of_point(label)), label >> 16U}].push_back(i);
  std::vector<Cluster> clusters;
  for (const auto& [key, members] : objects) {
    std::vector<Eigen::Vector3d> points;
    for (const std::size_t i : members) points.push_back(returns.points[i]);
    const std::vector<int> groups = group_by_distance(points, kClustering.square_m);
    std::map<int, std::pair<Cluster, std::map<int, std::size_t>>> found;
    for (std::size_t k = 0; k < members.size(); ++k) {
      auto& [cluster, classes] = found[groups[k]];
      add(cluster, returns, members[k]);
      ++classes[class_of_point(returns.label[members[k]])];
    }
    for (auto& [group, entry] : found) {
      auto& [cluster, classes] = entry;
      if (cluster.returns.size() < kClustering.min_moving_returns) continue;
      cluster.moving_share = 1;
      cluster.label_class = std::max_element(classes.begin(), classes.end(), [](const auto& a, const auto& b) {
                              return a.second < b.second;
                            })->first;
      measure(cluster);
      clusters.push_back(std::move(cluster));
    }
  }
  return clusters;
}

}  // namespace dvi::objects
