#include <algorithm>
#include <array>
#include <numeric>

#include <opencv2/core.hpp>

#include "dvi/core/threads.h"
#include "dvi/exports/exporter.h"
#include "dvi/exports/map_cloud.h"
#include "dvi/exports/mcap_writer.h"
#include "dvi/exports/ros_messages.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/media/png_encode.h"

namespace dvi::exports {
namespace {

// Tints the filled parts of the clean image by their origin: green for this drive, blue for another drive or camera, orange for
// interpolated, red for synthesized or empty, violet for imported.
cv::Mat3b draw_overlay(const Result& result, std::size_t frame) {
  static const std::array<cv::Vec3b, 7> kTints{cv::Vec3b(0, 0, 0),     cv::Vec3b(60, 180, 60), cv::Vec3b(220, 120, 40),
                                               cv::Vec3b(0, 140, 255), cv::Vec3b(40, 40, 220), cv::Vec3b(40, 40, 220),
                                               cv::Vec3b(200, 60, 160)};
  cv::Mat3b picture = result.image(frame);
  const cv::Mat1b kind = result.kind(frame);
  for (int y = 0; y < kind.rows; ++y)
    for (int x = 0; x < kind.cols; ++x)
      if (kind(y, x) > 0 && kind(y, x) < kTints.size())
        for (int c = 0; c < 3; ++c) picture(y, x)[c] = static_cast<uchar>((picture(y, x)[c] + kTints[kind(y, x)][c]) / 2);
  return picture;
}

// The channels of a camera.
struct CameraChannels {
  std::string frame_id;
  std::uint16_t image = 0, kind = 0, info = 0;
};

// Adds the channels of each camera: /camera/image/compressed and so on, or /NAME/image/compressed if there are several.
std::vector<CameraChannels> add_cameras(const Result& result, McapWriter& file) {
  std::vector<CameraChannels> out;
  for (const ResultCamera& camera : result.cameras()) {
    const std::string name = result.cameras().size() == 1 ? "camera" : camera.name;
    const auto channel = [&](const char* topic, const ros::MessageType& type) {
      return file.add_channel("/" + name + topic, type.name, type.definition);
    };
    CameraChannels channels{name};
    channels.image = channel("/image/compressed", ros::compressed_image_type());
    channels.kind = channel("/kind/compressed", ros::compressed_image_type());
    channels.info = channel("/camera_info", ros::camera_info_type());
    out.push_back(channels);
  }
  return out;
}

// Returns the numbers of the frames in order of time.
std::vector<std::size_t> sort_by_time(const std::vector<ResultFrame>& frames) {
  std::vector<std::size_t> order(frames.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return frames[a].time_ns < frames[b].time_ns; });
  return order;
}

void write_file_of(const Result& result, McapWriter& file, const std::vector<CloudPoint>& cloud, Progress& progress) {
  const std::vector<CameraChannels> cameras = add_cameras(result, file);
  const auto channel = [&](const char* topic, const ros::MessageType& type) {
    return file.add_channel(topic, type.name, type.definition);
  };
  const auto map = channel("/map", ros::point_cloud_type());
  const auto path = channel("/path", ros::path_type());
  const auto tf = channel("/tf", ros::transform_type());
  const std::vector<ResultFrame>& frames = result.frames();
  const std::vector<std::size_t> order = sort_by_time(frames);
  std::vector<ros::StampedMotion> path_of_first;
  for (const ResultFrame& frame : frames)
    if (frame.camera == 0) path_of_first.push_back({frame.time_ns, frame.world_from_camera});
  const std::int64_t begin = frames.empty() ? 0 : frames[order.front()].time_ns;
  file.write(map, begin, ros::point_cloud(begin, cloud));
  file.write(path, begin, ros::path(path_of_first));
  make_and_use(
      order.size(), [&](std::size_t i) { return media::encode_png(draw_overlay(result, order[i])); },
      [&](std::size_t i, const std::string& overlay) {
        const ResultFrame& frame = frames[order[i]];
        const CameraChannels& camera = cameras[frame.camera];
        const std::int64_t time = frame.time_ns;
        const ros::Header header{time, camera.frame_id};
        file.write(tf, time, ros::transform({time, frame.world_from_camera}, camera.frame_id));
        file.write(camera.info, time, ros::camera_info(header, result.camera(order[i])));
        file.write(camera.image, time, ros::compressed_image(header, "png", read_file(result.picture("frames", order[i]))));
        file.write(camera.kind, time, ros::compressed_image(header, "png", overlay));
        progress.advance();
      });
}

ExportReport write_mcap(const Result& result, const fs::path& folder, const ExportOptions& options, Progress& progress) {
  const std::vector<CloudPoint> cloud =
      thin_cloud(read_map_cloud(result.folder() / "map/map.ply"), static_cast<std::size_t>(options.max_points));
  write_beside(folder / "drive.mcap", [&](const fs::path& part) {
    McapWriter file(part);
    write_file_of(result, file, cloud, progress);
    file.finish();
  });
  return {{"drive.mcap"},
          {{"images", static_cast<double>(result.frames().size())}, {"points", static_cast<double>(cloud.size())}}};
}

}  // namespace

ExportFormat mcap_format() {
  return {"mcap",
          "a bag of ROS 2 messages: clean images, origin of pixels, map, path, tf (Foxglove, Lichtblick, Rerun, ROS 2)",
          write_mcap,
          {},
          {"export.max_points"}};
}

}  // namespace dvi::exports
