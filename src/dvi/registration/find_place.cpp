#include "dvi/registration/find_place.h"

#include <algorithm>
#include <cmath>

#include "dvi/core/threads.h"
#include "dvi/registration/bird_view.h"

namespace dvi::registration {
namespace {

constexpr double kSubmap = 25;                           // metres of way before and after
constexpr double kEveryPlace = 20;                       // metres of way from one submap to the next
constexpr std::size_t kMostQueries = 5;                  // submaps of the drive that looks for its place
constexpr std::size_t kFromPair = 8, kVerified = 24;     // candidates
constexpr double kNearGuess = 15, kNearGuessTurn = 0.2;  // metres and radians
constexpr double kAnother = 1, kAnotherTurn = 0.05;      // metres and radians: from here on it is another place
constexpr double kPlaceReach = 60;                            // metres between submaps that may see the same
constexpr double kChance = 1.0 / 3;     // of single things that agree in a street that looks alike (docs/algorithms/register.md)
constexpr std::size_t kFewestThings = 8;
constexpr double kMostRival = 0.6;

std::vector<std::size_t> places_of(const KeyScans& keys, std::size_t most) {
  const double way = keys.empty() ? 0 : keys[keys.size() - 1].way_m;
  const auto count = std::clamp<std::size_t>(static_cast<std::size_t>(way / kEveryPlace), 1, most);
  std::vector<std::size_t> out;
  std::size_t next = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double at = way * (static_cast<double>(k) + 0.5) / static_cast<double>(count);
    while (next + 1 < keys.size() && keys[next].way_m < at) ++next;
    if (out.empty() || out.back() != next) out.push_back(next);
  }
  return out;
}

/// The smallest share that would be no surprise (95 %, Wilson's interval).
double least_share(const Confirmation& things) {
  constexpr double z = 1.96;
  const auto n = static_cast<double>(things.all());
  if (n == 0) return 0;
  const double p = things.share(), centre = p + z * z / (2 * n);
  return (centre - z * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n))) / (1 + z * z / n);
}

struct Submap {
  std::size_t key = 0;
  StillScan scan;
  SE3 level_from_lidar;
  std::vector<Eigen::Vector3d> standing;  // level axes
};

Submap submap_at(const KeyScans& keys, std::size_t key) {
  Submap out;
  out.key = key;
  out.scan = submap(keys, key, kSubmap);
  out.level_from_lidar = level_from_lidar(out.scan.dense.planes);
  out.standing = standing_points(out.scan.points, out.level_from_lidar);
  return out;
}

std::vector<Eigen::Vector3d> moved(const std::vector<Eigen::Vector3d>& points, const SE3& motion) {
  std::vector<Eigen::Vector3d> out;
  out.reserve(points.size());
  for (const Eigen::Vector3d& p : points) out.push_back(motion * p);
  return out;
}

/// Registers the submaps to each other from a start, and asks the single things in both directions.
Place verified(const Submap& a, const Submap& b, const SE3& start, scan_match::Surroundings& scene,
               const scan_match::MatchOptions& match) {
  scan_match::RegisterOptions options = register_options(match);
  options.coarse_iterations = 10;
  options.iterations = 30;
  options.prior_m = 1;
  const scan_match::Registration fit =
      register_scan(b.scan.sparse, start, Vector6d::Zero(), {}, 0, scene, options);
  const SE3 level_a_from_b = a.level_from_lidar * fit.world_from_lidar * b.level_from_lidar.inverse();
  Place out{a.key, b.key, fit.world_from_lidar, confirm(a.standing, moved(b.standing, level_a_from_b)), 0};
  const Confirmation other = confirm(b.standing, moved(a.standing, level_a_from_b.inverse()));
  out.things.confirmed += other.confirmed;
  out.things.moved += other.moved;
  return out;
}

}  // namespace

bool Place::sure() const {
  return things.confirmed >= 2 * kFewestThings && least_share(things) > kChance && rival < kMostRival;
}

PlaceFinder::PlaceFinder(const KeyScans& a, const KeyScans& b) : a_(a), b_(b) {}

std::optional<Place> PlaceFinder::find(const std::optional<SE3>& a_world_from_b_world) const {
  struct Start {
    std::size_t a, b;
    Candidate candidate;
  };
  const std::vector<std::size_t> b_keys = places_of(b_, kMostQueries);
  std::vector<Submap> queries(b_keys.size());
  parallel_for(queries.size(), [&](std::size_t k) { queries[k] = submap_at(b_, b_keys[k]); });
  std::vector<TurnedViews> views;
  for (const Submap& query : queries) views.push_back(turned_views(query.standing));

  // Places are made one after the other: a long drive has many.
  const std::vector<std::size_t> a_keys = places_of(a_, a_.size());
  const auto guessed = [&](std::size_t a, std::size_t b) {
    return a_[a].world_from_lidar.inverse() * *a_world_from_b_world * b_[b].world_from_lidar;
  };
  const auto in_question = [&](std::size_t a, std::size_t b) {
    return !a_world_from_b_world || guessed(a, b).t.norm() < kPlaceReach;
  };
  std::vector<std::vector<Start>> starts(a_keys.size());
  parallel_for(a_keys.size(), [&](std::size_t i) {
    if (std::none_of(b_keys.begin(), b_keys.end(), [&](std::size_t b) { return in_question(a_keys[i], b); })) return;
    const Submap place = submap_at(a_, a_keys[i]);
    const BirdView view = bird_view(place.standing);
    for (std::size_t k = 0; k < queries.size(); ++k) {
      if (!in_question(a_keys[i], b_keys[k])) continue;
      const SE3 b_level = queries[k].level_from_lidar;
      if (a_world_from_b_world)
        starts[i].push_back({i, k, {1, place.level_from_lidar * guessed(a_keys[i], b_keys[k]) * b_level.inverse()}});
      for (const Candidate& found : correlate(view, views[k], kFromPair)) starts[i].push_back({i, k, found});
      for (Start& start : starts[i])
        if (start.b == k) start.candidate.a_from_b = place.level_from_lidar.inverse() * start.candidate.a_from_b * b_level;
    }
    std::erase_if(starts[i], [&](const Start& start) {
      if (!a_world_from_b_world) return false;
      const SE3 off = guessed(a_keys[start.a], b_keys[start.b]).inverse() * start.candidate.a_from_b;
      return off.t.norm() > kNearGuess || so3_log(off.R).norm() > kNearGuessTurn;
    });
  });
  std::vector<Start> all;
  for (const std::vector<Start>& some : starts) all.insert(all.end(), some.begin(), some.end());
  std::stable_sort(all.begin(), all.end(), [](const Start& p, const Start& q) { return p.candidate.score > q.candidate.score; });
  if (all.size() > kVerified) all.resize(kVerified);

  std::vector<Place> places(all.size());
  parallel_for(all.size(), [&](std::size_t i) {
    const Submap a = submap_at(a_, a_keys[all[i].a]);
    scan_match::Surroundings scene = scan_match::empty_scene(a_.options());
    scene.add(a.scan.dense, {}, Vector6d::Zero());
    places[i] = verified(a, queries[all[i].b], all[i].candidate.a_from_b, scene, a_.options());
  });
  const auto best = std::max_element(places.begin(), places.end(),
                                     [](const Place& p, const Place& q) { return p.strength() < q.strength(); });
  if (best == places.end() || best->things.confirmed == 0) return std::nullopt;
  // Both places as seen from the best one's key scan.
  const auto from_world = [&](const Place& p) {
    return a_[p.a].world_from_lidar * p.a_from_b * b_[p.b].world_from_lidar.inverse() * b_[best->b].world_from_lidar;
  };
  Place out = *best;
  for (const Place& other : places) {
    const SE3 off = from_world(*best).inverse() * from_world(other);
    if (off.t.norm() > kAnother || so3_log(off.R).norm() > kAnotherTurn)
      out.rival = std::max(out.rival, other.strength() / best->strength());
  }
  return out;
}

}  // namespace dvi::registration
