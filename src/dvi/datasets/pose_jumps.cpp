#include "dvi/datasets/pose_jumps.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "dvi/core/text.h"
#include "dvi/drive/nearest_in_time.h"

namespace dvi::datasets {
namespace {

// The limits of plausible steps between poses.
struct PoseJumpParams {
  double max_speed_mps = 100;    // faster than any car or hand
  double max_speed_ratio = 10;   // to the usual speed, in case that times are not in seconds
  double max_noise_m = 5;        // noise of GPS from one pose to the next
  double max_correction_m = 50;  // correction by a GPS; a longer jump has another cause
  double min_group_share = 0.2;  // fraction of the largest group; a smaller group is an outlier
};
constexpr PoseJumpParams kJumpParams;

struct Group {
  std::size_t last = 0;  // pose
  std::size_t poses = 0;
};

double compute_distance_m(const StampedPose& a, const StampedPose& b) {
  return (a.world_from_body.t - b.world_from_body.t).norm();
}

double compute_step_s(const StampedPose& a, const StampedPose& b) {
  return std::abs(1e-9 * static_cast<double>(b.time_ns - a.time_ns));
}

double find_max_speed_mps(const std::vector<StampedPose>& poses) {
  std::vector<double> speeds;
  for (std::size_t i = 1; i < poses.size(); ++i)
    if (const double seconds = compute_step_s(poses[i - 1], poses[i]); seconds > 0)
      speeds.push_back(compute_distance_m(poses[i - 1], poses[i]) / seconds);
  if (speeds.empty()) return kJumpParams.max_speed_mps;
  const auto usual =
      speeds.begin() + static_cast<std::ptrdiff_t>((speeds.size() - 1) / 4);  // robust, since an outlier makes two steps fast
  std::nth_element(speeds.begin(), usual, speeds.end());
  return std::max(kJumpParams.max_speed_mps, kJumpParams.max_speed_ratio * *usual);
}

PoseJump make_jump(const std::vector<StampedPose>& poses, std::size_t before, std::size_t after) {
  return {before, after, compute_distance_m(poses[before], poses[after]), compute_step_s(poses[before], poses[after])};
}

/// Returns the group index of each pose, and the groups.
std::pair<std::vector<std::size_t>, std::vector<Group>> group_poses(const std::vector<StampedPose>& poses) {
  std::vector<std::size_t> of_pose;
  std::vector<Group> groups;
  const double max_mps = find_max_speed_mps(poses);
  const auto is_jump = [&](const StampedPose& a, const StampedPose& b) {
    return compute_distance_m(a, b) > max_mps * compute_step_s(a, b) + kJumpParams.max_noise_m;
  };
  for (std::size_t i = 0; i < poses.size(); ++i) {
    std::size_t found = i > 0 && !is_jump(poses[i - 1], poses[i]) ? of_pose.back() : groups.size();
    for (std::size_t k = 0; k < groups.size() && found == groups.size(); ++k)
      if (!is_jump(poses[groups[k].last], poses[i])) found = k;
    if (found == groups.size()) groups.emplace_back();
    groups[found].last = i;
    ++groups[found].poses;
    of_pose.push_back(found);
  }
  return {of_pose, groups};
}

std::string describe_nearest_frame(const Drive& drive, std::int64_t time_ns) {
  const auto frame = nearest_in_time(drive.frames.begin(), drive.frames.end(), time_ns);
  return frame == drive.frames.end() ? "" : fmt::format(", near frame {}", frame->number);
}

std::string describe_jump(const Drive& drive, const std::vector<StampedPose>& poses, const PoseJump& jump) {
  return fmt::format("{:.0f} m within {:.2f} s, from {} s to {} s{}", jump.distance_m, jump.seconds,
                     to_seconds(poses[jump.before].time_ns), to_seconds(poses[jump.after].time_ns),
                     describe_nearest_frame(drive, poses[jump.after].time_ns));
}

}  // namespace

PoseJumps find_pose_jumps(const std::vector<StampedPose>& poses) {
  PoseJumps out;
  out.outlier.resize(poses.size());
  const auto [of_pose, groups] = group_poses(poses);
  if (groups.size() < 2) return out;
  const auto largest =
      std::max_element(groups.begin(), groups.end(), [](const Group& a, const Group& b) { return a.poses < b.poses; });
  const auto main = static_cast<std::size_t>(largest - groups.begin());
  std::vector<bool> is_far(groups.size());
  for (std::size_t k = 0; k < groups.size(); ++k)
    is_far[k] =
        k != main && static_cast<double>(groups[k].poses) < kJumpParams.min_group_share * static_cast<double>(largest->poses);
  for (std::size_t i = 1; i < poses.size(); ++i)
    if (of_pose[i] != of_pose[i - 1] && compute_distance_m(poses[i - 1], poses[i]) > kJumpParams.max_correction_m)
      for (const std::size_t k : {of_pose[i - 1], of_pose[i]})
        if (k != main) is_far[k] = true;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    out.outlier[i] = is_far[of_pose[i]];
    out.outliers += out.outlier[i] ? 1 : 0;
    if (i == 0 || of_pose[i] == of_pose[i - 1]) continue;
    std::optional<PoseJump>& jump = out.outlier[i] || out.outlier[i - 1] ? out.first : out.kept;
    if (!jump) jump = make_jump(poses, i - 1, i);
  }
  return out;
}

void leave_out_pose_jumps(Drive& drive) {
  const std::vector<StampedPose>& all = drive.poses.poses();
  const PoseJumps jumps = find_pose_jumps(all);
  if (jumps.kept)
    drive.warnings.push_back("the given poses jump by " + describe_jump(drive, all, *jumps.kept) +
                             ": check them there, or use --poses loam, which ignores them");
  if (jumps.outliers == 0) return;
  drive.warnings.push_back(fmt::format("{} of {} given poses are outliers and are ignored: they jump by {}", jumps.outliers,
                                       all.size(), describe_jump(drive, all, *jumps.first)));
  std::vector<StampedPose> poses;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (!jumps.outlier[i]) poses.push_back(all[i]);
  Trajectory kept(std::move(poses));
  kept.max_extrapolation = drive.poses.max_extrapolation;
  kept.max_gap = drive.poses.max_gap;
  drive.poses = std::move(kept);
}

}  // namespace dvi::datasets
