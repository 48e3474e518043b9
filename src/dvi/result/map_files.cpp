#include "dvi/result/map_files.h"

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/core/error.h"
#include "dvi/core/scratch.h"
#include "dvi/core/text.h"
#include "dvi/core/threads.h"
#include "dvi/geometry/rigid.h"
#include "dvi/map/visible_points.h"
#include "dvi/media/write_ply.h"

namespace dvi::result {
namespace {

/// Parameters of the map's colors.
struct ColorParams {
  std::size_t max_frames = 40;       ///< frames, evenly spread, that are compared with the map
  double splat_m = 0.07;             ///< size of a point
  double tolerance = 0.05;           ///< relative depth by which a point may be behind another one
  std::size_t bytes_per_pixel = 64;  ///< memory of a frame in progress
};
constexpr ColorParams kColors;
const cv::Vec3b kUncolored(128, 128, 128);

std::string format_kitti(const SE3& pose) { return fmt::format("{:.9g}\n", fmt::join(to_row_major(pose), " ")); }

std::string format_tum(std::int64_t time_ns, const SE3& pose) {
  const Eigen::Quaterniond q(pose.R);
  return fmt::format("{} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\n", to_seconds(time_ns), pose.t.x(), pose.t.y(),
                     pose.t.z(), q.x(), q.y(), q.z(), q.w());
}

std::vector<SE3> camera_poses(const Views& views, int sequence) {
  std::vector<SE3> poses;
  for (const View& view : views.views)
    if (view.sequence == sequence) poses.push_back(view.camera_from_world.inverse());
  return poses;
}

std::string format_poses(const Views& views, int sequence) {
  std::string text;
  for (const SE3& pose : camera_poses(views, sequence)) text += format_kitti(pose);
  return text;
}

std::string format_times(const Views& views, int sequence) {
  std::string text;
  for (const View& view : views.views)
    if (view.sequence == sequence) text += to_seconds(view.time_ns) + "\n";
  return text;
}

using Colors = ScratchVector<cv::Vec3b>;

/// Samples the color of each map point from the target's frames.
Colors sample_colors(const map::StaticMap& map, const Views& views) {
  Colors out(map.points.size(), kUncolored, map.scratch());
  const std::size_t last = views.of_sequence(0).second;
  if (last == 0) return out;
  const std::size_t step = std::max<std::size_t>(1, last / kColors.max_frames);
  struct ColoredPoints {
    std::vector<map::VisiblePoint> points;
    std::shared_ptr<const cv::Mat3b> image;
    std::shared_ptr<const cv::Mat1b> mask;
  };
  const auto find = [&](std::size_t n) {
    const std::size_t i = n * step;
    return ColoredPoints{map::find_visible_points(map, views[i], kColors.splat_m, kColors.tolerance), views.images[i],
                         views.masks[i]};
  };
  const auto sample = [&](std::size_t, const ColoredPoints& observed) {
    for (const map::VisiblePoint& p : observed.points) {
      const cv::Point pixel(cvRound(p.u), cvRound(p.v));
      if ((*observed.mask)(pixel) == 0)
        out[p.index] = (*observed.image)(pixel);  // later frames are nearer and replace earlier ones
    }
  };
  const Camera& camera = views[0].camera;
  const auto pixels = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  make_and_use((last + step - 1) / step, find, sample, kColors.bytes_per_pixel * pixels);
  return out;
}

void write_map(const fs::path& path, const map::StaticMap& map, const Colors& color, const std::string& comment) {
  ScratchVector<Eigen::Vector3f> points(map.scratch());
  Colors color_of_points(map.scratch());
  points.reserve(map.points.size());
  color_of_points.reserve(map.points.size());
  std::array<ScratchVector<float>, 7> scalars;
  scalars.fill(ScratchVector<float>(map.scratch()));
  for (ScratchVector<float>& of_points : scalars) of_points.reserve(map.points.size());
  const std::array<const char*, 7> names{"nx", "ny", "nz", "intensity", "count", "first", "last"};
  const auto seconds = [&](std::uint32_t scan) {
    return 1e-9F * static_cast<float>(map.scans[scan].time_ns - map.scans.front().time_ns);
  };
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    page_out_sometimes(i);
    const map::MapPoint& p = map.points[i];
    if (!p.is_present_in(0)) continue;
    points.push_back(p.position);
    color_of_points.push_back(color[i]);
    const std::array<float, 7> values{p.normal.x(),     p.normal.y(),   p.normal.z(), p.intensity, static_cast<float>(p.count),
                                      seconds(p.first), seconds(p.last)};
    for (std::size_t k = 0; k < values.size(); ++k) scalars[k].push_back(values[k]);
  }
  media::PlyCloud cloud{points, color_of_points, {}, comment};
  for (std::size_t k = 0; k < names.size(); ++k) cloud.scalars.push_back({names[k], scalars[k]});
  media::write_ply(path, cloud);
}

cv::Vec3b color_of(map::Cause cause) {
  switch (cause) {
    case map::Cause::masked:
      return {230, 120, 30};
    case map::Cause::boxed:
      return {40, 180, 240};
    case map::Cause::moved:
      return {40, 40, 220};
  }
  return kUncolored;
}

void write_removed(const fs::path& path, const ScratchVector<map::RemovedPoint>& removed, const std::string& comment) {
  const std::shared_ptr<Scratch> scratch = removed.get_allocator().scratch;
  ScratchVector<Eigen::Vector3f> points(scratch);
  Colors color(scratch);
  ScratchVector<float> cause(scratch);
  points.reserve(removed.size());
  color.reserve(removed.size());
  cause.reserve(removed.size());
  for (const map::RemovedPoint& p : removed) {
    points.push_back(p.position);
    color.push_back(color_of(p.cause));
    cause.push_back(static_cast<float>(p.cause));
  }
  media::write_ply(path, {points, color, {{"cause", cause}}, comment});
}

}  // namespace

std::vector<report::ObjectPath> collect_object_paths(const FrameLabels& labels, const Views& views,
                                                     const Trajectory& world_from_lidar) {
  std::map<int, report::ObjectPath> tracks;
  for (std::size_t i = 0; i < views.of_sequence(0).second; ++i) {
    const std::optional<SE3> world = world_from_lidar.at(views[i].time_ns);
    if (!world || views[i].frame >= labels.size()) continue;
    for (const Label& label : labels[views[i].frame]) {
      if (!label.box || label.track < 0) continue;
      report::ObjectPath& track = tracks[label.track];
      track.number = label.track;
      track.type = label.type;
      track.points.emplace_back((*world * label.box->frame_from_box.t).head<2>());
      track.frames.push_back(i);
    }
  }
  std::vector<report::ObjectPath> out;
  for (auto& [number, track] : tracks) out.push_back(std::move(track));
  return out;
}

void write_map_files(const fs::path& folder, const MapContents& contents) {
  const auto& [map, views, target, objects, cameras] = contents;
  make_folder(folder);
  write_file(folder / "poses.txt", format_poses(views, 0));
  write_file(folder / "times.txt", format_times(views, 0));
  for (std::size_t k = 0; k < cameras.size() && cameras.size() > 1; ++k) {
    make_folder(folder / cameras[k]);
    write_file(folder / cameras[k] / "poses.txt", format_poses(views, static_cast<int>(k)));
    write_file(folder / cameras[k] / "times.txt", format_times(views, static_cast<int>(k)));
  }
  const std::string name = target.path.filename().string();
  const Colors color = sample_colors(map, views);
  write_map(folder / "map.ply", map, color, "dvi map of " + name);
  report::write_top_view(folder, {.map = map,
                                  .color = [&](std::size_t point) { return color[point]; },
                                  .camera = target.camera,
                                  .world_from_camera = camera_poses(views, 0),
                                  .tracks = objects});
  write_removed(folder / "moving.ply", map.removed, "taken out of the dvi map of " + name);
}

std::optional<TrajectoryFormat> parse_trajectory_format(const std::string& name) {
  if (name == "none") return std::nullopt;
  if (name == "kitti") return TrajectoryFormat::kitti;
  if (name == "tum") return TrajectoryFormat::tum;
  throw UsageError("--trajectory " + name + ": there are kitti and tum");
}

void write_trajectory(const fs::path& file, const Drive& drive, const Trajectory& world_from_lidar, TrajectoryFormat format) {
  std::string text;
  for (const ScanHeader& header : drive.scan_headers)
    if (const std::optional<SE3> pose = world_from_lidar.at(header.time_ns))
      text += format == TrajectoryFormat::tum ? format_tum(header.time_ns, *pose) : format_kitti(*pose);
  write_file(file, text);
}

}  // namespace dvi::result
