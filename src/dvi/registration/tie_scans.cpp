#include "dvi/registration/tie_scans.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace dvi::registration {
namespace {

// Meters and radians.
constexpr double kTieReach = 60;                        // to scans that may see the same
constexpr double kScansApart = 2.5;                     // between scans of a local map
constexpr std::size_t kMostScans = 12;                  // of a local map
constexpr double kSamePlace = 5;                        // a local map serves so far
constexpr double kLeastShare = 0.15;                    // of what stands, that lies on surfaces of the others
constexpr double kLeastOfOwn = 0.3;                     // of that share of a scan of the place itself: cars and leaves differ
constexpr double kMostResidual = 1.5;                   // of that scan's
constexpr double kFarthestOff = 0.5, kMostTurn = 0.03;  // from where odometry puts the scan

struct KeyOf {
  std::size_t drive, key;
  double distance;
};

/// What drives that have their place saw round a position, in the axes of the nearest scan.
struct Neighborhood {
  std::size_t drive = 0, anchor = 0;
  SE3 anchor_from_world;
  Eigen::Vector3d center;  // world
  scan_match::LocalMaps scene;
  double share = 0, residual_m = 0;  // of the anchor itself, which is left out of the scene
};

struct Fit {
  scan_match::Registration registration;
  double share = 0;
};

Fit fit(const scan_match::Features& sparse, const SE3& guess, int coarse, scan_match::LocalMaps& scene,
        const scan_match::MatchOptions& match) {
  scan_match::RegisterOptions options = scan_match::to_register_options(match);
  options.coarse_iterations = coarse;
  options.iterations += coarse;
  options.prior_m = 1;
  Fit out;
  out.registration = scan_match::register_scan(sparse, guess, Vector6d::Zero(), {}, 0, scene, options);
  out.share = scan_match::compute_scene_share(sparse, Vector6d::Zero(), out.registration.world_from_lidar, scene);
  return out;
}

std::optional<Neighborhood> neighborhood(const PlacedKeys& placed, const Eigen::Vector3d& position) {
  std::vector<KeyOf> near;
  for (std::size_t d = 0; d < placed.size(); ++d)
    for (std::size_t k = 0; k < placed[d]->size(); ++k)
      if (const double distance = ((*placed[d])[k].world_from_lidar.t - position).norm(); distance < kTieReach)
        near.push_back({d, k, distance});
  std::stable_sort(near.begin(), near.end(), [](const KeyOf& p, const KeyOf& q) { return p.distance < q.distance; });
  if (near.size() < 2) return std::nullopt;
  const KeyOf anchor = near.front();
  const auto pose = [&](const KeyOf& k) { return (*placed[k.drive])[k.key].world_from_lidar; };
  const auto features = [&](const KeyOf& k) { return placed[k.drive]->scan(k.key); };
  const scan_match::MatchOptions& match = placed[anchor.drive]->options();
  Neighborhood out{anchor.drive, anchor.key, pose(anchor).inverse(), position, scan_match::make_empty_scene(match), 0, 0};
  std::vector<KeyOf> taken;
  for (const KeyOf& k : near) {
    if (&k == &near.front() || taken.size() == kMostScans) continue;
    const auto close = [&](const KeyOf& t) { return t.drive == k.drive && (pose(t).t - pose(k).t).norm() < kScansApart; };
    if (std::any_of(taken.begin(), taken.end(), close)) continue;
    taken.push_back(k);
    out.scene.add(features(k)->dense, out.anchor_from_world * pose(k), Vector6d::Zero());
  }
  const Fit own = fit(features(anchor)->sparse, {}, 0, out.scene, match);
  out.share = own.share;
  out.residual_m = own.registration.residual_m;
  return out;
}

class Walk {
 public:
  Walk(const PlacedKeys& placed, const KeyScans& keys, const Tick& tick) : placed_(placed), keys_(keys), tick_(tick) {}

  /// From key scan `first`, which lies at `pose`, up to the end of the drive, step +1 or -1.
  void operator()(std::size_t first, SE3 pose, int step, std::vector<Tie>& ties) {
    for (std::size_t k = first; k < keys_.size(); k += static_cast<std::size_t>(step)) {  // wraps below 0
      if (k != first)
        pose = pose * (keys_[k - static_cast<std::size_t>(step)].world_from_lidar.inverse() * keys_[k].world_from_lidar);
      if (const std::optional<Tie> tie = tie_of(k, pose)) {
        ties.push_back(*tie);
        pose = (*placed_[tie->drive])[tie->a].world_from_lidar * tie->a_from_b;
      }
      tick_();
    }
  }

 private:
  std::optional<Tie> tie_of(std::size_t k, const SE3& expected) {
    if (!place_ || (place_->center - expected.t).norm() > kSamePlace) place_ = neighborhood(placed_, expected.t);
    if (!place_) return std::nullopt;
    const SE3 guess = place_->anchor_from_world * expected;
    const Fit found = fit(keys_.scan(k)->sparse, guess, 4, place_->scene, keys_.options());
    const scan_match::Registration& fit = found.registration;
    const SE3 off = guess.inverse() * fit.world_from_lidar;
    const bool fits = fit.degenerate == 0 && found.share > std::max(kLeastShare, kLeastOfOwn * place_->share) &&
                      fit.residual_m < kMostResidual * place_->residual_m;
    if (!fits || off.t.norm() > kFarthestOff || so3_log(off.R).norm() > kMostTurn) return std::nullopt;
    return Tie{place_->drive, place_->anchor, k, fit.world_from_lidar, fit.information, fit.residual_m};
  }

  const PlacedKeys& placed_;
  const KeyScans& keys_;
  const Tick& tick_;
  std::optional<Neighborhood> place_;
};

}  // namespace

std::vector<Tie> tie_scans(const PlacedKeys& placed, const KeyScans& keys, std::size_t first, const SE3& world_from_first,
                           const Tick& tick) {
  std::vector<Tie> ties;
  Walk(placed, keys, tick)(first, world_from_first, 1, ties);
  if (first > 0) {
    const SE3 before = world_from_first * (keys[first].world_from_lidar.inverse() * keys[first - 1].world_from_lidar);
    Walk(placed, keys, tick)(first - 1, before, -1, ties);
  }
  return ties;
}

}  // namespace dvi::registration
