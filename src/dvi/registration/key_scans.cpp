#include "dvi/registration/key_scans.h"

#include <cmath>
#include <optional>
#include <utility>

#include "dvi/drive/nearest_in_time.h"
#include "dvi/drive/removed_at.h"

namespace dvi::registration {
namespace {

using scan_match::Feature, scan_match::Features;

constexpr double kKeyStep = 0.5;    // meters of way
constexpr double kPoint = 0.15;     // meters: one point a cube of that edge
constexpr double kBoxMargin = 0.2;  // meters: objects move while they are scanned

Vector6d twist_at(const Trajectory& world_from_lidar, std::int64_t time_ns) {
  constexpr std::int64_t kHalf = 50'000'000;
  const std::optional<SE3> before = world_from_lidar.at(time_ns - kHalf), after = world_from_lidar.at(time_ns + kHalf);
  if (!before || !after) return Vector6d::Zero();
  return se3_log(before->inverse() * *after) / (2e-9 * kHalf);
}

std::vector<KeyScans::Key> keys_of(const Drive& drive, const Trajectory& world_from_lidar) {
  std::vector<KeyScans::Key> out;
  for (std::size_t i = 0; i < drive.scan_headers.size(); ++i) {
    const std::int64_t time = drive.scan_headers[i].time_ns;
    const std::optional<SE3> pose = world_from_lidar.at(time);
    if (!pose) continue;
    const double moved = out.empty() ? 0 : (pose->t - out.back().world_from_lidar.t).norm();
    if (!out.empty() && moved < kKeyStep) continue;
    out.push_back({i, *pose, twist_at(world_from_lidar, time), out.empty() ? 0 : out.back().way_m + moved});
  }
  return out;
}

/// What of a scan the labels and mask files of the frame at its time say is no background.
class Traffic {
 public:
  Traffic(const Drive& drive, const ScanHeader& header) : drive_(drive) {
    const Frame* const nearest = nearest_in_time(drive.frames, header.time_ns, header.end_ns - header.start_ns);
    if (!nearest) return;
    labels_ = &nearest->labels;
    if (!drive.masks.empty()) mask_ = drive.masks[static_cast<std::size_t>(nearest - drive.frames.data())];
  }

  bool holds(const Eigen::Vector3d& point) const {
    if (labels_ != nullptr && is_in_any_box(*labels_, point, kBoxMargin)) return true;
    if (!mask_ || mask_->empty()) return false;
    return in_image(drive_.camera_from_lidar * point, drive_.camera, *mask_) == InImage::removed;
  }

 private:
  const Drive& drive_;
  const std::vector<Label>* labels_ = nullptr;
  std::shared_ptr<const cv::Mat1b> mask_;
};

std::vector<scan_match::Feature> still(const std::vector<scan_match::Feature>& features, const Traffic& traffic,
                                       const Vector6d& twist) {
  std::vector<scan_match::Feature> out;
  out.reserve(features.size());
  for (const scan_match::Feature& f : features)
    if (!traffic.holds(f.point.cast<double>())) out.push_back({scan_match::compensate(f, twist).cast<float>(), 0});
  return out;
}

std::vector<scan_match::Feature> returns_of(const Scan& scan, double nearest_m, double farthest_m) {
  std::vector<scan_match::Feature> out;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const double range = scan.points[i].norm();
    if (range >= nearest_m && range <= farthest_m) out.push_back({scan.points[i], scan.time[i]});
  }
  return scan_match::thin_features(out, kPoint);
}

}  // namespace

KeyScans::KeyScans(const Drive& drive, const scan_match::MatchOptions& options, const Trajectory& world_from_lidar)
    : drive_(&drive),
      options_(scan_match::adapt_to_sensor(options, drive)),
      world_from_lidar_(world_from_lidar),
      keys_(keys_of(drive, world_from_lidar)) {
  scans_ = Lazy<StillScan>(keys_.size(), [drive = drive_, suited = options_, keys = keys_](std::size_t i) {
    const std::shared_ptr<const Scan> scan = drive->scans[keys[i].scan];
    const scan_match::ScanFeatures all =
        scan_match::extract_scan_features(*drive, *scan, scan_match::find_scan_rings(*drive, *scan), suited);
    const Traffic traffic(*drive, drive->scan_headers[keys[i].scan]);
    const auto of = [&](const scan_match::Features& f) {
      return scan_match::Features{still(f.planes, traffic, keys[i].twist), still(f.edges, traffic, keys[i].twist)};
    };
    const double nearest = suited.min_range_m.value_or(drive->min_range_m());
    return StillScan{of(all.dense), of(all.sparse),
                     still(returns_of(*scan, nearest, scan_match::find_feature_range(suited)), traffic, keys[i].twist)};
  });
}

KeyScans KeyScans::in(const SE3& other_from_world) const {
  KeyScans out = *this;
  out.world_from_lidar_ = world_from_lidar_.in(other_from_world);
  for (Key& key : out.keys_) key.world_from_lidar = other_from_world * key.world_from_lidar;
  return out;
}

StillScan submap(const KeyScans& keys, std::size_t i, double way_m) {
  StillScan out;
  const SE3 lidar_from_world = keys[i].world_from_lidar.inverse();
  for (std::size_t k = 0; k < keys.size(); ++k) {
    if (std::abs(keys[k].way_m - keys[i].way_m) > way_m) continue;
    const std::shared_ptr<const StillScan> scan = keys.scan(k);
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
  out.points = scan_match::thin_features(out.points, kPoint);
  return out;
}

}  // namespace dvi::registration
