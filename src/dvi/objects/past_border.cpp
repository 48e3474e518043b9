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

constexpr double kFitted = 0.5;   // seconds: of which motion is read
constexpr double kContinued = 1;  // second

using Frames = std::vector<std::pair<std::size_t, const Label*>>;  // the labels of a track, from its end inwards

struct PlacedBox {
  double seconds;  // from the end of the track
  Box box;         // in the world, or in LiDAR axes if there are no poses
};

class Continuation {
 public:
  Continuation(const Drive& drive, const Trajectory& world_from_lidar, const MaskOptions& options)
      : drive_(drive), world_from_lidar_(world_from_lidar), options_(options) {}

  // What frames beyond the end show of a track, outwards.
  std::vector<std::pair<std::size_t, Label>> of(const Frames& track, int step) const {
    std::vector<std::pair<std::size_t, Label>> out;
    const auto [end, last] = track.front();
    if (!touches_border(*last)) return out;
    const std::vector<PlacedBox> sights = sights_of(track);
    if (sights.empty() || (sights.size() == 1 && world_from_lidar_.empty())) return out;
    for (auto i = static_cast<std::ptrdiff_t>(end) + step; i >= 0 && i < std::ssize(drive_.frames); i += step) {
      const auto frame = static_cast<std::size_t>(i);
      const double seconds = seconds_between(end, frame);
      const std::optional<SE3> pose = pose_of(frame);
      if (std::abs(seconds) > kContinued || !pose) break;
      Label label;
      label.track = last->track;
      label.type = last->type;
      label.box = moved_on(sights, seconds);
      label.box->frame_from_box = pose->inverse() * label.box->frame_from_box;
      if (cv::countNonZero(draw_label(label, drive_.camera, drive_.camera_from_lidar, {.box_margin_m = 0})) == 0) break;
      out.emplace_back(frame, std::move(label));
    }
    return out;
  }

 private:
  double seconds_between(std::size_t from, std::size_t to) const {
    return 1e-9 * static_cast<double>(drive_.frames[to].time_ns - drive_.frames[from].time_ns);
  }

  std::optional<SE3> pose_of(std::size_t frame) const {
    return world_from_lidar_.empty() ? SE3() : world_from_lidar_.at(drive_.frames[frame].time_ns);
  }

  bool touches_border(const Label& label) const {
    const cv::Mat1b mask =
        grown(draw_label(label, drive_.camera, drive_.camera_from_lidar, options_), options_.label_dilation_px());
    return cv::countNonZero(mask.col(0)) + cv::countNonZero(mask.col(mask.cols - 1)) + cv::countNonZero(mask.row(0)) +
               cv::countNonZero(mask.row(mask.rows - 1)) >
           0;
  }

  std::vector<PlacedBox> sights_of(const Frames& track) const {
    std::vector<PlacedBox> out;
    for (const auto& [frame, label] : track) {
      const double seconds = seconds_between(track.front().first, frame);
      if (std::abs(seconds) > kFitted) break;
      const std::optional<SE3> pose = pose_of(frame);
      if (!label->box || !pose) continue;
      out.push_back({seconds, {*pose * label->box->frame_from_box, label->box->size}});
    }
    return out;
  }

  // The box nearest to the end, on the line fitted to the places of all.
  static Box moved_on(const std::vector<PlacedBox>& sights, double seconds) {
    const auto count = static_cast<double>(sights.size());
    double time = 0, spread = 0;
    Eigen::Vector3d place = Eigen::Vector3d::Zero(), moment = Eigen::Vector3d::Zero();
    for (const PlacedBox& sight : sights) {
      time += sight.seconds / count;
      place += sight.box.frame_from_box.t / count;
    }
    for (const PlacedBox& sight : sights) {
      spread += (sight.seconds - time) * (sight.seconds - time);
      moment += (sight.seconds - time) * (sight.box.frame_from_box.t - place);
    }
    Box box = sights.front().box;
    box.frame_from_box.t = place;
    if (spread > 0) box.frame_from_box.t += (seconds - time) / spread * moment;
    return box;
  }

  const Drive& drive_;
  const Trajectory& world_from_lidar_;
  const MaskOptions& options_;
};

}  // namespace

FrameLabels continued_past_border(const Drive& drive, FrameLabels labels, const Trajectory& world_from_lidar,
                                  const MaskOptions& options) {
  std::map<int, Frames> tracks;
  for (std::size_t i = 0; i < labels.size(); ++i)
    for (const Label& label : labels[i])
      if (label.track >= 0) tracks[label.track].emplace_back(i, &label);
  const Continuation continuation(drive, world_from_lidar, options);
  std::vector<std::pair<std::size_t, Label>> added;
  for (const auto& [_, track] : tracks) {
    for (std::pair<std::size_t, Label>& label : continuation.of(track, -1)) added.push_back(std::move(label));
    for (std::pair<std::size_t, Label>& label : continuation.of(Frames(track.rbegin(), track.rend()), 1))
      added.push_back(std::move(label));
  }
  for (auto& [frame, label] : added) labels[frame].push_back(std::move(label));
  return labels;
}

}  // namespace dvi::objects
