#include "dvi/registration/key_scans.h"

#include <cmath>
#include <optional>
#include <utility>

#include "dvi/drive/nearest_in_time.h"
#include "dvi/drive/removed_at.h"

namespace dvi::registration {
namespace {

using scan_match::Feature, scan_match::Features;

Vector6d compute_twist(const Trajectory& world_from_lidar, std::int64_t time_ns) {
  constexpr std::int64_t kHalfNs = 50'000'000;
  const std::optional<SE3> before = world_from_lidar.at(time_ns - kHalfNs), after = world_from_lidar.at(time_ns + kHalfNs);
  if (!before || !after) return Vector6d::Zero();
  return se3_log(before->inverse() * *after) / (2e-9 * kHalfNs);
}

std::vector<KeyScans::Key> select_keys(const Drive& drive, const Trajectory& world_from_lidar) {
  std::vector<KeyScans::Key> out;
  for (std::size_t i = 0; i < drive.scan_headers.size(); ++i) {
    const std::int64_t time = drive.scan_headers[i].time_ns;
    const std::optional<SE3> pose = world_from_lidar.at(time);
    if (!pose) continue;
    const double distance_m = out.empty() ? 0 : (pose->t - out.back().world_from_lidar.t).norm();
    if (!out.empty() && distance_m < kKeyScan.min_step_m) continue;
    out.push_back({i, *pose, compute_twist(world_from_lidar, time), out.empty() ? 0 : out.back().path_length_m + distance_m});
  }
  return out;
}

/// The labeled objects and the mask of the frame that is nearest in time to a scan.
class ObjectsOfScan {
 public:
  ObjectsOfScan(const Drive& drive, const ScanHeader& header) : drive_(drive) {
    const Frame* const nearest = nearest_in_time(drive.frames, header.time_ns, header.end_ns - header.start_ns);
    if (!nearest) return;
    labels_ = &nearest->labels;
    if (!drive.masks.empty()) mask_ = drive.masks[static_cast<std::size_t>(nearest - drive.frames.data())];
  }

  bool contain(const Eigen::Vector3d& point) const {
    if (labels_ != nullptr && is_in_any_box(*labels_, point, kKeyScan.box_margin_m)) return true;
    if (!mask_ || mask_->empty()) return false;
    return in_image(drive_.camera_from_lidar * point, drive_.camera, *mask_) == InImage::removed;
  }

 private:
  const Drive& drive_;
  const std::vector<Label>* labels_ = nullptr;
  std::shared_ptr<const cv::Mat1b> mask_;
};

std::vector<scan_match::Feature> keep_static(const std::vector<scan_match::Feature>& features, const ObjectsOfScan& objects,
                                             const Vector6d& twist) {
  std::vector<scan_match::Feature> out;
  out.reserve(features.size());
  for (const scan_match::Feature& f : features)
    if (!objects.contain(f.point.cast<double>())) out.push_back({scan_match::compensate(f, twist).cast<float>(), 0});
  return out;
}

std::vector<scan_match::Feature> thin_returns(const Scan& scan, double nearest_m, double farthest_m) {
  std::vector<scan_match::Feature> out;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const double range = scan.points[i].norm();
    if (range >= nearest_m && range <= farthest_m) out.push_back({scan.points[i], scan.time[i]});
  }
  return scan_match::thin_features(out, kKeyScan.point_spacing_m);
}

}  // namespace

KeyScans::KeyScans(const Drive& drive, const scan_match::MatchOptions& options, const Trajectory& world_from_lidar)
    : drive_(&drive),
      options_(scan_match::adapt_to_sensor(options, drive)),
      world_from_lidar_(world_from_lidar),
      keys_(select_keys(drive, world_from_lidar)) {
  scans_ = Lazy<StaticScan>(keys_.size(), [drive = drive_, options = options_, keys = keys_](std::size_t i) {
    const std::shared_ptr<const Scan> scan = drive->scans[keys[i].scan];
    const scan_match::ScanFeatures all =
        scan_match::extract_scan_features(*drive, *scan, scan_match::find_scan_rings(*drive, *scan), options);
    const ObjectsOfScan objects(*drive, drive->scan_headers[keys[i].scan]);
    const auto keep = [&](const scan_match::Features& f) {
      return scan_match::Features{keep_static(f.planes, objects, keys[i].twist), keep_static(f.edges, objects, keys[i].twist)};
    };
    const double nearest = options.min_range_m.value_or(drive->min_range_m());
    return StaticScan{
        keep(all.dense), keep(all.sparse),
        keep_static(thin_returns(*scan, nearest, scan_match::find_feature_range(options)), objects, keys[i].twist)};
  });
}

KeyScans KeyScans::transform(const SE3& other_from_world) const {
  KeyScans out = *this;
  out.world_from_lidar_ = world_from_lidar_.in(other_from_world);
  for (Key& key : out.keys_) key.world_from_lidar = other_from_world * key.world_from_lidar;
  return out;
}

StaticScan make_submap(const KeyScans& keys, std::size_t i, double max_path_m) {
  StaticScan out;
  const SE3 lidar_from_world = keys[i].world_from_lidar.inverse();
  for (std::size_t k = 0; k < keys.size(); ++k) {
    if (std::abs(keys[k].path_length_m - keys[i].path_length_m) > max_path_m) continue;
    const std::shared_ptr<const StaticScan> scan = keys.scan(k);
    const SE3 lidar_from_k = lidar_from_world * keys[k].world_from_lidar;
    const auto append = [&](std::vector<scan_match::Feature>& to, const std::vector<scan_match::Feature>& from) {
      for (const scan_match::Feature& f : from) to.push_back({(lidar_from_k * f.point.cast<double>()).cast<float>(), 0});
    };
    append(out.dense.planes, scan->dense.planes);
    append(out.dense.edges, scan->dense.edges);
    append(out.sparse.planes, scan->sparse.planes);
    append(out.sparse.edges, scan->sparse.edges);
    append(out.points, scan->points);
  }
  const scan_match::MatchOptions& options = keys.options();
  out.sparse = {scan_match::thin_features(out.sparse.planes, options.cell_m),
                scan_match::thin_features(out.sparse.edges, options.voxel_m)};
  out.points = scan_match::thin_features(out.points, kKeyScan.point_spacing_m);
  return out;
}

}  // namespace dvi::registration
