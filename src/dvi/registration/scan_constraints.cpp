#include "dvi/registration/scan_constraints.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace dvi::registration {
namespace {

struct NearKey {
  std::size_t drive, key;
  double distance;
};

/// A local map of the placed drives around a position, in the axes of the nearest key scan (the anchor).
struct LocalScene {
  std::size_t drive = 0, anchor = 0;
  SE3 anchor_from_world;
  Eigen::Vector3d center_in_world;
  scan_match::LocalMaps scene;
  double share = 0, residual_m = 0;  // result for the anchor, which is left out of the scene
};

struct Fit {
  scan_match::Registration registration;
  double share = 0;
};

scan_match::RegisterOptions make_register_options(const scan_match::MatchOptions& match, int coarse_iterations) {
  scan_match::RegisterOptions options = scan_match::to_register_options(match);
  options.coarse_iterations = coarse_iterations;
  options.iterations += coarse_iterations;
  options.prior_m = 1;
  return options;
}

Fit register_features(const scan_match::Features& sparse, const SE3& guess, scan_match::LocalMaps& scene,
                      const scan_match::RegisterOptions& options) {
  const scan_match::Registration registration = scan_match::register_scan(sparse, {guess}, scene, options);
  return {registration, scan_match::compute_scene_share(sparse, registration, scene)};
}

std::optional<LocalScene> build_scene(const PlacedKeys& placed, const Eigen::Vector3d& position) {
  std::vector<NearKey> near;
  for (std::size_t d = 0; d < placed.size(); ++d)
    for (std::size_t k = 0; k < placed[d]->size(); ++k)
      if (const double distance = ((*placed[d])[k].world_from_lidar.t - position).norm();
          distance < kScanConstraint.max_distance_m)
        near.push_back({d, k, distance});
  std::stable_sort(near.begin(), near.end(), [](const NearKey& p, const NearKey& q) { return p.distance < q.distance; });
  if (near.size() < 2) return std::nullopt;
  const NearKey anchor = near.front();
  const auto pose = [&](const NearKey& k) { return (*placed[k.drive])[k.key].world_from_lidar; };
  const auto features = [&](const NearKey& k) { return placed[k.drive]->scan(k.key); };
  const scan_match::MatchOptions& match = placed[anchor.drive]->options();
  LocalScene out{anchor.drive, anchor.key, pose(anchor).inverse(), position, scan_match::make_empty_scene(match), 0, 0};
  std::vector<NearKey> taken;
  for (const NearKey& k : near) {
    if (&k == &near.front() || taken.size() == kScanConstraint.max_scans) continue;
    const auto is_close = [&](const NearKey& t) {
      return t.drive == k.drive && (pose(t).t - pose(k).t).norm() < kScanConstraint.scan_spacing_m;
    };
    if (std::any_of(taken.begin(), taken.end(), is_close)) continue;
    taken.push_back(k);
    out.scene.add(features(k)->dense, out.anchor_from_world * pose(k), Vector6d::Zero());
  }
  const Fit own = register_features(features(anchor)->sparse, {}, out.scene, make_register_options(match, 0));
  out.share = own.share;
  out.residual_m = own.registration.residual_m;
  return out;
}

class ConstraintSearch {
 public:
  ConstraintSearch(const PlacedKeys& placed, const KeyScans& keys, const Tick& tick)
      : placed_(placed), keys_(keys), tick_(tick) {}

  /// Follows the drive from a key scan to its end (step 1) or to its start (step -1).
  void follow(const PosedKey& first, int step, std::vector<ScanConstraint>& out) {
    SE3 pose = first.world_from_lidar;
    for (std::size_t k = first.key; k < keys_.size(); k += static_cast<std::size_t>(step)) {  // wraps around below 0
      if (k != first.key)
        pose = pose * (keys_[k - static_cast<std::size_t>(step)].world_from_lidar.inverse() * keys_[k].world_from_lidar);
      if (const std::optional<ScanConstraint> found = register_key(k, pose)) {
        out.push_back(*found);
        pose = (*placed_[found->drive])[found->a].world_from_lidar * found->a_from_b;
      }
      tick_();
    }
  }

 private:
  std::optional<ScanConstraint> register_key(std::size_t k, const SE3& expected) {
    if (!scene_ || (scene_->center_in_world - expected.t).norm() > kScanConstraint.max_center_distance_m)
      scene_ = build_scene(placed_, expected.t);
    if (!scene_) return std::nullopt;
    const SE3 guess = scene_->anchor_from_world * expected;
    const Fit found = register_features(keys_.scan(k)->sparse, guess, scene_->scene, make_register_options(keys_.options(), 4));
    const scan_match::Registration& fit = found.registration;
    const SE3 off = guess.inverse() * fit.world_from_lidar;
    const bool fits =
        fit.degenerate == 0 &&
        found.share > std::max(kScanConstraint.min_static_share, kScanConstraint.min_relative_share * scene_->share) &&
        fit.residual_m < kScanConstraint.max_relative_residual * scene_->residual_m;
    if (!fits || off.t.norm() > kScanConstraint.max_correction_m || so3_log(off.R).norm() > kScanConstraint.max_correction_rad)
      return std::nullopt;
    return ScanConstraint{scene_->drive, scene_->anchor, k, fit.world_from_lidar, fit.information, fit.residual_m};
  }

  const PlacedKeys& placed_;
  const KeyScans& keys_;
  const Tick& tick_;
  std::optional<LocalScene> scene_;
};

}  // namespace

std::vector<ScanConstraint> find_scan_constraints(const PlacedKeys& placed, const KeyScans& keys, const PosedKey& first,
                                                  const Tick& tick) {
  std::vector<ScanConstraint> out;
  ConstraintSearch(placed, keys, tick).follow(first, 1, out);
  if (first.key > 0) {
    const SE3 first_from_before = keys[first.key].world_from_lidar.inverse() * keys[first.key - 1].world_from_lidar;
    ConstraintSearch(placed, keys, tick).follow({first.key - 1, first.world_from_lidar * first_from_before}, -1, out);
  }
  return out;
}

}  // namespace dvi::registration
