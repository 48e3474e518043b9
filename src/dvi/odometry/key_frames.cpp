#include "dvi/odometry/key_frames.h"

#include <utility>

namespace dvi::odometry {
namespace {

constexpr std::size_t kViewsInMemory = 12;
constexpr int kOutlineStep = 3;  // pixels of the coarsest level

}  // namespace

KeyFrames::KeyFrames(std::size_t moments, ReadView read) : views_(moments, kViewsInMemory, std::move(read)) {}

std::size_t KeyFrames::add(std::size_t moment, const RgbdImage& image, const SE3& world_from_camera, std::size_t map) {
  KeyFrame key{moment, map, world_from_camera, make_thumbnail(image), {}};
  const RgbdLevel& coarsest = image.levels.back();
  for (int y = 1; y < coarsest.points.rows; y += kOutlineStep)
    for (int x = 1; x < coarsest.points.cols; x += kOutlineStep)
      if (const Eigen::Vector3f p = coarsest.point(y, x); p.z() > 0) key.outline.push_back(p);
  keys_.push_back(std::move(key));
  return keys_.size() - 1;
}

double KeyFrames::predict_overlap(std::size_t k, const SE3& world_from_camera, const Pinhole& camera, cv::Size size) const {
  const KeyFrame& key = keys_[k];
  if (key.outline.empty()) return 0;
  const SE3 camera_from_key = world_from_camera.inverse() * key.world_from_camera;
  std::size_t visible = 0;
  for (const Eigen::Vector3f& point : key.outline) {
    const Eigen::Vector3f p = (camera_from_key * point.cast<double>()).cast<float>();
    if (p.z() <= 0.05F) continue;
    const Eigen::Vector2f at = camera.project(p);
    if (at.x() >= 0 && at.y() >= 0 && at.x() < static_cast<float>(size.width) && at.y() < static_cast<float>(size.height))
      ++visible;
  }
  return static_cast<double>(visible) / static_cast<double>(key.outline.size());
}

void KeyFrames::join(std::size_t from_map, std::size_t into_map, const SE3& into_from) {
  for (KeyFrame& key : keys_)
    if (key.map == from_map) key.map = into_map, key.world_from_camera = into_from * key.world_from_camera;
}

}  // namespace dvi::odometry
