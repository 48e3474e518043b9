#include "dvi/datasets/pose_file.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/datasets/file_names.h"
#include "dvi/geometry/rigid.h"

namespace dvi::datasets {
namespace {

SE3 parse_matrix_pose(const TextLine& line, std::size_t first) {
  const auto numbers = line.numbers<12>(first);
  if (const auto pose = to_rigid(numbers)) return *pose;
  line.fail(describe_rotation_problem(get_left_part(numbers)), "a pose is a 3x4 matrix, row by row, each row r r r t");
}

/// The lines of a pose file, without those that only name columns.
struct PoseLines {
  std::vector<TextLine> lines;
  bool w_first = false;  ///< whether quaternions begin with w, by the names of the columns
};

bool is_header(const TextLine& line) {
  if (line.size() < 8) return false;
  for (std::size_t i = 0; i < line.size(); ++i)
    if (to_number(line.word(i))) return false;
  return true;
}

bool has_w_first(std::string_view names) { return names.find("qw") < names.find("qx"); }

PoseLines read_pose_lines(const fs::path& file) {
  PoseLines out;
  std::size_t number = 0;
  for (std::string text : read_lines(file)) {
    ++number;
    if (text.starts_with('#')) {
      out.w_first = out.w_first || (out.lines.empty() && has_w_first(to_lower_case(text)));
      continue;
    }
    std::replace(text.begin(), text.end(), ',', ' ');
    TextLine line(file, number, text);
    if (out.lines.empty() && is_header(line))
      out.w_first = has_w_first(to_lower_case(text));
    else
      out.lines.push_back(std::move(line));
  }
  return out;
}

SE3 parse_quaternion_pose(const TextLine& line, bool w_first) {
  const auto v = line.numbers<7>(1);
  const Eigen::Quaterniond q =
      w_first ? Eigen::Quaterniond(v[3], v[4], v[5], v[6]) : Eigen::Quaterniond(v[6], v[3], v[4], v[5]);
  if (!(std::abs(q.norm() - 1) <= kMaxRotationError))
    line.fail(fmt::format("does not hold a quaternion of length 1 but of {:.4g}", q.norm()),
              "lines are: seconds tx ty tz qx qy qz qw");
  return {q.normalized().toRotationMatrix(), {v[0], v[1], v[2]}};
}

/// Throws InputError if a line gives another pose for the time of an earlier line, since either may be meant.
void require_one_pose(const TextLine& line, const StampedPose& pose, std::map<std::int64_t, SE3>& known) {
  constexpr double kMaxDifferenceM = 0.01, kMaxDifferenceRad = 0.002;
  const auto [earlier, is_new] = known.try_emplace(pose.time_ns, pose.world_from_body);
  if (is_new) return;
  const SE3 off = earlier->second.inverse() * pose.world_from_body;
  if (off.t.norm() > kMaxDifferenceM || so3_log(off.R).norm() > kMaxDifferenceRad)
    line.fail(fmt::format("gives another pose for '{}', {:.2f} m from the first", line.word(0), off.t.norm()),
              "keep one of them");
}

std::vector<StampedPose> parse_poses_by_scan(const std::vector<TextLine>& lines, const Drive& drive) {
  std::map<std::string, std::int64_t> times;
  for (const ScanHeader& header : drive.scan_headers) times[to_name_key(header.name)] = header.time_ns;
  std::vector<StampedPose> poses;
  std::map<std::int64_t, SE3> known;
  for (const TextLine& line : lines) {
    const SE3 pose = parse_matrix_pose(line, 1);
    if (line.word(0).starts_with('@')) {
      const auto time = to_nanoseconds(std::string_view(line.word(0)).substr(1));
      if (!time) line.fail("'" + line.word(0) + "' is not a time", "lines are: @seconds and 12 numbers");
      poses.push_back({*time, pose});
    } else if (const auto time = times.find(to_name_key(line.word(0))); time != times.end())
      poses.push_back({time->second, pose});
    else
      continue;
    require_one_pose(line, poses.back(), known);
  }
  return poses;
}

std::vector<StampedPose> parse_poses_by_time(const PoseLines& file) {
  std::vector<StampedPose> poses;
  std::map<std::int64_t, SE3> known;
  for (const TextLine& line : file.lines) {
    poses.push_back({line.nanoseconds(0), parse_quaternion_pose(line, file.w_first)});
    require_one_pose(line, poses.back(), known);
  }
  return poses;
}

std::vector<StampedPose> parse_poses_by_frame(const fs::path& file, const std::vector<TextLine>& lines, const Drive& drive) {
  if (lines.size() != drive.frames.size())
    throw InputError(file,
                     "has " + std::to_string(lines.size()) + " poses for " + std::to_string(drive.frames.size()) + " frames",
                     "give one line per frame, or select the frames with --frames");
  std::vector<StampedPose> poses;
  for (std::size_t i = 0; i < lines.size(); ++i)
    poses.push_back({drive.frames[i].time_ns, parse_matrix_pose(lines[i], 0) * drive.camera_from_lidar});
  return poses;
}

}  // namespace

Trajectory read_poses(const fs::path& file, const Drive& drive) {
  const PoseLines read = read_pose_lines(file);
  const std::vector<TextLine>& lines = read.lines;
  if (lines.empty()) throw InputError(file, "holds no poses");
  std::vector<StampedPose> poses;
  switch (lines.front().size()) {
    case 13:
      poses = parse_poses_by_scan(lines, drive);
      break;
    case 12:
      poses = parse_poses_by_frame(file, lines, drive);
      break;
    case 8:
      poses = parse_poses_by_time(read);
      break;
    default:
      lines.front().fail("has " + std::to_string(lines.front().size()) + " entries", "docs/formats.md shows lines of poses");
  }
  if (drive.camera_is_posed && lines.front().size() != 12)
    for (StampedPose& pose : poses) pose.world_from_body = pose.world_from_body * drive.camera_from_lidar;
  for (const StampedPose& pose : poses) require_near(pose.world_from_body.t, file, "a pose");
  if (poses.empty()) throw InputError(file, "none of its names is that of a scan of the drive");
  return Trajectory(std::move(poses));
}

}  // namespace dvi::datasets
