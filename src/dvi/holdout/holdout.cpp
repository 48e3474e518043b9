#include "dvi/holdout/holdout.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/core/random.h"
#include "dvi/core/threads.h"
#include "dvi/image/region.h"

namespace dvi::holdout {
namespace {

constexpr double kRangeNoiseM = 0.02;  // largest error of a range
constexpr float kIntensity = 0.3F;
constexpr std::uint64_t kPaintSeed = 0x9A127, kMaskErrorSeed = 0x3A5C5;

/// Derives the seed of one part, which does not depend on the parts made before it.
std::uint64_t derive_seed(int seed, std::uint64_t a, std::uint64_t b = 0) {
  return Random(Random(Random(static_cast<std::uint64_t>(seed)).next() ^ a).next() ^ b).next();
}

/// Keeps the items that have a pose and returns their indices.
template <class Stamped>
std::vector<std::size_t> keep_posed(std::vector<Stamped>& items, const Trajectory& poses) {
  std::vector<Stamped> kept;
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (!poses.at(items[i].time_ns)) continue;
    kept.push_back(items[i]);
    indices.push_back(i);
  }
  items = std::move(kept);
  return indices;
}

/// Returns the poses at the scans, which are those that the files of the case have.
Trajectory sample_at_scans(const std::vector<ScanHeader>& scan_headers, const Trajectory& poses) {
  std::vector<StampedPose> out;
  for (const ScanHeader& header : scan_headers) out.push_back({header.time_ns, *poses.at(header.time_ns)});
  return Trajectory(std::move(out));
}

Box transform(const SE3& target_from_source, const Box& box) { return {target_from_source * box.frame_from_box, box.size}; }

/// A cone around a box that moves during a scan. Returns outside it cannot be behind the box.
class OcclusionCone {
 public:
  OcclusionCone(const Box& lidar_box, double seconds) : axis_(lidar_box.frame_from_box.t.cast<float>()) {
    constexpr double kMaxSpeedMS = 60;  // sum of the speeds of box and sensor
    const double radius = 0.5 * lidar_box.size.norm() + kMaxSpeedMS * seconds;
    const double distance = axis_.norm();
    nearest_ = static_cast<float>(distance - radius);
    cosine_ = nearest_ > 0 ? static_cast<float>(std::sqrt(1 - std::pow(radius / distance, 2))) : -2.0F;
    axis_.normalize();
  }
  bool contains(const Eigen::Vector3f& p) const {
    const float range = p.norm();
    return range > nearest_ && axis_.dot(p) > cosine_ * range;
  }

 private:
  Eigen::Vector3f axis_;
  float nearest_, cosine_;
};

}  // namespace

Holdout::Holdout(const std::vector<HoldoutCamera>& cameras, const Trajectory& world_from_lidar, const HoldoutOptions& options)
    : drive_(cameras.front().drive), options_(options), scans_(drive_.scans) {
  const Drive& drive = cameras.front().drive;
  scan_indices_ = keep_posed(drive_.scan_headers, world_from_lidar);
  drive_.poses = sample_at_scans(drive_.scan_headers, world_from_lidar);
  drive_.world_scale = 1;
  target_ = take_pictures(cameras.front(), drive_);
  for (std::size_t k = 1; k < cameras.size(); ++k) {
    more_drives_.push_back(cameras[k].drive);
    more_drives_.back().poses = drive_.poses;
    more_.push_back(take_pictures(cameras[k], more_drives_.back()));
  }
  if (target_.frames.empty())
    throw InputError(drive.path, "no frame has a pose and a scan near it",
                     "check that poses, scans, and images use the same clock");
  if (options.scenario != Scenario::banner) {
    road_ = std::make_shared<const DrivenPath>(drive, world_from_lidar);
    vehicle_.emplace(options.scenario, derive_seed(options.seed, static_cast<std::uint64_t>(options.scenario)), road_,
                     TimeSpan{drive_.frames.front().time_ns, drive_.frames.back().time_ns});
    if (options.scenario == Scenario::parked) vehicle_->avoid_obstacles(drive, world_from_lidar);
    if (is_labeled()) add_labels();
  }
  visible_ = find_visible_frames(drive_);
  if (std::find(visible_.begin(), visible_.end(), true) == visible_.end())
    throw InputError(drive.path,
                     fmt::format("the {} vehicle of seed {} is in no image of camera {}", name(options.scenario), options.seed,
                                 drive.camera_name),
                     "choose another --scenario, --seed, or --camera, or more --frames");
  draw_mask_errors();
}

// Keeps the frames of the drive that have a pose, and removes its images, masks, and scans.
Holdout::Pictures Holdout::take_pictures(const HoldoutCamera& camera, Drive& drive) const {
  drive.images = {}, drive.masks = {}, drive.scans = {};
  return {camera.drive.images, camera.traffic, keep_posed(drive.frames, drive.poses), {}};
}

void Holdout::add_labels() {
  for (const Frame& frame : drive_.frames)
    for (const Label& label : frame.labels) track_ = std::max(track_, label.track + 1);
  for (Frame& frame : drive_.frames) {
    Label label;
    label.track = track_, label.type = vehicle_->type();
    label.box = transform(drive_.poses.at(frame.time_ns)->inverse(), vehicle_->box_at(frame.time_ns));
    frame.labels.push_back(std::move(label));
  }
}

std::vector<bool> Holdout::find_visible_frames(const Drive& drive) const {
  std::vector<std::uint8_t> visible(drive.frames.size());
  parallel_for(visible.size(), [&](std::size_t i) { visible[i] = cv::countNonZero(paint(drive, i).pixels) > 0 ? 1 : 0; });
  return {visible.begin(), visible.end()};
}

// The errors of cameras are independent, because detectors process one image at a time.
void Holdout::draw_mask_errors() {
  const auto draw = [&](const Drive& drive, std::size_t camera, const std::vector<bool>& visible) {
    return draw_errors(options_.mask_errors, visible, {drive.camera.width, drive.camera.height},
                       derive_seed(options_.seed, kMaskErrorSeed, camera));
  };
  target_.errors = draw(drive_, 0, visible_);
  for (std::size_t k = 0; k < more_.size(); ++k)
    more_[k].errors = draw(more_drives_[k], k + 1, find_visible_frames(more_drives_[k]));
}

Painting Holdout::paint(const Drive& drive, std::size_t frame) const {
  const std::uint64_t seed = derive_seed(options_.seed, kPaintSeed);
  if (!vehicle_) return paint_banner({drive.camera.width, drive.camera.height}, seed);
  const std::int64_t time = drive.frames[frame].time_ns;
  const SE3 camera_from_world = drive.camera_from_lidar * drive.poses.at(time)->inverse();
  return paint_box(transform(camera_from_world, vehicle_->box_at(time)), drive.camera, seed);
}

HoldoutFrame Holdout::make_frame(const Drive& drive, const Pictures& pictures, std::size_t i) const {
  const Painting painting = paint(drive, i);
  const auto traffic = pictures.traffic[pictures.frames[i]];
  HoldoutFrame out;
  out.held_out = grown(painting.pixels, options_.margin_px);
  out.mask = add_errors(out.held_out, pictures.errors, i) | *traffic;
  out.ignore = grown(*traffic, options_.ignore_margin_px);
  out.image = pictures.images[pictures.frames[i]]->clone();
  // The margin is painted, too, because no scored pixel may show its truth.
  out.image.setTo(get_outline_color(derive_seed(options_.seed, kPaintSeed)), out.held_out);
  painting.colors.copyTo(out.image, painting.pixels);
  return out;
}

Scan Holdout::scan(std::size_t i) const {
  Scan scan = *scans_[scan_indices_[i]];
  if (!vehicle_) return scan;
  const ScanHeader& header = drive_.scan_headers[i];
  const Box lidar_box = transform(drive_.poses.at(header.time_ns)->inverse(), vehicle_->box_at(header.time_ns));
  const auto [first, last] = std::minmax_element(scan.time.begin(), scan.time.end());
  if (first == scan.time.end()) return scan;
  const OcclusionCone cone(lidar_box, std::max(std::abs(*first), std::abs(*last)));
  for (std::size_t k = 0; k < scan.size(); ++k) {
    Eigen::Vector3f& p = scan.points[k];
    if (!cone.contains(p)) continue;
    const std::int64_t time = header.time_ns + std::llround(1e9 * static_cast<double>(scan.time[k]));
    const std::optional<SE3> pose = drive_.poses.at(time);
    if (!pose) continue;
    const auto hit = find_hit(vehicle_->box_at(time), pose->t, pose->R * p.cast<double>());
    if (!hit || hit->distance >= 1) continue;
    Random random(derive_seed(options_.seed, i + 1, k));
    const double noise = random.uniform(-kRangeNoiseM, kRangeNoiseM);
    p *= static_cast<float>(hit->distance + noise / static_cast<double>(p.norm()));
    scan.intensity[k] = kIntensity + static_cast<float>(random.uniform(-0.1, 0.1));
  }
  return scan;
}

}  // namespace dvi::holdout
