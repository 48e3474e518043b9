#include "dvi/objects/past_border.h"

#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "dvi/image/region.h"

namespace dvi::objects {
namespace {

struct BorderParams {
  double fit_s = 0.5;          ///< time at the end of a track from which its motion is estimated
  double max_extension_s = 1;  ///< time for which a track is extended
};
constexpr BorderParams kBorder{};

// The labels of a track and their frames, from one end of the track inward.
using TrackLabels = std::vector<std::pair<std::size_t, const Label*>>;

struct TimedBox {
  double time_s;  // from the end of the track
  Box box;        // world axes, or LiDAR axes without poses
};

// Extends tracks beyond the image border.
class BorderExtension {
 public:
  BorderExtension(const Drive& drive, const Trajectory& world_from_lidar, const MaskOptions& options)
      : drive_(drive), world_from_lidar_(world_from_lidar), options_(options) {}

  // Returns the labels of a track beyond its end, with their frames. `step` is the direction in time, 1 or -1.
  std::vector<std::pair<std::size_t, Label>> extend(const TrackLabels& track, int step) const {
    std::vector<std::pair<std::size_t, Label>> out;
    const auto [end, last] = track.front();
    if (!touches_border(*last)) return out;
    const std::vector<TimedBox> boxes = collect_boxes(track);
    if (boxes.empty() || (boxes.size() == 1 && world_from_lidar_.empty())) return out;
    for (auto i = static_cast<std::ptrdiff_t>(end) + step; i >= 0 && i < std::ssize(drive_.frames); i += step) {
      const auto frame = static_cast<std::size_t>(i);
      const double time_s = seconds_between_frames(end, frame);
      const std::optional<SE3> pose = find_pose(frame);
      if (std::abs(time_s) > kBorder.max_extension_s || !pose) break;
      Label label;
      label.track = last->track;
      label.type = last->type;
      label.box = extrapolate(boxes, time_s);
      label.box->frame_from_box = pose->inverse() * label.box->frame_from_box;
      if (cv::countNonZero(draw_label(label, drive_.camera, drive_.camera_from_lidar, {.box_margin_m = 0})) == 0) break;
      out.emplace_back(frame, std::move(label));
    }
    return out;
  }

 private:
  double seconds_between_frames(std::size_t from, std::size_t to) const {
    return 1e-9 * static_cast<double>(drive_.frames[to].time_ns - drive_.frames[from].time_ns);
  }

  std::optional<SE3> find_pose(std::size_t frame) const {
    return world_from_lidar_.empty() ? SE3() : world_from_lidar_.at(drive_.frames[frame].time_ns);
  }

  bool touches_border(const Label& label) const {
    const cv::Mat1b mask =
        grown(draw_label(label, drive_.camera, drive_.camera_from_lidar, options_), options_.label_dilation_px());
    return cv::countNonZero(mask.col(0)) + cv::countNonZero(mask.col(mask.cols - 1)) + cv::countNonZero(mask.row(0)) +
               cv::countNonZero(mask.row(mask.rows - 1)) >
           0;
  }

  std::vector<TimedBox> collect_boxes(const TrackLabels& track) const {
    std::vector<TimedBox> out;
    for (const auto& [frame, label] : track) {
      const double time_s = seconds_between_frames(track.front().first, frame);
      if (std::abs(time_s) > kBorder.fit_s) break;
      const std::optional<SE3> pose = find_pose(frame);
      if (!label->box || !pose) continue;
      out.push_back({time_s, {*pose * label->box->frame_from_box, label->box->size}});
    }
    return out;
  }

  // Returns the first box, moved along the line that is fitted to the positions of all boxes.
  static Box extrapolate(const std::vector<TimedBox>& boxes, double time_s) {
    const auto count = static_cast<double>(boxes.size());
    double mean_time_s = 0, spread = 0;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero(), moment = Eigen::Vector3d::Zero();
    for (const TimedBox& box : boxes) {
      mean_time_s += box.time_s / count;
      mean += box.box.frame_from_box.t / count;
    }
    for (const TimedBox& box : boxes) {
      spread += (box.time_s - mean_time_s) * (box.time_s - mean_time_s);
      moment += (box.time_s - mean_time_s) * (box.box.frame_from_box.t - mean);
    }
    Box out = boxes.front().box;
    out.frame_from_box.t = mean;
    if (spread > 0) out.frame_from_box.t += (time_s - mean_time_s) / spread * moment;
    return out;
  }

  const Drive& drive_;
  const Trajectory& world_from_lidar_;
  const MaskOptions& options_;
};

}  // namespace

FrameLabels extend_past_border(const Drive& drive, FrameLabels labels, const Trajectory& world_from_lidar,
                               const MaskOptions& options) {
  std::map<int, TrackLabels> tracks;
  for (std::size_t i = 0; i < labels.size(); ++i)
    for (const Label& label : labels[i])
      if (label.track >= 0) tracks[label.track].emplace_back(i, &label);
  const BorderExtension extension(drive, world_from_lidar, options);
  std::vector<std::pair<std::size_t, Label>> added;
  for (const auto& [_, track] : tracks) {
    for (std::pair<std::size_t, Label>& label : extension.extend(track, -1)) added.push_back(std::move(label));
    for (std::pair<std::size_t, Label>& label : extension.extend(TrackLabels(track.rbegin(), track.rend()), 1))
      added.push_back(std::move(label));
  }
  for (auto& [frame, label] : added) labels[frame].push_back(std::move(label));
  return labels;
}

}  // namespace dvi::objects
