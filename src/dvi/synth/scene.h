#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/drive/drive.h"
#include "dvi/drive/view.h"
#include "dvi/synth/synth_options.h"

namespace dvi::synth {

/// One image of the scene with its truth, all without noise and with the frame's exposure.
struct SynthFrame {
  cv::Mat3b image;    ///< with traffic
  cv::Mat3b clean;    ///< without traffic
  cv::Mat1f depth;    ///< Camera::depth() in meters at the pixel's center, without traffic; 0: sky
  cv::Mat1f seen;     ///< the same with traffic, as measured by a depth camera
  cv::Mat1b dynamic;  ///< 255 where image differs from clean: traffic and its shadow
};

/// A scan with its truth.
struct SynthScan {
  Scan scan;
  std::vector<std::uint8_t> dynamic;  ///< one per point: 1 on traffic
  std::vector<std::uint32_t> label;   ///< one per point, as in PointLabels: a moving class and the track, or kStaticPointClass
  std::vector<float> range;           ///< one per point: in meters, without noise
};

/// One camera of the rig; all have the same lens.
struct SceneCamera {
  std::string name;
  SE3 camera_from_lidar;  ///< the recorded calibration; the true one of a frame differs from it by its jitter
  double gain = 1;        ///< factor of all its colors
};

/// The synthetic street or room and its recording in memory. Everything is computed on demand and deterministically. Frame i is
/// exposed at the middle of scan i. Thread-safe. The world is that of the street: x along it, z up, the road at z = 0. The
/// origin of a room is in the middle of its floor; its camera measures depth as well, and the axes of the LiDAR are replaced by
/// x forward, y left, z up at the camera.
class Scene {
 public:
  explicit Scene(const SynthOptions& options);
  ~Scene();
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  const SynthOptions& options() const { return options_; }
  const Camera& camera() const { return camera_; }
  const std::vector<SceneCamera>& cameras() const { return cameras_; }  ///< the first one is "front"

  std::string name(int frame) const;
  std::int64_t time_ns(int frame) const;  ///< of the image and of the middle of the scan
  SE3 world_from_lidar(std::int64_t time_ns) const;
  SE3 camera_from_world(int frame, std::size_t camera = 0) const;  ///< of the true camera
  double gain(int frame, std::size_t camera = 0) const;            ///< the exposure, a factor of all colors

  SynthFrame render(int frame, std::size_t camera = 0) const;
  /// Returns the image as recorded by a camera, with traffic and noise.
  cv::Mat3b record(int frame, const SynthFrame& rendered, std::size_t camera = 0) const;
  /// Returns the mask of the mask files: `dynamic`, enlarged by several pixels.
  cv::Mat1b mask(const SynthFrame& rendered) const;
  /// Returns the depth image of a room in millimeters, 0 for none.
  cv::Mat1w depth_image(int frame, const SynthFrame& rendered) const;
  /// Returns the scan; each firing has its own position and time.
  SynthScan scan(int frame) const;
  /// Returns the boxes of the moving traffic within the LiDAR's range, in LiDAR axes at the time of the image.
  std::vector<Label> boxes(int frame) const;

 private:
  struct World;
  double seconds(std::int64_t time_ns) const;
  int stream(int purpose, std::size_t camera) const;

  SynthOptions options_;
  Camera camera_;
  std::vector<SceneCamera> cameras_;
  std::unique_ptr<const World> world_;
};

/// Returns the recording like a reader, rendered on demand.
Drive drive_of(const std::shared_ptr<const Scene>& scene);

/// Returns its frames with the true cameras, images and masks, as input for the stages after alignment.
Views views_of(const std::shared_ptr<const Scene>& scene);

}  // namespace dvi::synth
