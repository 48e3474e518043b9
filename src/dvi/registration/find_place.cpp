#include "dvi/registration/find_place.h"

#include <algorithm>
#include <cmath>

#include "dvi/core/threads.h"
#include "dvi/registration/bird_view.h"
#include "dvi/registration/seen_through.h"

namespace dvi::registration {
namespace {

constexpr double kSubmap = 25;                           // meters of way before and after
constexpr double kEveryPlace = 20;                       // meters of way from one submap to the next
constexpr std::size_t kMostQueries = 16;                 // submaps of the drive that looks for its place
constexpr std::size_t kViews = 32;                       // places whose views are held at once
constexpr std::size_t kFromPair = 8, kVerified = 24;     // candidates
constexpr double kNearGuess = 15, kNearGuessTurn = 0.2;  // meters and radians
constexpr double kAnother = 1, kAnotherTurn = 0.05;      // meters and radians: from here on it is another place
constexpr double kPlaceReach = 60;                       // meters between submaps that may see the same
constexpr double kChance = 0.4;  // of single things that agree in a street that looks alike (docs/experiments/registration.md)
constexpr std::size_t kFewestThings = 16;  // counted for both drives
constexpr double kMostRival = 0.6;
constexpr double kMostPassed = 0.25;  // twice what comes and goes between days

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

/// The smallest share that would be no surprise (95 %, Wilson's interval). Both drives count the same things: they are half as
/// many.
double least_share(const Confirmation& things) {
  constexpr double z = 1.96;
  const double n = 0.5 * static_cast<double>(things.all());
  if (n == 0) return 0;
  const double p = things.share(), center = p + z * z / (2 * n);
  return (center - z * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n))) / (1 + z * z / n);
}

struct Level {
  SE3 level_from_lidar;
  std::vector<Eigen::Vector3d> standing;  // level axes
};

Level leveled(const StillScan& scan) {
  const SE3 level = level_from_lidar(scan.dense.planes);
  return {level, standing_points(scan.points, level)};
}

Level level_at(const KeyScans& keys, std::size_t key) { return leveled(submap(keys, key, kSubmap)); }

std::vector<Eigen::Vector3d> moved(const std::vector<Eigen::Vector3d>& points, const SE3& motion) {
  std::vector<Eigen::Vector3d> out;
  out.reserve(points.size());
  for (const Eigen::Vector3d& p : points) out.push_back(motion * p);
  return out;
}

/// Registers the submaps to each other from a start, and asks the single things in both directions.
PlaceMatch verified(const KeyScans& a_keys, const KeyScans& b_keys, const PlaceFinder::Start& start) {
  const StillScan a_scan = submap(a_keys, start.a, kSubmap), b_scan = submap(b_keys, start.b, kSubmap);
  const Level a = leveled(a_scan), b = leveled(b_scan);
  scan_match::LocalMaps scene = scan_match::make_empty_scene(a_keys.options());
  scene.add(a_scan.dense, {}, Vector6d::Zero());
  scan_match::RegisterOptions options = scan_match::to_register_options(a_keys.options());
  options.coarse_iterations = 10;
  options.iterations = 30;
  options.prior_m = 1;
  const scan_match::Registration fit =
      scan_match::register_scan(b_scan.sparse, start.a_from_b, Vector6d::Zero(), {}, 0, scene, options);
  const SE3 level_a_from_b = a.level_from_lidar * fit.world_from_lidar * b.level_from_lidar.inverse();
  PlaceMatch out{start.a, start.b, fit.world_from_lidar, confirm(a.standing, moved(b.standing, level_a_from_b)), 0, 0};
  const Confirmation other = confirm(b.standing, moved(a.standing, level_a_from_b.inverse()));
  out.things.confirmed += other.confirmed;
  out.things.moved += other.moved;
  return out;
}

/// Both ways.
double passed_share(const KeyScans& a_keys, const KeyScans& b_keys, const PlaceMatch& place) {
  const auto standing_in = [](const KeyScans& keys, std::size_t key, const SE3& world_from_key) {
    const Level level = level_at(keys, key);
    return moved(level.standing, world_from_key * level.level_from_lidar.inverse());
  };
  const SE3 a_world_from_b = a_keys[place.a].world_from_lidar * place.a_from_b;
  const SE3 b_world_from_a = b_keys[place.b].world_from_lidar * place.a_from_b.inverse();
  RayVotes out = sight(a_keys, place.a, standing_in(b_keys, place.b, a_world_from_b));
  const RayVotes other = sight(b_keys, place.b, standing_in(a_keys, place.a, b_world_from_a));
  out.hit += other.hit;
  out.passed += other.passed;
  return out.passed_share();
}

}  // namespace

bool PlaceMatch::sure() const {
  return things.confirmed >= kFewestThings && least_share(things) > kChance && rival < kMostRival && passed_share < kMostPassed;
}

PlaceFinder::PlaceFinder(const KeyScans& a, const KeyScans& b) : a_(a), b_(b) {}

std::vector<PlaceFinder::Start> PlaceFinder::starts(const std::optional<SE3>& a_world_from_b_world) const {
  const std::vector<std::size_t> a_keys = places_of(a_, a_.size()), b_keys = places_of(b_, kMostQueries);
  std::vector<Level> queries(b_keys.size());
  parallel_for(queries.size(), [&](std::size_t k) { queries[k] = level_at(b_, b_keys[k]); });
  const auto guessed = [&](std::size_t a, std::size_t b) {
    return a_[a].world_from_lidar.inverse() * *a_world_from_b_world * b_[b].world_from_lidar;
  };
  const auto in_question = [&](std::size_t a, std::size_t b) {
    return !a_world_from_b_world || guessed(a, b).t.norm() < kPlaceReach;
  };
  const auto near_guess = [&](std::size_t a, std::size_t b, const SE3& a_from_b) {
    if (!a_world_from_b_world) return true;
    const SE3 off = guessed(a, b).inverse() * a_from_b;
    return off.t.norm() < kNearGuess && so3_log(off.R).norm() < kNearGuessTurn;
  };
  std::vector<Start> out;
  for (std::size_t first = 0; first < a_keys.size(); first += kViews) {  // a long drive has many places
    const std::size_t count = std::min(kViews, a_keys.size() - first);
    std::vector<Level> places(count);
    std::vector<BirdView> views(count);
    parallel_for(count, [&](std::size_t i) {
      const std::size_t a = a_keys[first + i];
      if (std::none_of(b_keys.begin(), b_keys.end(), [&](std::size_t b) { return in_question(a, b); })) return;
      places[i] = level_at(a_, a);
      views[i] = bird_view(places[i].standing);
      places[i].standing = {};
    });
    for (std::size_t k = 0; k < queries.size(); ++k) {
      const TurnedViews turned = turned_views(queries[k].standing);
      std::vector<std::vector<Start>> found(count);
      parallel_for(count, [&](std::size_t i) {
        const std::size_t a = a_keys[first + i], b = b_keys[k];
        if (!in_question(a, b)) return;
        if (a_world_from_b_world) found[i].push_back({1, a, b, guessed(a, b)});
        for (const PlacementGuess& c : correlate(views[i], turned, kFromPair)) {
          const SE3 a_from_b = places[i].level_from_lidar.inverse() * c.a_from_b * queries[k].level_from_lidar;
          if (near_guess(a, b, a_from_b)) found[i].push_back({c.score, a, b, a_from_b});
        }
      });
      for (const std::vector<Start>& some : found) out.insert(out.end(), some.begin(), some.end());
    }
  }
  return out;
}

std::optional<PlaceMatch> PlaceFinder::find(const std::optional<SE3>& a_world_from_b_world) const {
  if (a_.empty() || b_.empty()) return std::nullopt;
  std::vector<Start> all = starts(a_world_from_b_world);
  std::stable_sort(all.begin(), all.end(), [](const Start& p, const Start& q) { return p.score > q.score; });
  if (all.size() > kVerified) all.resize(kVerified);
  std::vector<PlaceMatch> places(all.size());
  parallel_for(all.size(), [&](std::size_t i) { places[i] = verified(a_, b_, all[i]); });
  const auto best = std::max_element(places.begin(), places.end(),
                                     [](const PlaceMatch& p, const PlaceMatch& q) { return p.strength() < q.strength(); });
  if (best == places.end() || best->things.confirmed == 0) return std::nullopt;
  // Both places as seen from the best one's key scan.
  const auto from_world = [&](const PlaceMatch& p) {
    return a_[p.a].world_from_lidar * p.a_from_b * b_[p.b].world_from_lidar.inverse() * b_[best->b].world_from_lidar;
  };
  PlaceMatch out = *best;
  for (const PlaceMatch& other : places) {
    const SE3 off = from_world(*best).inverse() * from_world(other);
    if (off.t.norm() > kAnother || so3_log(off.R).norm() > kAnotherTurn)
      out.rival = std::max(out.rival, other.strength() / best->strength());
  }
  out.passed_share = passed_share(a_, b_, out);
  return out;
}

}  // namespace dvi::registration
