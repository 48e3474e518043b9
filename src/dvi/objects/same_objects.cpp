#include "dvi/objects/same_objects.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <tuple>
#include <utility>

namespace dvi::objects {
namespace {

constexpr double kShared = 0.5;          // of the returns of the smaller one, those that both hold
constexpr double kScans = 0.5;           // of the scans that see both, those in which they share so many
constexpr std::size_t kFewestScans = 4;  // that see both
using Return = std::tuple<std::int64_t, double, double, double>;

Return return_of(const Cluster& cluster, std::size_t i) {
  const Eigen::Vector3d& x = cluster.points[i];
  return {cluster.time_ns[i], x.x(), x.y(), x.z()};
}

std::set<Return> returns_of(const Cluster& cluster) {
  std::set<Return> out;
  for (std::size_t i = 0; i < cluster.points.size(); ++i) out.insert(return_of(cluster, i));
  return out;
}

bool share_returns(const Cluster& a, const Cluster& b) {
  const std::set<Return> known = returns_of(a);
  std::size_t shared = 0;
  for (std::size_t i = 0; i < b.points.size(); ++i) shared += known.count(return_of(b, i));
  return static_cast<double>(shared) > kShared * static_cast<double>(std::min(a.points.size(), b.points.size()));
}

bool same_object(const Track& a, const Track& b) {
  std::size_t both = 0, shared = 0;
  auto other = b.observations.begin();
  for (const Cluster& cluster : a.observations) {
    while (other != b.observations.end() && other->scan < cluster.scan) ++other;
    if (other == b.observations.end()) break;
    if (other->scan != cluster.scan) continue;
    ++both;
    shared += share_returns(cluster, *other);
  }
  return both >= kFewestScans && static_cast<double>(shared) > kScans * static_cast<double>(both);
}

void add_returns(Cluster more, Cluster& cluster) {
  const std::set<Return> known = returns_of(cluster);
  for (std::size_t i = 0; i < more.points.size(); ++i) {
    if (known.contains(return_of(more, i))) continue;
    cluster.points.push_back(more.points[i]);
    cluster.time_ns.push_back(more.time_ns[i]);
    cluster.ground.push_back(more.ground[i]);
    cluster.rise.push_back(more.rise[i]);
  }
  measure(cluster);
}

void join(Track& track, Track more) {
  std::map<std::size_t, Cluster> by_scan;
  for (Cluster& cluster : track.observations) by_scan.emplace(cluster.scan, std::move(cluster));
  for (Cluster& cluster : more.observations) {
    const auto [seen, is_new] = by_scan.try_emplace(cluster.scan, cluster);
    if (!is_new) add_returns(std::move(cluster), seen->second);
  }
  track.height_m = std::max(track.height_m, more.height_m);
  track.size_m = track.size_m.cwiseMax(more.size_m);
  track.observations.clear();
  for (auto& [scan, cluster] : by_scan) track.observations.push_back(std::move(cluster));
}

}  // namespace

std::vector<Track> without_duplicates(std::vector<Track> tracks) {
  std::vector<Track> out;
  for (Track& track : tracks) {
    const auto same = std::find_if(out.begin(), out.end(), [&](const Track& known) { return same_object(known, track); });
    if (same == out.end())
      out.push_back(std::move(track));
    else
      join(*same, std::move(track));
  }
  return out;
}

}  // namespace dvi::objects
