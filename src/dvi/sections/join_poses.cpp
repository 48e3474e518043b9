#include "dvi/sections/join_poses.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <Eigen/SVD>

#include "dvi/core/error.h"
#include "dvi/geometry/angles.h"

namespace dvi::sections {
namespace {

using inputs::DrivePoses, inputs::Poses, inputs::PoseChoice, inputs::Recordings;

/// The largest RMS differences between the poses of two sections in their overlap without a warning.
constexpr double kMaxDisagreementM = 0.5, kMaxDisagreementDeg = 0.5;

/// Parameters of the search for places that several sections show.
struct ReturnParams {
  double step_m = 10;    ///< between compared positions
  double radius_m = 15;  ///< nearer positions are the same place
};
constexpr ReturnParams kReturn;

/// A pose of the same scan in two sections.
struct PosePair {
  SE3 before, after;
};

std::vector<PosePair> find_common_poses(const PlannedSection& before, const PlannedSection& after) {
  std::vector<PosePair> pairs;
  const std::int64_t first = after.target().frames.front().time_ns, last = before.target().frames.back().time_ns;
  for (const StampedPose& pose : after.world_from_lidar().poses()) {
    if (pose.time_ns < first || pose.time_ns > last) continue;
    if (const std::optional<SE3> same = before.world_from_lidar().at(pose.time_ns))
      pairs.push_back({*same, pose.world_from_body});
  }
  return pairs;
}

/// Returns the motion from the world of `after` to that of `before` that fits their poses best: the mean rotation, and the
/// translation of the mean position.
SE3 align_worlds(const std::vector<PosePair>& pairs) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  Eigen::Vector3d mean_before = Eigen::Vector3d::Zero(), mean_after = Eigen::Vector3d::Zero();
  for (const PosePair& pair : pairs) {
    sum += pair.before.R * pair.after.R.transpose();
    mean_before += pair.before.t / static_cast<double>(pairs.size());
    mean_after += pair.after.t / static_cast<double>(pairs.size());
  }
  const Eigen::Matrix3d rotation = nearest_rotation(sum / static_cast<double>(pairs.size()));
  return {rotation, mean_before - rotation * mean_after};
}

void warn_of_disagreement(const std::vector<PosePair>& pairs, const SE3& before_from_after, const PlannedSection& before,
                          Progress& progress) {
  double square_m = 0, square_rad = 0;
  for (const PosePair& pair : pairs) {
    const SE3 off = pair.before.inverse() * (before_from_after * pair.after);
    square_m += off.t.squaredNorm() / static_cast<double>(pairs.size());
    square_rad += so3_log(off.R).squaredNorm() / static_cast<double>(pairs.size());
  }
  const double meters = std::sqrt(square_m), degrees = to_degrees(std::sqrt(square_rad));
  if (meters <= kMaxDisagreementM && degrees <= kMaxDisagreementDeg) return;
  progress.warn(
      fmt::format("sections {} and {} disagree about their overlap by {:.2f} m and {:.2f} degrees: poses there are uncertain "
                  "(a standstill, a tunnel, or wrong given poses); the map shows it as doubled surfaces, the frames do not",
                  before.section.number, before.section.number + 1, meters, degrees));
}

/// Returns the motion from the world of each section to that of the first.
std::vector<SE3> chain_worlds(const std::vector<PlannedSection>& sections, Progress& progress) {
  std::vector<SE3> first_from_section{SE3()};
  for (std::size_t k = 0; k + 1 < sections.size(); ++k) {
    const std::vector<PosePair> pairs = find_common_poses(sections[k], sections[k + 1]);
    if (pairs.empty())
      throw InputError(sections[k].target().path,
                       fmt::format("sections {} and {} have no common pose, so their relative position is unknown",
                                   sections[k].section.number, sections[k + 1].section.number),
                       "plan with another number of sections, or give poses (--poses FILE)");
    const SE3 before_from_after = align_worlds(pairs);
    warn_of_disagreement(pairs, before_from_after, sections[k], progress);
    first_from_section.push_back(first_from_section.back() * before_from_after);
  }
  return first_from_section;
}

/// The sections' poses of one recording.
class Blend {
 public:
  Blend(const std::vector<PlannedSection>& sections, const std::vector<Border>& borders, const std::vector<SE3>& worlds,
        const inputs::Recording& recording)
      : sections_(sections), borders_(borders), first_from_section_(worlds) {
    for (const PlannedSection& section : sections_) locals_.push_back(find_recording(section.drives, recording));
  }

  std::optional<std::size_t> local(std::size_t section) const { return locals_[section]; }

  /// Returns a pose of a section in the world of the first; none if the section has none.
  std::optional<SE3> pose(std::size_t section, std::int64_t time_ns) const {
    if (!locals_[section]) return std::nullopt;
    const std::optional<SE3> pose = sections_[section].poses[*locals_[section]].world_from_lidar.at(time_ns);
    if (!pose) return std::nullopt;
    return first_from_section_[section] * *pose;
  }

  /// Returns the joint pose at a time of the target's drive, which changes gradually near a border.
  std::optional<SE3> at(std::int64_t time_ns) const {
    const std::size_t own = section_at(borders_, time_ns);
    for (std::size_t b = own > 0 ? own - 1 : own; b < std::min(own + 1, borders_.size()); ++b) {
      const Border& border = borders_[b];
      if (std::abs(time_ns - border.time_ns) >= border.reach_ns) continue;
      const std::optional<SE3> before = pose(b, time_ns), after = pose(b + 1, time_ns);
      if (!before || !after) return before ? before : after;
      const double offset = static_cast<double>(time_ns - border.time_ns) / static_cast<double>(border.reach_ns);
      return interpolate(*before, *after, (offset + 1) / 2);
    }
    return pose(own, time_ns);
  }

  /// Returns the joint trajectory, at the times at which its sections have poses.
  Trajectory join(bool is_target) const {
    std::vector<StampedPose> joint;
    Trajectory limits;
    for (std::size_t k = 0; k < sections_.size(); ++k) {
      if (!locals_[k]) continue;
      const Trajectory& trajectory = sections_[k].poses[*locals_[k]].world_from_lidar;
      limits = trajectory;
      for (const StampedPose& given : trajectory.poses()) {
        if (is_target && section_at(borders_, given.time_ns) != k) continue;
        // Times of a source drive are not comparable with those of the target: its first section with a pose counts.
        const std::optional<SE3> pose = is_target ? at(given.time_ns) : this->pose(k, given.time_ns);
        if (pose) joint.push_back({given.time_ns, *pose});
      }
    }
    Trajectory out(std::move(joint));
    out.max_extrapolation = limits.max_extrapolation;
    out.max_gap = limits.max_gap;
    return out;
  }

 private:
  const std::vector<PlannedSection>& sections_;
  const std::vector<Border>& borders_;
  const std::vector<SE3>& first_from_section_;
  std::vector<std::optional<std::size_t>> locals_;  // index of the recording in each section
};

/// The counts of a mean sharpness.
void add_sharpness(const std::optional<odometry::Sharpness>& more, std::optional<odometry::Sharpness>& sum) {
  if (!more) return;
  if (!sum) {
    sum = more;
    return;
  }
  const auto mean = [](double a, std::size_t of_a, double b, std::size_t of_b) {
    const auto count = static_cast<double>(of_a + of_b);
    return count > 0 ? (a * static_cast<double>(of_a) + b * static_cast<double>(of_b)) / count : 0;
  };
  sum->ground_m = mean(sum->ground_m, sum->ground_patches, more->ground_m, more->ground_patches);
  sum->vertical_m = mean(sum->vertical_m, sum->vertical_patches, more->vertical_m, more->vertical_patches);
  sum->ground_patches += more->ground_patches;
  sum->vertical_patches += more->vertical_patches;
}

/// Takes the fits of a section's own scans, which are those nearest to it in time.
void add_scan_fits(const Drive& whole, const Drive& part, const odometry::Odometry& from, odometry::Odometry& to) {
  for (std::size_t i = 0; i < part.scan_headers.size() && i < from.scans.size(); ++i) {
    const auto same = std::partition_point(whole.scan_headers.begin(), whole.scan_headers.end(), [&](const ScanHeader& header) {
      return header.time_ns < part.scan_headers[i].time_ns;
    });
    if (same == whole.scan_headers.end() || same->time_ns != part.scan_headers[i].time_ns) continue;
    odometry::ScanFit& fit = to.scans[static_cast<std::size_t>(same - whole.scan_headers.begin())];
    if (fit.features == 0 || from.scans[i].inliers > fit.inliers) fit = from.scans[i];
  }
}

/// Joins the choices of the sections: the origin of most poses, and the sums of their figures. Scans in an overlap count twice
/// in the numbers of features.
PoseChoice join_choices(const std::vector<PlannedSection>& sections, const inputs::Recording& recording, const Blend& blend) {
  PoseChoice joint;
  std::size_t loam = 0, given = 0;
  for (std::size_t k = 0; k < sections.size(); ++k) {
    if (!blend.local(k)) continue;
    const PoseChoice& choice = sections[k].poses[*blend.local(k)].choice;
    ++(choice.from == inputs::PoseOrigin::loam ? loam : given);
    add_sharpness(choice.given, joint.given);
    add_sharpness(choice.loam, joint.loam);
    if (!joint.misread) joint.misread = choice.misread;
    if (!choice.odometry) continue;
    if (!joint.odometry) {
      joint.odometry.emplace();
      joint.odometry->rings = choice.odometry->rings;
      joint.odometry->scans.resize(recording.drive.scan_headers.size());
    }
    add_scan_fits(recording.drive, sections[k].drives[*blend.local(k)].drive, *choice.odometry, *joint.odometry);
    joint.odometry->plane_features += choice.odometry->plane_features;
    joint.odometry->edge_features += choice.odometry->edge_features;
    joint.odometry->loops += choice.odometry->loops;
    joint.odometry->largest_correction_m =
        std::max(joint.odometry->largest_correction_m, choice.odometry->largest_correction_m);
  }
  joint.from = loam > given ? inputs::PoseOrigin::loam : inputs::PoseOrigin::given;
  return joint;
}

/// Warns if two sections show the same place that are not neighbors.
void warn_of_returns(const Trajectory& joint, const std::vector<Border>& borders, Progress& progress) {
  std::vector<std::pair<std::size_t, Eigen::Vector3d>> places;
  for (const StampedPose& pose : joint.poses())
    if (places.empty() || (pose.world_from_body.t - places.back().second).norm() >= kReturn.step_m)
      places.emplace_back(section_at(borders, pose.time_ns), pose.world_from_body.t);
  for (std::size_t b = 0; b < places.size(); ++b)
    for (std::size_t a = 0; a < b; ++a) {
      if (places[b].first < places[a].first + 2 || (places[b].second - places[a].second).norm() > kReturn.radius_m) continue;
      progress.warn(
          fmt::format("section {} returns to a place of section {}: loops are closed inside of sections only, so map/ may show "
                      "the place twice",
                      places[b].first + 1, places[a].first + 1));
      return;
    }
}

}  // namespace

Poses join_poses(const std::vector<PlannedSection>& sections, const Recordings& drives, const std::vector<Border>& borders,
                 Progress& progress) {
  const std::vector<SE3> first_from_section = chain_worlds(sections, progress);
  Poses joint;
  for (std::size_t i = 0; i < drives.size(); ++i) {
    if (drives[i].rig_of) {
      joint.push_back(joint[*drives[i].rig_of]);
      continue;
    }
    const Blend blend(sections, borders, first_from_section, drives[i]);
    DrivePoses poses{join_choices(sections, drives[i], blend), blend.join(i == 0)};
    for (std::size_t k = 0; k < sections.size() && !poses.placed; ++k)
      if (blend.local(k)) poses.placed = sections[k].poses[*blend.local(k)].placed;
    if (poses.choice.odometry) poses.choice.odometry->world_from_lidar = poses.world_from_lidar;
    joint.push_back(std::move(poses));
  }
  warn_of_returns(joint.front().world_from_lidar, borders, progress);
  return joint;
}

std::optional<SE3> joint_from_section(const Trajectory& joint, const PlannedSection& section, std::size_t local,
                                      std::int64_t time_ns) {
  const std::optional<SE3> in_joint = joint.at(time_ns), in_section = section.poses[local].world_from_lidar.at(time_ns);
  if (!in_joint || !in_section) return std::nullopt;
  return *in_joint * in_section->inverse();
}

}  // namespace dvi::sections
