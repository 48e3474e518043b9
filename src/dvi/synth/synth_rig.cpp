#include "dvi/synth/synth_rig.h"

#include <array>
#include <cmath>
#include <numbers>

#include "dvi/geometry/angles.h"

namespace dvi::synth {
namespace {

using Eigen::Vector3d;

constexpr double kSideYawRad = std::numbers::pi / 3;                              // as on cars with cameras all around
constexpr double kRightGain = 1.05, kSideLeftGain = 0.96, kSideRightGain = 1.02;  // all cameras differ

struct RigCamera {
  const char* name;
  double left_deg, gain;
};
/// The cameras beside "front", in the directions of nuScenes' rig.
constexpr std::array<RigCamera, 5> kSixCameras = {{{"front-left", 55, 0.97},
                                                   {"front-right", -55, 1.03},
                                                   {"back", 180, 1.04},
                                                   {"back-left", 110, 0.98},
                                                   {"back-right", -110, 1.01}}};

/// Returns the pose of a camera that looks along the LiDAR's x, at a position in LiDAR axes.
SE3 make_camera_ahead(const Eigen::Matrix3d& error, const Vector3d& place) {
  SE3 camera;
  camera.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  camera.R = error * camera.R;
  camera.t = camera.R * -place;
  return camera;
}

SE3 rotate_camera(const SE3& camera_from_lidar, double left, const Vector3d& place) {
  const Eigen::Matrix3d R = camera_from_lidar.R * so3_exp({0, 0, -left});
  return {R, R * -place};
}

}  // namespace

Camera make_lens(const SynthOptions& options) {
  Camera lens;
  lens.width = options.width;
  lens.height = options.height;
  switch (options.lens) {
    case SynthLens::pinhole:
      lens.fx = lens.fy = 0.8 * options.width;
      break;
    case SynthLens::fisheye:
      lens.fx = lens.fy = options.width / std::numbers::pi;
      lens.set_lens(make_lens(CameraModel::fisheye, std::array{-0.02, 0.003, 0.0, 0.0}));
      break;
    case SynthLens::unified:  // about that of KITTI-360
      lens.fx = lens.fy = 0.95 * options.width;
      lens.set_lens(make_lens(CameraModel::unified, std::array{0.017, 1.65, 4e-4, 4e-4}, 2.2));
      break;
    case SynthLens::panorama:
      lens.fx = lens.fy = options.width / (2 * std::numbers::pi);
      lens.model = CameraModel::equirectangular;
      break;
  }
  lens.cx = 0.5 * (options.width - 1);
  lens.cy = 0.5 * (options.height - 1);
  return lens;
}

std::vector<SceneCamera> make_rig(const SynthOptions& options) {
  if (options.room) return {{"color", make_camera_ahead(Eigen::Matrix3d::Identity(), Vector3d::Zero())}};
  const SE3 front = make_camera_ahead(so3_exp({0.012, -0.008, 0.004}), {0.27, 0.06, -0.12});
  std::vector<SceneCamera> cameras = {{"front", front}};
  if (options.six_cameras)
    for (const auto& [name, left_deg, gain] : kSixCameras) {
      const Vector3d place(0.25 * std::cos(left_deg * kRadPerDegree), 0.4 * std::sin(left_deg * kRadPerDegree), -0.15);
      cameras.push_back({name, rotate_camera(front, left_deg * kRadPerDegree, place), gain});
    }
  if (options.stereo_m > 0) cameras.push_back({"right", SE3{front.R, front.t - Vector3d(options.stereo_m, 0, 0)}, kRightGain});
  if (options.side_cameras) {
    cameras.push_back({"side-left", rotate_camera(front, kSideYawRad, {0.1, 0.4, -0.15}), kSideLeftGain});
    cameras.push_back({"side-right", rotate_camera(front, -kSideYawRad, {0.1, -0.4, -0.15}), kSideRightGain});
  }
  return cameras;
}

}  // namespace dvi::synth
