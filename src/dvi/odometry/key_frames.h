#pragma once

#include <cstddef>
#include <vector>

#include "dvi/core/lazy.h"
#include "dvi/odometry/direct_alignment.h"
#include "dvi/odometry/thumbnail.h"

namespace dvi::odometry {

/// A view that other images are aligned to. It belongs to a map: poses of key frames of one map share a world.
struct KeyFrame {
  std::size_t moment = 0;  ///< index of the RgbdMoment
  std::size_t map = 0;
  SE3 world_from_camera;
  Thumbnail thumbnail;
  std::vector<Eigen::Vector3f> outline;  ///< a few of its points, in camera axes
};

/// The key frames of a recording. A thumbnail and a few points of each stay in memory. The reference views, to which images are
/// aligned, are read again from the files unless they were used recently.
class KeyFrames {
 public:
  using ReadView = std::function<ReferenceView(std::size_t moment)>;

  KeyFrames(std::size_t moments, ReadView read);

  std::size_t size() const { return keys_.size(); }
  KeyFrame& operator[](std::size_t k) { return keys_[k]; }
  const KeyFrame& operator[](std::size_t k) const { return keys_[k]; }
  std::shared_ptr<const ReferenceView> view(std::size_t k) const { return views_[keys_[k].moment]; }

  /// Adds a key frame and returns its index.
  std::size_t add(std::size_t moment, const RgbdImage& image, const SE3& world_from_camera, std::size_t map);

  /// Returns the share of the points of key frame `k` that are within the image of a camera with this pose.
  double predict_overlap(std::size_t k, const SE3& world_from_camera, const Pinhole& camera, cv::Size size) const;

  /// Moves the key frames of one map into the world of another.
  void join(std::size_t from_map, std::size_t into_map, const SE3& into_from);

 private:
  std::vector<KeyFrame> keys_;
  Lazy<ReferenceView> views_;
};

}  // namespace dvi::odometry
