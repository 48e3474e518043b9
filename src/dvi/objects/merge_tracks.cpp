#include "dvi/objects/merge_tracks.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <tuple>
#include <utility>

namespace dvi::objects {
namespace {

struct MergeParams {
  double min_shared_returns = 0.5;   ///< share of common returns among those of the smaller observation
  double min_shared_scans = 0.5;     ///< share of the scans with so many common returns among the common scans
  std::size_t min_common_scans = 4;  ///< scans that observe both tracks
};
constexpr MergeParams kMerging{};

using ReturnKey = std::tuple<std::int64_t, double, double, double>;

ReturnKey to_key(const ClusterReturn& r) { return {r.time_ns, r.point.x(), r.point.y(), r.point.z()}; }

std::set<ReturnKey> to_keys(const ClusterReturns& returns) {
  std::set<ReturnKey> out;
  for (const ClusterReturn& r : returns) out.insert(to_key(r));
  return out;
}

bool has_common_returns(const Cluster& a, const Cluster& b) {
  const std::set<ReturnKey> known = to_keys(a.returns);
  const auto shared =
      std::count_if(b.returns.begin(), b.returns.end(), [&](const ClusterReturn& r) { return known.contains(to_key(r)); });
  return static_cast<double>(shared) >
         kMerging.min_shared_returns * static_cast<double>(std::min(a.returns.size(), b.returns.size()));
}

bool is_same_object(const Track& a, const Track& b) {
  std::size_t both = 0, shared = 0;
  auto other = b.observations.begin();
  for (const Cluster& cluster : a.observations) {
    while (other != b.observations.end() && other->scan < cluster.scan) ++other;
    if (other == b.observations.end()) break;
    if (other->scan != cluster.scan) continue;
    ++both;
    shared += has_common_returns(cluster, *other);
  }
  return both >= kMerging.min_common_scans &&
         static_cast<double>(shared) > kMerging.min_shared_scans * static_cast<double>(both);
}

void add_returns(const ClusterReturns& more, Cluster& cluster) {
  const std::set<ReturnKey> known = to_keys(cluster.returns);
  for (const ClusterReturn& r : more)
    if (!known.contains(to_key(r))) cluster.returns.push_back(r);
  measure(cluster);
}

void merge(Track& track, Track more) {
  std::map<std::size_t, Cluster> by_scan;
  for (Cluster& cluster : track.observations) by_scan.emplace(cluster.scan, std::move(cluster));
  for (Cluster& cluster : more.observations) {
    const auto [entry, is_new] = by_scan.try_emplace(cluster.scan, cluster);
    if (!is_new) add_returns(cluster.returns, entry->second);
  }
  track.height_m = std::max(track.height_m, more.height_m);
  track.size_m = track.size_m.cwiseMax(more.size_m);
  track.observations.clear();
  for (auto& [scan, cluster] : by_scan) track.observations.push_back(std::move(cluster));
}

}  // namespace

std::vector<Track> merge_duplicates(std::vector<Track> tracks) {
  std::vector<Track> out;
  for (Track& track : tracks) {
    const auto same = std::find_if(out.begin(), out.end(), [&](const Track& known) { return is_same_object(known, track); });
    if (same == out.end())
      out.push_back(std::move(track));
    else
      merge(*same, std::move(track));
  }
  return out;
}

}  // namespace dvi::objects
