#include "dvi/io/poses.h"

#include <map>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/io/rigid.h"
#include "dvi/io/text.h"

namespace dvi::io {
namespace {

SE3 matrix_pose(const TextLine& line, std::size_t first) {
  const auto numbers = line.numbers<12>(first);
  if (const auto pose = to_rigid(numbers)) return *pose;
  line.fail(rotation_problem(left_part(numbers)), "a pose is a 3x4 matrix, row by row, each row r r r t");
}

SE3 quaternion_pose(const TextLine& line) {
  const auto v = line.numbers<7>(1);
  const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  if (!(std::abs(q.norm() - 1) <= kPrintedRotation))
    line.fail(fmt::format("does not hold a quaternion of length 1 but of {:.4g}", q.norm()),
              "lines are: seconds tx ty tz qx qy qz qw");
  return {q.normalized().toRotationMatrix(), {v[0], v[1], v[2]}};
}

std::vector<StampedPose> by_scan(const std::vector<TextLine>& lines, const Drive& drive) {
  std::map<std::string, std::int64_t> times;
  for (const ScanHeader& header : drive.scan_headers) times[header.name] = header.time_ns;
  std::vector<StampedPose> poses;
  for (const TextLine& line : lines) {
    const SE3 pose = matrix_pose(line, 1);
    if (line.word(0).starts_with('@')) {
      const auto time = to_nanoseconds(std::string_view(line.word(0)).substr(1));
      if (!time) line.fail("'" + line.word(0) + "' is no time", "lines are: @seconds and 12 numbers");
      poses.push_back({*time, pose});
    } else if (const auto time = times.find(line.word(0)); time != times.end())
      poses.push_back({time->second, pose});
  }
  return poses;
}

std::vector<StampedPose> by_frame(const fs::path& file, const std::vector<TextLine>& lines, const Drive& drive) {
  if (lines.size() != drive.frames.size())
    throw InputError(file,
                     "has " + std::to_string(lines.size()) + " poses for " + std::to_string(drive.frames.size()) + " frames",
                     "give one line a frame, or choose the frames with --frames");
  std::vector<StampedPose> poses;
  for (std::size_t i = 0; i < lines.size(); ++i)
    poses.push_back({drive.frames[i].time_ns, matrix_pose(lines[i], 0) * drive.camera_from_lidar});
  return poses;
}

}  // namespace

Trajectory read_poses(const fs::path& file, const Drive& drive) {
  const std::vector<TextLine> lines = read_text_lines(file);
  if (lines.empty()) throw InputError(file, "holds no poses");
  std::vector<StampedPose> poses;
  switch (lines.front().size()) {
    case 13:
      poses = by_scan(lines, drive);
      break;
    case 12:
      poses = by_frame(file, lines, drive);
      break;
    case 8:
      for (const TextLine& line : lines) poses.push_back({line.nanoseconds(0), quaternion_pose(line)});
      break;
    default:
      lines.front().fail("has " + std::to_string(lines.front().size()) + " entries", "docs/formats.md shows lines of poses");
  }
  if (drive.camera_is_posed && lines.front().size() != 12)
    for (StampedPose& pose : poses) pose.world_from_body = pose.world_from_body * drive.camera_from_lidar;
  for (const StampedPose& pose : poses) require_near(pose.world_from_body.t, file, "a pose");
  if (poses.empty()) throw InputError(file, "its names are those of no scan of the drive");
  return Trajectory(std::move(poses));
}

}  // namespace dvi::io
