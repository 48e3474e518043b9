#include "dvi/registration/find_place.h"

#include <algorithm>
#include <cmath>

#include "dvi/core/threads.h"
#include "dvi/registration/bird_view.h"
#include "dvi/registration/ray_votes.h"

namespace dvi::registration {
namespace {

/// The indices of at most `max_count` key scans, evenly spaced along the path.
std::vector<std::size_t> select_submaps(const KeyScans& keys, std::size_t max_count) {
  const double path_m = keys.empty() ? 0 : keys[keys.size() - 1].path_length_m;
  const auto count = std::clamp<std::size_t>(static_cast<std::size_t>(path_m / kPlace.submap_spacing_m), 1, max_count);
  std::vector<std::size_t> out;
  std::size_t next = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double at = path_m * (static_cast<double>(k) + 0.5) / static_cast<double>(count);
    while (next + 1 < keys.size() && keys[next].path_length_m < at) ++next;
    if (out.empty() || out.back() != next) out.push_back(next);
  }
  return out;
}

/// The lower bound of the 95 % interval of the inlier ratio (Wilson 1927). Both directions count the same landmarks, so that
/// the sample size is half the total.
double compute_lower_bound(const LandmarkVotes& landmarks) {
  constexpr double z = 1.96;
  const double n = 0.5 * static_cast<double>(landmarks.total());
  if (n == 0) return 0;
  const double p = landmarks.inlier_ratio(), center = p + z * z / (2 * n);
  return (center - z * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n))) / (1 + z * z / n);
}

struct LevelSubmap {
  SE3 level_from_lidar;
  std::vector<Eigen::Vector3d> upright;  // level axes
};

LevelSubmap level(const StaticScan& scan) {
  const SE3 transform = level_from_lidar(scan.dense.planes);
  return {transform, extract_upright_points(scan.points, transform)};
}

LevelSubmap make_level_submap(const KeyScans& keys, std::size_t key) {
  return level(make_submap(keys, key, kPlace.submap_path_m));
}

std::vector<Eigen::Vector3d> transform(const std::vector<Eigen::Vector3d>& points, const SE3& motion) {
  std::vector<Eigen::Vector3d> out;
  out.reserve(points.size());
  for (const Eigen::Vector3d& p : points) out.push_back(motion * p);
  return out;
}

/// Registers the submaps of a candidate to each other and checks the landmarks in both directions.
PlaceMatch verify(const KeyScans& a_keys, const KeyScans& b_keys, const PlaceFinder::Candidate& candidate) {
  const StaticScan a_scan = make_submap(a_keys, candidate.a, kPlace.submap_path_m);
  const StaticScan b_scan = make_submap(b_keys, candidate.b, kPlace.submap_path_m);
  const LevelSubmap a = level(a_scan), b = level(b_scan);
  scan_match::LocalMaps scene = scan_match::make_empty_scene(a_keys.options());
  scene.add(a_scan.dense, {}, Vector6d::Zero());
  scan_match::RegisterOptions options = scan_match::to_register_options(a_keys.options());
  options.coarse_iterations = 10;
  options.iterations = 30;
  options.prior_m = 1;
  const scan_match::Registration fit = scan_match::register_scan(b_scan.sparse, {candidate.a_from_b}, scene, options);
  const SE3 level_a_from_b = a.level_from_lidar * fit.world_from_lidar * b.level_from_lidar.inverse();
  PlaceMatch out{
      candidate.a, candidate.b, fit.world_from_lidar, check_landmarks(a.upright, transform(b.upright, level_a_from_b)), 0, 0};
  const LandmarkVotes other = check_landmarks(b.upright, transform(a.upright, level_a_from_b.inverse()));
  out.landmarks.inliers += other.inliers;
  out.landmarks.outliers += other.outliers;
  return out;
}

/// The share of upright points that rays passed, in both directions together.
double compute_passed_share(const KeyScans& a_keys, const KeyScans& b_keys, const PlaceMatch& place) {
  const auto upright_points = [](const KeyScans& keys, std::size_t key, const SE3& world_from_key) {
    const LevelSubmap submap = make_level_submap(keys, key);
    return transform(submap.upright, world_from_key * submap.level_from_lidar.inverse());
  };
  const SE3 a_world_from_b = a_keys[place.a].world_from_lidar * place.a_from_b;
  const SE3 b_world_from_a = b_keys[place.b].world_from_lidar * place.a_from_b.inverse();
  RayVotes out = count_ray_votes(a_keys, place.a, upright_points(b_keys, place.b, a_world_from_b));
  const RayVotes other = count_ray_votes(b_keys, place.b, upright_points(a_keys, place.a, b_world_from_a));
  out.hit += other.hit;
  out.passed += other.passed;
  return out.passed_share();
}

}  // namespace

bool PlaceMatch::is_certain() const {
  return landmarks.inliers >= kPlace.min_inliers && compute_lower_bound(landmarks) > kPlace.chance_inlier_ratio &&
         second_best_ratio < kPlace.max_second_best_ratio && passed_share < kPlace.max_passed_share;
}

PlaceFinder::PlaceFinder(const KeyScans& a, const KeyScans& b) : a_(a), b_(b) {}

std::vector<PlaceFinder::Candidate> PlaceFinder::propose(const std::optional<SE3>& a_world_from_b_world) const {
  const std::vector<std::size_t> a_keys = select_submaps(a_, a_.size());
  const std::vector<std::size_t> b_keys = select_submaps(b_, kPlace.max_queries);
  std::vector<LevelSubmap> queries(b_keys.size());
  parallel_for(queries.size(), [&](std::size_t k) { queries[k] = make_level_submap(b_, b_keys[k]); });
  const auto guess = [&](std::size_t a, std::size_t b) {
    return a_[a].world_from_lidar.inverse() * *a_world_from_b_world * b_[b].world_from_lidar;
  };
  const auto may_overlap = [&](std::size_t a, std::size_t b) {
    return !a_world_from_b_world || guess(a, b).t.norm() < kPlace.max_pair_distance_m;
  };
  const auto is_near_guess = [&](std::size_t a, std::size_t b, const SE3& a_from_b) {
    if (!a_world_from_b_world) return true;
    const SE3 off = guess(a, b).inverse() * a_from_b;
    return off.t.norm() < kPlace.max_guess_error_m && so3_log(off.R).norm() < kPlace.max_guess_error_rad;
  };
  std::vector<Candidate> out;
  for (std::size_t first = 0; first < a_keys.size(); first += kPlace.max_views) {  // bounds the memory on long drives
    const std::size_t count = std::min(kPlace.max_views, a_keys.size() - first);
    std::vector<LevelSubmap> places(count);
    std::vector<BirdView> views(count);
    parallel_for(count, [&](std::size_t i) {
      const std::size_t a = a_keys[first + i];
      if (std::none_of(b_keys.begin(), b_keys.end(), [&](std::size_t b) { return may_overlap(a, b); })) return;
      places[i] = make_level_submap(a_, a);
      views[i] = make_bird_view(places[i].upright);
      places[i].upright = {};
    });
    for (std::size_t k = 0; k < queries.size(); ++k) {
      const RotatedViews rotated = make_rotated_views(queries[k].upright);
      std::vector<std::vector<Candidate>> found(count);
      parallel_for(count, [&](std::size_t i) {
        const std::size_t a = a_keys[first + i], b = b_keys[k];
        if (!may_overlap(a, b)) return;
        if (a_world_from_b_world) found[i].push_back({1, a, b, guess(a, b)});
        for (const PlacementGuess& c : correlate(views[i], rotated, kPlace.candidates_per_pair)) {
          const SE3 a_from_b = places[i].level_from_lidar.inverse() * c.a_from_b * queries[k].level_from_lidar;
          if (is_near_guess(a, b, a_from_b)) found[i].push_back({c.score, a, b, a_from_b});
        }
      });
      for (const std::vector<Candidate>& some : found) out.insert(out.end(), some.begin(), some.end());
    }
  }
  return out;
}

std::optional<PlaceMatch> PlaceFinder::find(const std::optional<SE3>& a_world_from_b_world) const {
  if (a_.empty() || b_.empty()) return std::nullopt;
  std::vector<Candidate> all = propose(a_world_from_b_world);
  std::stable_sort(all.begin(), all.end(), [](const Candidate& p, const Candidate& q) { return p.score > q.score; });
  if (all.size() > kPlace.max_verified) all.resize(kPlace.max_verified);
  std::vector<PlaceMatch> places(all.size());
  parallel_for(all.size(), [&](std::size_t i) { places[i] = verify(a_, b_, all[i]); });
  const auto best = std::max_element(places.begin(), places.end(),
                                     [](const PlaceMatch& p, const PlaceMatch& q) { return p.score() < q.score(); });
  if (best == places.end() || best->landmarks.inliers == 0) return std::nullopt;
  const auto from_world = [&](const PlaceMatch& p) {
    return a_[p.a].world_from_lidar * p.a_from_b * b_[p.b].world_from_lidar.inverse() * b_[best->b].world_from_lidar;
  };
  PlaceMatch out = *best;
  for (const PlaceMatch& other : places) {
    const SE3 off = from_world(*best).inverse() * from_world(other);
    if (off.t.norm() > kPlace.other_place_m || so3_log(off.R).norm() > kPlace.other_place_rad)
      out.second_best_ratio = std::max(out.second_best_ratio, other.score() / best->score());
  }
  out.passed_share = compute_passed_share(a_, b_, out);
  return out;
}

}  // namespace dvi::registration
