#include "dvi/exports/colmap_rigs.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "dvi/drive/nearest_in_time.h"
#include "dvi/geometry/angles.h"
#include "dvi/geometry/rigid.h"

namespace dvi::exports {
namespace {

constexpr std::int64_t kSameTimeNs = 5'000'000;
constexpr double kMaxShiftM = 0.01, kMaxTurnDeg = 0.1;

/// Images that are taken at the same time by cameras of one rig, as indices in Result::frames().
struct RigFrame {
  std::int64_t time_ns = 0;
  std::vector<std::size_t> images;
};

std::vector<std::size_t> list_images(const Result& result, std::size_t camera) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < result.frames().size(); ++i)
    if (result.frames()[i].camera == camera) out.push_back(i);
  return out;
}

/// Returns the mean of poses; nothing if one of them differs from it, or there are none.
std::optional<SE3> find_constant_pose(const std::vector<SE3>& poses) {
  if (poses.empty()) return std::nullopt;
  Eigen::Matrix3d R = Eigen::Matrix3d::Zero();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
  for (const SE3& pose : poses) R += pose.R, t += pose.t;
  const SE3 mean{nearest_rotation(R / static_cast<double>(poses.size())), t / static_cast<double>(poses.size())};
  for (const SE3& pose : poses)
    if ((pose.t - mean.t).norm() > kMaxShiftM || so3_log(pose.R * mean.R.transpose()).norm() > to_radians(kMaxTurnDeg))
      return std::nullopt;
  return mean;
}

std::string format_pose(const SE3& pose) {
  const Eigen::Quaterniond q(pose.R);
  return fmt::format("{:.12g} {:.12g} {:.12g} {:.12g} {:.12g} {:.12g} {:.12g}", q.w(), q.x(), q.y(), q.z(), pose.t.x(),
                     pose.t.y(), pose.t.z());
}

/// The rig of the first camera and its members.
class FirstRig {
 public:
  explicit FirstRig(const Result& result) : result_(result) {
    for (const std::size_t image : list_images(result, 0)) frames_.push_back({result.frames()[image].time_ns, {image}});
  }

  /// Adds a camera if it is mounted rigidly, and shares its times. Its images at other times become frames without the first
  /// camera.
  bool add(std::size_t camera) {
    std::vector<SE3> poses;
    const std::vector<std::size_t> images = list_images(result_, camera);
    for (const std::size_t image : images) {
      const RigFrame* const frame = find_frame(result_.frames()[image].time_ns);
      if (frame != nullptr && result_.frames()[frame->images.front()].camera == 0)
        poses.push_back(camera_from_world(image) * camera_from_world(frame->images.front()).inverse());
    }
    const std::optional<SE3> mount = find_constant_pose(poses);
    if (!mount) return false;
    sensors_ += fmt::format(" CAMERA {} 1 {}", camera + 1, format_pose(*mount));
    ++cameras_;
    for (const std::size_t image : images) {
      const std::int64_t time_ns = result_.frames()[image].time_ns;
      if (RigFrame* const frame = find_frame(time_ns))
        frame->images.push_back(image);
      else
        frames_.insert(std::ranges::upper_bound(frames_, time_ns, {}, &RigFrame::time_ns), {time_ns, {image}});
    }
    mounts_.resize(camera + 1);
    mounts_[camera] = *mount;
    return true;
  }

  std::string format_rig() const { return fmt::format("1 {} CAMERA 1{}\n", cameras_, sensors_); }
  const std::vector<RigFrame>& frames() const { return frames_; }
  /// Returns rig_from_world, where the axes of the rig are those of its first camera.
  SE3 pose_of(const RigFrame& frame) const {
    const std::size_t image = frame.images.front(), camera = result_.frames()[image].camera;
    return camera == 0 ? camera_from_world(image) : mounts_[camera].inverse() * camera_from_world(image);
  }

 private:
  /// Returns the frame nearest in time; nothing beyond kSameTimeNs.
  RigFrame* find_frame(std::int64_t time_ns) {
    const auto nearest = nearest_in_time(frames_.begin(), frames_.end(), time_ns);
    return nearest == frames_.end() || std::abs(nearest->time_ns - time_ns) > kSameTimeNs ? nullptr : &*nearest;
  }
  SE3 camera_from_world(std::size_t image) const { return result_.frames()[image].world_from_camera.inverse(); }

  const Result& result_;
  std::vector<RigFrame> frames_;  ///< in order of time
  std::vector<SE3> mounts_;       ///< by camera: its pose in the rig
  std::string sensors_;
  std::size_t cameras_ = 1;
};

std::string format_frame(std::size_t number, std::size_t rig, const SE3& pose, const std::vector<std::string>& data) {
  std::string text = fmt::format("{} {} {} {}", number, rig, format_pose(pose), data.size());
  for (const std::string& one : data) text += one;
  return text + "\n";
}

}  // namespace

ColmapRigs describe_rigs(const Result& result) {
  const auto name_data = [&](std::size_t image) {
    return fmt::format(" CAMERA {} {}", result.frames()[image].camera + 1, image + 1);
  };
  ColmapRigs out;
  out.rigs =
      "# RIG_ID, NUM_SENSORS, REF_SENSOR_TYPE, REF_SENSOR_ID, SENSORS[] as (SENSOR_TYPE, SENSOR_ID, HAS_POSE, "
      "QW, QX, QY, QZ, TX, TY, TZ)\n";
  out.frames =
      "# FRAME_ID, RIG_ID, QW, QX, QY, QZ, TX, TY, TZ, NUM_DATA_IDS, DATA_IDS[] as (SENSOR_TYPE, SENSOR_ID, DATA_ID)\n";
  FirstRig first(result);
  std::vector<std::size_t> others;
  for (std::size_t camera = 1; camera < result.cameras().size(); ++camera)
    if (!first.add(camera)) others.push_back(camera);
  out.rigs += first.format_rig();
  std::size_t number = 0, rig = 1;
  for (const RigFrame& frame : first.frames()) {
    std::vector<std::string> data;
    for (const std::size_t image : frame.images) data.push_back(name_data(image));
    out.frames += format_frame(++number, rig, first.pose_of(frame), data);
  }
  for (const std::size_t camera : others) {
    out.rigs += fmt::format("{} 1 CAMERA {}\n", ++rig, camera + 1);
    for (const std::size_t image : list_images(result, camera))
      out.frames += format_frame(++number, rig, result.frames()[image].world_from_camera.inverse(), {name_data(image)});
  }
  return out;
}

}  // namespace dvi::exports
