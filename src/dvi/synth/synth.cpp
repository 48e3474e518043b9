#include "dvi/synth/synth.h"

#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/core/files.h"
#include "dvi/core/text.h"
#include "dvi/core/threads.h"
#include "dvi/geometry/camera_toml.h"
#include "dvi/geometry/rigid.h"
#include "dvi/media/point_cloud.h"
#include "dvi/media/write_image.h"
#include "dvi/synth/texture.h"

namespace dvi::synth {
namespace {

std::string format_numbers(const SE3& pose, const char* between) {
  return fmt::format("{:.12g}", fmt::join(to_row_major(pose), between));
}

std::string format_settings(const Scene& scene) {
  const Camera& camera = scene.camera();
  const SynthOptions& options = scene.options();
  std::string text = "[drive]\nversion = 1\n\n";
  for (const SceneCamera& one : scene.cameras())
    text += fmt::format("[camera.{}]\nsize = [{}, {}]\n{}camera_from_lidar = [{}]\n\n", one.name, camera.width, camera.height,
                        format_intrinsics(camera), format_numbers(one.camera_from_lidar, ", "));
  if (options.room) return text + fmt::format("[lidar]\nsensor = \"depth_camera\"\nrate = {:.12g}\n", options.rate_hz);
  return text + fmt::format(
                    "[lidar]\nrate = {:.12g}\nbeams = {}\nstamp = \"middle\"\nrotation = \"clockwise\"\n"
                    "first_azimuth_deg = 180.0\n",
                    options.rate_hz, options.beams);
}

std::string format_readme(const SynthOptions& options) {
  SynthOptions copy = options;
  OptionTable table;
  copy.describe(table);
  return std::string("A synthetic ") + (options.room ? "room" : "street") +
         ", made by `dvi synth`: a drive in the `folder` layout with its exact truth.\n\n"
         "truth/NAME.png            the frame without traffic and noise, with the frame's exposure\n"
         "truth_depth/NAME.png      16-bit, depth z in meters x 256 of the static scene, at pixel centers, 0 sky; of\n"
         "                          cameras that are not pinhole cameras the distance\n"
         "truth_cameras.txt         NAME, 12 numbers camera_from_world (row-major 3x4) of the true camera, exposure gain\n"
         "truth/CAMERA/ and so on   the same of a camera that is not the first\n" +
         (options.room
              ? "poses.txt                 exact world_from_lidar of each image; axes x forward, y left, z up at the camera\n\n"
              : "truth_points/NAME.label   uint32 per point of lidar/NAME.bin, as in SemanticKITTI: 9 static, 252 to 259 on "
                "moving\n"
                "                          traffic, whose track is in the upper 16 bits\n"
                "poses.txt                 exact world_from_lidar at the middle of each scan, when the image is exposed\n\n") +
         "Made with\n\n" + table.dump_toml();
}

std::string format_frame_json(const std::vector<Label>& labels) {
  std::string text;
  for (const Label& label : labels) {
    const Eigen::Vector3d &c = label.box->frame_from_box.t, &size = label.box->size;
    const Eigen::Matrix3d& R = label.box->frame_from_box.R;
    text += fmt::format(
        R"({}{{"track":{},"class":"{}","center":[{:.6f},{:.6f},{:.6f}],"size":[{:.6f},{:.6f},{:.6f}],"yaw":{:.8f}}})",
        text.empty() ? "" : ",\n  ", label.track, label.type, c.x(), c.y(), c.z(), size.x(), size.y(), size.z(),
        std::atan2(R(1, 0), R(0, 0)));
  }
  return text;
}

/// Returns the path of a camera's files in `folder`: the folder itself for the first camera.
fs::path find_camera_folder(const Scene& scene, std::size_t camera, const fs::path& folder) {
  return camera == 0 ? folder : folder / scene.cameras()[camera].name;
}

void write_image(const Scene& scene, int frame, std::size_t camera, const fs::path& out) {
  const SynthFrame rendered = scene.render(frame, camera);
  const std::string& folder = scene.cameras()[camera].name;
  const std::string png = scene.name(frame) + ".png";
  media::write_png(out / "images" / folder / png, scene.record(frame, rendered, camera));
  media::write_png(out / "masks" / folder / png, scene.mask(rendered));
  media::write_png(find_camera_folder(scene, camera, out / "truth") / png, rendered.clean);
  cv::Mat depth;
  rendered.depth.convertTo(depth, CV_16U, 256);
  media::write_png(find_camera_folder(scene, camera, out / "truth_depth") / png, depth);
  if (scene.options().room) media::write_png(out / "depth" / folder / png, scene.depth_image(frame, rendered));
}

std::string to_label_bytes(const std::vector<std::uint32_t>& labels) {
  std::string bytes(labels.size() * sizeof(std::uint32_t), '\0');
  std::memcpy(bytes.data(), labels.data(), bytes.size());
  return bytes;
}

void write_frame(const Scene& scene, int frame, const fs::path& out) {
  for (std::size_t camera = 0; camera < scene.cameras().size(); ++camera) write_image(scene, frame, camera, out);
  if (scene.options().room) return;
  const std::string name = scene.name(frame);
  const SynthScan scan = scene.scan(frame);
  write_file(out / "lidar" / (name + ".bin"), media::to_bin_bytes(scan.scan));
  write_file(out / "truth_points" / (name + ".label"), to_label_bytes(scan.label));
}

std::string format_true_cameras(const Scene& scene, std::size_t camera) {
  std::string text;
  for (int i = 0; i < scene.options().frames; ++i)
    text += fmt::format("{} {} {:.12g}\n", scene.name(i), format_numbers(scene.camera_from_world(i, camera), " "),
                        scene.gain(i, camera));
  return text;
}

void write_tables(const Scene& scene, const fs::path& out) {
  std::string times, poses, boxes;
  for (int i = 0; i < scene.options().frames; ++i) {
    const std::string name = scene.name(i);
    const std::int64_t time = scene.time_ns(i);
    times += fmt::format("{} {}\n", name, to_seconds(time));
    poses += fmt::format("{} {}\n", name, format_numbers(scene.world_from_lidar(time), " "));
    boxes += fmt::format("{} \"{}\":[{}]", i == 0 ? "\n" : ",\n", name, format_frame_json(scene.boxes(i)));
  }
  for (std::size_t i = 0; i < scene.cameras().size(); ++i) {
    const std::string& camera = scene.cameras()[i].name;
    write_file(out / "times" / (camera + ".txt"), times);
    write_file(out / (i == 0 ? "truth_cameras.txt" : "truth_cameras_" + camera + ".txt"), format_true_cameras(scene, i));
  }
  if (!scene.options().room) write_file(out / "times/lidar.txt", times);
  write_file(out / "poses.txt", poses);
  write_file(out / "boxes.json", "{\"version\":1,\"frames\":{" + boxes + "\n}}\n");
  write_file(out / "README.txt", format_readme(scene.options()));
  // dvi.toml is written last: a folder without it is not a drive, so that a killed run leaves no folder that looks complete.
  write_file(out / "dvi.toml", format_settings(scene));
}

}  // namespace

void synthesize(const SynthOptions& options, const fs::path& out, const Tick& tick) {
  const Scene scene(options);
  make_folder(out / "times");
  for (const char* folder : {"lidar", "truth_points"})
    if (!options.room) make_folder(out / folder);
  for (std::size_t i = 0; i < scene.cameras().size(); ++i) {
    for (const char* folder : {"images", "masks"}) make_folder(out / folder / scene.cameras()[i].name);
    if (options.room) make_folder(out / "depth" / scene.cameras()[i].name);
    for (const char* folder : {"truth", "truth_depth"}) make_folder(find_camera_folder(scene, i, out / folder));
  }
  parallel_for(static_cast<std::size_t>(options.frames), [&](std::size_t i) {
    write_frame(scene, static_cast<int>(i), out);
    Texture::page_out();
    if (tick) tick();
  });
  write_tables(scene, out);
}

}  // namespace dvi::synth
