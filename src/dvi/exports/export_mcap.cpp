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

void write_file_of(const Result& result, McapWriter& file, const std::vector<CloudPoint>& cloud, Progress& progress) {
  const auto channel = [&](const char* topic, const ros::MessageType& type) {
    return file.add_channel(topic, type.name, type.definition);
  };
  const auto image = channel("/camera/image/compressed", ros::compressed_image_type());
  const auto kind = channel("/camera/kind/compressed", ros::compressed_image_type());
  const auto info = channel("/camera/camera_info", ros::camera_info_type());
  const auto map = channel("/map", ros::point_cloud_type());
  const auto path = channel("/path", ros::path_type());
  const auto tf = channel("/tf", ros::transform_type());
  std::vector<ros::StampedMotion> poses;
  for (const ResultFrame& frame : result.frames()) poses.push_back({frame.time_ns, frame.world_from_camera});
  const std::int64_t begin = poses.empty() ? 0 : poses.front().time_ns;
  file.write(map, begin, ros::point_cloud(begin, cloud));
  file.write(path, begin, ros::path(poses));
  make_and_use(
      poses.size(), [&](std::size_t i) { return media::encode_png(draw_overlay(result, i)); },
      [&](std::size_t i, const std::string& overlay) {
        const std::int64_t time = poses[i].time_ns;
        file.write(tf, time, ros::transform(poses[i]));
        file.write(info, time, ros::camera_info(time, result.camera()));
        file.write(image, time, ros::compressed_image(time, "png", read_file(result.picture("frames", i))));
        file.write(kind, time, ros::compressed_image(time, "png", overlay));
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
  return {"mcap", "a bag of ROS 2 messages: clean images, origin of pixels, map, path, tf (Foxglove, Lichtblick, Rerun, ROS 2)",
          write_mcap};
}

}  // namespace dvi::exports
