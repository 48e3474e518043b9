#include "dvi/objects/completion/complete.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/core/threads.h"
#include "dvi/drive/outline.h"
#include "dvi/image/region.h"
#include "dvi/objects/seconds.h"

namespace dvi::objects {
namespace {

struct CompletionParams {
  double min_masked_share = 0.5;               ///< masked share of a track's visible returns in a scan in which masks show it
  std::size_t min_masked_scans = 2;            ///< scans in which masks show a track
  double min_track_share = 0.2;                ///< the same, as a share of the scans in which the track is visible
  double max_covered_share = 0.5;              ///< of a track's outline, from which the mask shows the object in this frame
  double static_s = 1;                         ///< time over which scans observe a voxel of a stationary object
  std::int64_t max_scan_gap_ns = 100'000'000;  ///< time to the scan that shows a frame's objects
  double max_track_gap_s = 0.25;               ///< time to the observation of a track that shows its shape
  double judged_radius_m = 0.1;                ///< radius around the center of a voxel that a scan must pass
  double column_margin_m = 0.125;              ///< around the voxels, which closes gaps of one voxel
  int closing_px = 2;                          ///< gaps that remain
  int margin_px = 2;                           ///< blur of an object's edge in the image
  double border_m = 0.35;                      ///< deviation of an object's drawn outline from its true one
  int min_border_px = 3;                       ///< deviation of masks from the true outline
};
constexpr CompletionParams kCompletion;

// Counts the scans in which masks show a track.
class TrackEvidence {
 public:
  void add(const Cluster& observation, const std::vector<MaskedSurfaces>& images) {
    std::size_t visible = 0, masked = 0;
    for (const MaskedSurfaces& image : images)
      for (const Eigen::Vector3d& point : observation.points) {
        const std::optional<bool> is_masked = image.shows_masked(point);
        visible += is_masked.has_value();
        masked += is_masked.value_or(false);
      }
    if (visible == 0) return;
    ++visible_scans_;
    masked_scans_ += static_cast<double>(masked) >= kCompletion.min_masked_share * static_cast<double>(visible);
  }

  bool is_removed() const {
    return masked_scans_ >= kCompletion.min_masked_scans &&
           static_cast<double>(masked_scans_) >= kCompletion.min_track_share * static_cast<double>(visible_scans_);
  }

 private:
  std::size_t visible_scans_ = 0, masked_scans_ = 0;
};

// Returns the tracks that masks show.
std::vector<Track> find_removed_tracks(const CompletionInput& input) {
  std::vector<std::vector<std::pair<std::size_t, const Cluster*>>> observations(input.returns.scans());
  for (std::size_t k = 0; k < input.tracks.size(); ++k)
    for (const Cluster& observation : input.tracks[k].observations)
      observations[observation.scan].emplace_back(k, &observation);
  std::vector<TrackEvidence> evidence(input.tracks.size());
  for (std::size_t scan = 0; scan < observations.size(); ++scan) {
    if (observations[scan].empty()) continue;
    const std::int64_t time_ns = observations[scan].front().second->mean_time_ns;
    std::vector<MaskedSurfaces> images;
    for (const CameraMaskEvidence& camera : input.cameras)
      if (const auto frame = find_masked_frame(camera, time_ns))
        images.emplace_back(*frame, input.returns.obstacles(scan)->points);
    for (const auto& [track, observation] : observations[scan]) evidence[track].add(*observation, images);
  }
  std::vector<Track> removed;
  for (std::size_t k = 0; k < input.tracks.size(); ++k)
    if (evidence[k].is_removed()) removed.push_back(input.tracks[k]);
  return removed;
}

// The part of space that an object fills in one frame, as columns on the ground.
class Columns {
 public:
  void add(const Eigen::Vector3d& point, double half_height_m) {
    const std::pair<int, int> column(static_cast<int>(std::floor(point.x() / kObjectVoxelM)),
                                     static_cast<int>(std::floor(point.y() / kObjectVoxelM)));
    double& top_m = tops_m_.try_emplace(column, -std::numeric_limits<double>::max()).first->second;
    top_m = std::max(top_m, point.z() + half_height_m);
  }

  // Draws the columns, each from the ground to its top, and closes the gaps between them.
  cv::Mat1b draw(const ground::ScanGround& ground, const Camera& camera, const SE3& camera_from_world) const {
    cv::Mat1b mask(camera.height, camera.width, uchar{0});
    const double low_m = -kCompletion.column_margin_m, high_m = kObjectVoxelM + kCompletion.column_margin_m;
    for (const auto& [column, top_m] : tops_m_) {
      const Eigen::Vector2d at = Eigen::Vector2d(column.first, column.second) * kObjectVoxelM;
      const double ground_m = ground.height(at).value_or(top_m - kObjectVoxelM);
      std::vector<Eigen::Vector3d> corners;
      for (const double dx : {low_m, high_m})
        for (const double dy : {low_m, high_m})
          for (const double z : {ground_m, top_m})
            corners.push_back(camera_from_world * Eigen::Vector3d(at.x() + dx, at.y() + dy, z));
      if (std::all_of(corners.begin(), corners.end(), [&](const Eigen::Vector3d& x) { return camera.in_front(x); }))
        draw_hull(corners, camera, mask);
    }
    return grown(grown(mask, kCompletion.closing_px), kCompletion.margin_px - kCompletion.closing_px);
  }

  // Returns the depth of the nearest column in a camera, in meters.
  double nearest_m(const SE3& camera_from_world) const {
    double nearest_m = std::numeric_limits<double>::max();
    for (const auto& [column, top_m] : tops_m_) {
      const Eigen::Vector3d top(column.first * kObjectVoxelM, column.second * kObjectVoxelM, top_m);
      nearest_m = std::min(nearest_m, (camera_from_world * top).z());
    }
    return nearest_m;
  }

 private:
  std::map<std::pair<int, int>, double> tops_m_;
};

// Returns the space that a track fills: the returns of the nearest scan, moved along the track. Nothing if the scan is too far
// in time.
Columns fill_columns(const Track& track, std::int64_t time_ns) {
  Columns out;
  if (track.observations.empty()) return out;
  const std::size_t nearest = track.nearest(time_ns);
  const Cluster& cluster = track.observations[nearest];
  if (std::abs(seconds_between(cluster.mean_time_ns, time_ns)) > kCompletion.max_track_gap_s) return out;
  const Eigen::Vector2d velocity = track.velocity(nearest);
  for (std::size_t k = 0; k < cluster.points.size(); ++k) {
    Eigen::Vector3d point = cluster.points[k];
    point.head<2>() += velocity * seconds_between(cluster.time_ns[k], time_ns);
    out.add(point, 0.5 * std::min(cluster.ray_spacing_m[k], kObjectVoxelM));
  }
  return out;
}

int to_pixels(double meters, double depth_m, const Camera& camera) {
  return cvRound(meters * camera.fx / std::max(depth_m, 1.0));
}

// Returns the part of an object that a mask lacks, without the deviations at the border of the mask.
cv::Mat1b find_uncovered(const cv::Mat1b& object, const cv::Mat1b& mask, int border_px) {
  cv::Mat1b out(object.size(), uchar{0});
  cv::Rect box = cv::boundingRect(object);
  if (box.empty()) return out;
  box = cv::Rect(box.x - border_px, box.y - border_px, box.width + 2 * border_px, box.height + 2 * border_px) &
        cv::Rect({}, object.size());
  const cv::Mat1b drawn = object(box), masked = mask(box), lacking(drawn & ~masked);
  const cv::Mat1b core = grown_far(lacking, -border_px);
  // A small object that the mask lacks completely has no core.
  if (cv::countNonZero(core) > 0)
    cv::Mat1b(grown_far(core, 2 * border_px) & lacking).copyTo(out(box));
  else if (cv::countNonZero(drawn & grown_far(masked, border_px)) == 0)
    lacking.copyTo(out(box));
  return out;
}

}  // namespace

CompletedObjects::CompletedObjects(const CompletionInput& input, const std::vector<std::int64_t>& scan_times_ns,
                                   const Tick& tick)
    : returns_(input.returns),
      ground_(input.ground),
      scan_times_ns_(scan_times_ns),
      options_(input.options),
      space_(find_object_space(input.cameras, input.returns, scan_times_ns, tick)),
      tracks_(find_removed_tracks(input)) {
  if (input.cameras.empty()) return;
  const CameraMaskEvidence& own = input.cameras.front();
  labeled_ = LabeledBoxes::collect(own.camera.drive, *own.labels, own.camera.world_from_lidar);
}

std::vector<Label> CompletedObjects::draw_frame(const CameraEvidence& camera, std::size_t frame, const cv::Mat1b& mask) const {
  const Drive& drive = camera.drive;
  const std::int64_t time_ns = drive.frames[frame].time_ns;
  const std::optional<SE3> pose = camera.world_from_lidar.at(time_ns);
  if (!pose) return {};
  const SE3 camera_from_world = drive.camera_from_lidar * pose->inverse();

  std::shared_ptr<const FreeSpace> space;
  std::size_t scan_index = returns_.scans();
  const auto scan = std::min_element(scan_times_ns_.begin(), scan_times_ns_.end(), [&](std::int64_t a, std::int64_t b) {
    return std::abs(a - time_ns) < std::abs(b - time_ns);
  });
  if (scan != scan_times_ns_.end() && std::abs(*scan - time_ns) <= kCompletion.max_scan_gap_ns) {
    scan_index = static_cast<std::size_t>(scan - scan_times_ns_.begin());
    space = returns_.free_space(scan_index);
  }

  std::map<int, Columns> objects;
  for (const OccupiedVoxel& voxel : space_) {
    if (time_ns <= voxel.first_ns || time_ns >= voxel.last_ns) continue;
    const Eigen::Vector3d center = voxel.center(), in_camera = camera_from_world * center;
    if (!drive.camera.in_front(in_camera)) continue;
    const bool has_return = std::binary_search(voxel.returns.begin(), voxel.returns.end(), scan_index);
    const bool is_static = seconds_between(voxel.first_return_ns, voxel.last_return_ns) >= kCompletion.static_s;
    const bool is_between = time_ns >= voxel.first_return_ns && time_ns <= voxel.last_return_ns;
    if (!has_return) {
      if (!is_static && !is_between) continue;
      const FreeSpace::Seen seen =
          space && space->valid() ? space->judge(center, kCompletion.judged_radius_m) : FreeSpace::Seen::unknown;
      if (seen == FreeSpace::Seen::passed || seen == FreeSpace::Seen::hidden) continue;
    }
    objects[voxel.object].add(center, 0.5 * kObjectVoxelM);
  }

  std::vector<Label> labels;
  const auto add = [&](const cv::Mat1b& drawn, double depth_m, int track, const std::string& type, double max_covered_share) {
    if (cv::countNonZero(drawn & mask) > max_covered_share * cv::countNonZero(drawn)) return;
    const int border_px = std::max(kCompletion.min_border_px, to_pixels(kCompletion.border_m, depth_m, drive.camera));
    const cv::Mat1b uncovered = find_uncovered(drawn, mask, border_px);
    if (cv::countNonZero(uncovered) == 0) return;
    Label label;
    label.track = track;
    label.type = type;
    label.instance = to_outline(uncovered);
    labels.push_back(std::move(label));
  };
  const auto add_columns = [&](const Columns& columns, int track, double max_covered_share) {
    add(columns.draw(ground_, drive.camera, camera_from_world), columns.nearest_m(camera_from_world), track, "",
        max_covered_share);
  };
  for (const auto& [number, columns] : objects) add_columns(columns, number, 1);
  for (std::size_t k = 0; k < tracks_.size(); ++k)
    add_columns(fill_columns(tracks_[k], time_ns), static_cast<int>(k), kCompletion.max_covered_share);
  for (const LabeledBoxes& object : labeled_) {
    const std::optional<Box> box = object.at(time_ns);
    if (!box || (space && is_absent_or_hidden(*box, *space))) continue;
    Label label;
    label.box = Box{pose->inverse() * box->frame_from_box, box->size};
    const cv::Mat1b drawn =
        grown(draw_label(label, drive.camera, drive.camera_from_lidar, options_), options_.label_dilation_px());
    add(drawn, (camera_from_world * box->frame_from_box.t).z(), object.track(), object.type(), 1);
  }
  return labels;
}

FrameLabels CompletedObjects::draw(const CameraEvidence& camera, const Lazy<cv::Mat1b>& masks) const {
  FrameLabels out(camera.drive.frames.size());
  parallel_in_order(out.size(), [&](std::size_t i) { out[i] = draw_frame(camera, i, *masks[i]); });
  return out;
}

}  // namespace dvi::objects
