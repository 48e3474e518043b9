#include "dvi/synth/scene.h"

#include <cmath>

namespace dvi::synth {
namespace {

constexpr std::size_t kMaxCached = 16;

Lazy<SynthFrame> make_frames(const std::shared_ptr<const Scene>& scene) {
  return {static_cast<std::size_t>(scene->options().frames), kMaxCached,
          [scene](std::size_t i) { return scene->render(static_cast<int>(i)); }};
}

Lazy<cv::Mat3b> make_images(const std::shared_ptr<const Scene>& scene, const Lazy<SynthFrame>& frames) {
  return {frames.size(), kMaxCached, [scene, frames](std::size_t i) { return scene->record(static_cast<int>(i), *frames[i]); }};
}

Lazy<cv::Mat1b> make_masks(const std::shared_ptr<const Scene>& scene, const Lazy<SynthFrame>& frames) {
  return {frames.size(), kMaxCached, [scene, frames](std::size_t i) { return scene->mask(*frames[i]); }};
}

}  // namespace

Drive drive_of(const std::shared_ptr<const Scene>& scene) {
  const std::int64_t half = std::llround(0.5e9 / scene->options().rate_hz);
  Drive drive;
  drive.format = "folder";
  drive.camera_name = scene->cameras().front().name;
  drive.camera_names = {drive.camera_name};
  drive.camera = scene->camera();
  drive.camera_from_lidar = scene->cameras().front().camera_from_lidar;
  drive.labeled = true;
  std::vector<StampedPose> poses;
  for (int i = 0; i < scene->options().frames; ++i) {
    const std::int64_t time = scene->time_ns(i);
    drive.frames.push_back({i, scene->name(i), time, {}, scene->boxes(i)});
    drive.scan_headers.push_back({scene->name(i), time, time - half, time + half, {}});
    poses.push_back({time, scene->world_from_lidar(time)});
  }
  drive.poses = Trajectory(poses);
  const Lazy<SynthFrame> frames = make_frames(scene);
  drive.images = make_images(scene, frames);
  drive.masks = make_masks(scene, frames);
  drive.scans = Lazy<Scan>(frames.size(), kMaxCached, [scene](std::size_t i) { return scene->scan(static_cast<int>(i)).scan; });
  return drive;
}

Views views_of(const std::shared_ptr<const Scene>& scene) {
  Views views;
  for (int i = 0; i < scene->options().frames; ++i)
    views.views.push_back({0, static_cast<std::size_t>(i), scene->time_ns(i), scene->camera(), scene->camera_from_world(i)});
  const Lazy<SynthFrame> frames = make_frames(scene);
  views.images = make_images(scene, frames);
  views.masks = make_masks(scene, frames);
  return views;
}

}  // namespace dvi::synth
