#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/natural_order.h"
#include "dvi/core/text.h"
#include "dvi/datasets/camera_choice.h"
#include "dvi/datasets/depth_scan.h"
#include "dvi/datasets/drive_config.h"
#include "dvi/datasets/file_names.h"
#include "dvi/datasets/folder_images.h"
#include "dvi/datasets/gps.h"
#include "dvi/datasets/map_file.h"
#include "dvi/datasets/pose_file.h"
#include "dvi/datasets/reader.h"
#include "dvi/datasets/rgbd.h"
#include "dvi/datasets/scan_files.h"
#include "dvi/drive/nearest_in_time.h"
#include "dvi/labels/labels.h"
#include "dvi/labels/mask_folder.h"
#include "dvi/media/image_file.h"
#include "dvi/media/image_storage.h"
#include "dvi/media/video_reader.h"

namespace dvi::datasets {
namespace {

using Times = std::map<std::string, std::int64_t>;  // to_name_key() to nanoseconds

using Spans = std::map<std::string, TimeSpan>;

// Reads lines "NAME seconds". If `spans` is given, lines of scans may have a start and an end as well.
Times read_times(const fs::path& file, Spans* spans) {
  Times times;
  for (const TextLine& line : read_text_lines(file)) {
    const bool spanned = spans != nullptr && line.size() == 4;
    if (line.size() != 2 && !spanned)
      line.fail("has " + std::to_string(line.size()) + " entries instead of 2",
                spans == nullptr ? "lines are: NAME seconds" : "lines are: NAME seconds, or NAME seconds START END");
    const std::string key = to_name_key(line.word(0));
    times[key] = line.nanoseconds(1);
    if (!spanned) continue;
    const TimeSpan span{line.nanoseconds(2), line.nanoseconds(3)};
    if (span.first > times[key] || span.last < times[key])
      line.fail("does not start before its time and end after it", "lines are: NAME seconds START END");
    (*spans)[key] = span;
  }
  return times;
}

bool are_unique_numbers(const std::vector<std::string>& names) {
  std::set<int> numbers;
  for (const std::string& name : names) {
    const auto number = is_all_digits(name) ? to_integer(name) : std::nullopt;
    if (!number || !numbers.insert(*number).second) return false;
  }
  return true;
}

std::vector<std::string> list_names(const std::vector<NamedFile>& files) {
  std::vector<std::string> names;
  for (const NamedFile& file : files) names.push_back(file.name);
  return names;
}

using Keys = std::set<std::string, NaturalLess>;

Keys list_keys(const std::vector<NamedFile>& files) {
  Keys keys;
  for (const NamedFile& file : files) keys.insert(to_name_key(file.name));
  return keys;
}

// Returns whether names of images and scans overlap. Names that count the scans of one drive do.
bool share_names(const Keys& images, const Keys& scans, bool by_number) {
  if (images.empty() || scans.empty()) return true;
  if (by_number) return !natural_less(*images.rbegin(), *scans.begin()) && !natural_less(*scans.rbegin(), *images.begin());
  return std::any_of(images.begin(), images.end(), [&](const std::string& name) { return scans.contains(name); });
}

// Without any times, an image and a scan with the same name belong together. Their numbers, or their indices among all names,
// count scans.
Times count_times(Drive& drive, const std::vector<NamedFile>& images, const std::vector<NamedFile>& scans, double rate) {
  const Keys of_images = list_keys(images), of_scans = list_keys(scans);
  Keys names = of_images;
  names.insert(of_scans.begin(), of_scans.end());
  const bool by_number = are_unique_numbers({names.begin(), names.end()});
  if (!share_names(of_images, of_scans, by_number))
    throw InputError(images.front().file,
                     fmt::format("has no scan of the same name, nor has any other image: the first scan is {}",
                                 scans.front().file.filename().string()),
                     "give an image and a scan of the same time the same name, or add times/CAMERA.txt and times/lidar.txt");
  if (const auto order = describe_order({names.begin(), names.end()})) drive.warnings.push_back(*order);
  Times times;
  for (int index = 0; const std::string& name : names) {
    const int count = by_number ? *to_integer(name) : index;
    if (!(count / rate < kLatestSecond))
      throw InputError(drive.path / "images", "'" + name + "' is too large for a number that counts scans",
                       "remove the file, or add times/");
    times[name] = std::llround(1e9 * count / rate);
    ++index;
  }
  return times;
}

// The times of images and scans, before the offsets of their clocks are added.
struct Clocks {
  Times camera, lidar;
  Spans scans;  ///< start and end, if the file states them
  fs::path camera_file, lidar_file;
};

// Returns the times of a video's frames. A file overrides those of the container; its lines are as for images, or seconds only.
Times read_video_times(const fs::path& file, const FolderImages& images) {
  Times times;
  if (!fs::exists(file)) {
    for (std::size_t i = 0; i < images.files.size(); ++i)
      times[to_name_key(images.files[i].name)] = images.video->times_ns()[i];
    return times;
  }
  const std::vector<TextLine> lines = read_text_lines(file);
  if (lines.size() != images.files.size())
    throw InputError(file,
                     fmt::format("has {} times, but {} has {} frames", lines.size(),
                                 images.files.front().file.filename().string(), images.files.size()),
                     "write one line per frame");
  if (lines.front().size() != 1) return read_times(file, nullptr);
  for (std::size_t i = 0; i < lines.size(); ++i) times[to_name_key(images.files[i].name)] = lines[i].nanoseconds(0);
  return times;
}

Clocks read_video_clocks(Drive& drive, const FolderImages& images, const std::vector<NamedFile>& scans, double rate) {
  Clocks clocks;
  clocks.camera_file = drive.path / "times" / (drive.camera_name + ".txt");
  clocks.lidar_file = drive.path / "times" / "lidar.txt";
  clocks.camera = read_video_times(clocks.camera_file, images);
  clocks.lidar =
      fs::exists(clocks.lidar_file) ? read_times(clocks.lidar_file, &clocks.scans) : count_times(drive, {}, scans, rate);
  for (const fs::path& file : {clocks.camera_file, clocks.lidar_file})
    if (fs::exists(file)) drive.other_files.push_back(file);
  return clocks;
}

Clocks read_clocks(Drive& drive, const std::vector<NamedFile>& images, const std::vector<NamedFile>& scans, double rate) {
  Clocks clocks;
  clocks.camera_file = drive.path / "times" / (drive.camera_name + ".txt");
  clocks.lidar_file = drive.path / "times" / "lidar.txt";
  const bool camera = fs::exists(clocks.camera_file), lidar = fs::exists(clocks.lidar_file);
  if (camera) clocks.camera = read_times(clocks.camera_file, nullptr), drive.other_files.push_back(clocks.camera_file);
  if (lidar) clocks.lidar = read_times(clocks.lidar_file, &clocks.scans), drive.other_files.push_back(clocks.lidar_file);
  if (!camera) clocks.camera = lidar ? clocks.lidar : count_times(drive, images, scans, rate);
  if (!lidar) clocks.lidar = clocks.camera;
  return clocks;
}

std::int64_t find_time(const Times& times, const NamedFile& file, const fs::path& source) {
  if (const auto time = times.find(to_name_key(file.name)); time != times.end()) return time->second;
  throw InputError(file.file, "has no time", "add a line '" + file.name + " seconds' to " + source.string());
}

std::vector<Frame> make_frames(const std::vector<NamedFile>& files, const Clocks& clocks) {
  const bool by_number = are_unique_numbers(list_names(files));
  std::vector<Frame> frames;
  for (const NamedFile& file : files)
    frames.push_back({0, file.name, find_time(clocks.camera, file, clocks.camera_file), file.file, {}});
  std::stable_sort(frames.begin(), frames.end(), [](const Frame& a, const Frame& b) { return a.time_ns < b.time_ns; });
  for (std::size_t i = 0; i < frames.size(); ++i)
    frames[i].number = by_number ? *to_integer(frames[i].name) : static_cast<int>(i);
  for (std::size_t i = 1; i < frames.size(); ++i)
    if (frames[i].number < frames[i - 1].number)
      throw InputError(frames[i].file, "comes before " + frames[i - 1].name + " by name but after it by time",
                       "the order of names must be the order of time; correct " + clocks.camera_file.string());
  return frames;
}

std::vector<ScanHeader> make_scan_headers(const std::vector<NamedFile>& files, const Clocks& clocks, std::int64_t length,
                                          LidarConfig::Stamp stamp) {
  std::vector<ScanHeader> scan_headers;
  for (const NamedFile& file : files) {
    const std::int64_t time = find_time(clocks.lidar, file, clocks.lidar_file);
    if (const auto span = clocks.scans.find(to_name_key(file.name)); span != clocks.scans.end()) {
      scan_headers.push_back({file.name, time, span->second.first, span->second.last, file.file});
      continue;
    }
    const std::int64_t half = length / 2;
    const std::int64_t middle = stamp == LidarConfig::Stamp::start ? time + half
                                : stamp == LidarConfig::Stamp::end ? time - half
                                                                   : time;
    scan_headers.push_back({file.name, middle, middle - half, middle + half, file.file});
  }
  std::stable_sort(scan_headers.begin(), scan_headers.end(),
                   [](const ScanHeader& a, const ScanHeader& b) { return a.time_ns < b.time_ns; });
  return scan_headers;
}

std::vector<Gap> find_gaps(Drive& drive, std::int64_t period) {
  Gap images{"no image for frames", {}}, scans{"no scan for frames", {}}, poses{"no pose for the scans of frames", {}};
  std::set<std::int64_t> posed;
  for (const StampedPose& pose : drive.poses.poses()) posed.insert(pose.time_ns);
  const bool by_scan = !posed.empty() && std::any_of(drive.scan_headers.begin(), drive.scan_headers.end(),
                                                     [&](const ScanHeader& header) { return posed.contains(header.time_ns); });
  std::map<int, int> steps;
  for (std::size_t i = 0; i < drive.frames.size(); ++i) {
    const Frame& frame = drive.frames[i];
    if (i > 0) ++steps[frame.number - drive.frames[i - 1].number];
    const ScanHeader* header = nearest_in_time(drive.scan_headers, frame.time_ns, period * 6 / 10);
    if (!header && drive.map.empty()) scans.frames.push_back(frame.number);
    if (header && by_scan && !posed.contains(header->time_ns)) poses.frames.push_back(frame.number);
  }
  // Missing numbers are listed only if the numbers usually increase by the same step, and not if names are times, for example.
  const auto usual = std::max_element(steps.begin(), steps.end(), [](auto& a, auto& b) { return a.second < b.second; });
  const bool even = usual != steps.end() && 2 * static_cast<std::size_t>(usual->second) >= drive.frames.size() - 1;
  if (even && can_list_numbers(drive, usual->first))
    for (std::size_t i = 1; i < drive.frames.size(); ++i)
      for (std::int64_t number = std::int64_t{drive.frames[i - 1].number} + usual->first; number < drive.frames[i].number;
           number += usual->first)
        images.frames.push_back(static_cast<int>(number));
  return {images, scans, poses};
}

DriveConfig read_config(const fs::path& path) {
  const auto config = read_drive_config(path);
  if (!config) throw InputError(path / "dvi.toml", "is missing", "dvi init " + path.string() + " writes one to fill in");
  if (config->cameras.empty())
    throw InputError(config->file, "has no table [camera.NAME]",
                     "rename the file, and dvi init " + path.string() + " writes one to fill in");
  return *config;
}

// The source of the geometry.
enum class Geometry { scans, depth, map };

void set_camera(Drive& drive, const DriveConfig& config, const FolderImages& images, Geometry geometry) {
  const CameraConfig camera = config.camera(drive.camera_name);
  const std::string table = "[camera." + drive.camera_name + "]";
  if (!camera.K) throw InputError(config.file, table + " has no K", "add K = [fx, 0, cx, 0, fy, cy, 0, 0, 1] in pixels");
  if (!camera.camera_from_lidar && geometry == Geometry::scans)
    throw InputError(config.file, table + " has no camera_from_lidar", "add the 12 numbers of a 3x4 matrix, row by row");
  if (images.video && camera.size.value_or(images.video->size()) != images.video->size())
    throw InputError(
        images.files.front().file,
        fmt::format("is {}x{} pixels, but {} has another size", images.video->size().width, images.video->size().height, table),
        images.video->rotation_deg() != 0
            ? media::describe_video_rotation(images.files.front().file.filename(), images.video->rotation_deg())
            : "set K for images of the video's size");
  if (!camera.size) {
    const cv::Size size = images.video ? images.video->size() : media::image_size(drive.frames.front().file);
    drive.camera.width = size.width, drive.camera.height = size.height;
  }
  if (geometry == Geometry::map) {
    drive.camera_from_lidar = camera_from_level();
    drive.camera_is_posed = !camera.camera_from_lidar;
  }
  camera.apply(drive);
  config.require_plausible(drive);
  if (geometry == Geometry::depth)  // its times are on the camera's clock
    for (ScanHeader& header : drive.scan_headers)
      header.time_ns += camera.offset_ns, header.start_ns = header.end_ns = header.time_ns;
}

[[noreturn]] void fail_without_cameras(const fs::path& path, const DriveConfig& config) {
  for (const auto& [name, camera] : config.cameras)
    if (const fs::path folder = path / "images" / name; describe_unread_images(folder))
      fail_without_images(folder, "holds no images in a supported format", {});
  fail_without_images(path / "images", "holds no images of a camera that dvi.toml names",
                      "put them into images/CAMERA, or add images/CAMERA.mp4");
}

// The files of the geometry: scans, depth images, or a map.
struct GeometryFiles {
  Geometry kind = Geometry::scans;
  std::vector<NamedFile> scans;  // or depth images
  std::optional<fs::path> map;
};

GeometryFiles find_geometry(const fs::path& path, Drive& drive) {
  GeometryFiles out{.scans = name_files(list_files(path / "lidar", {".bin", ".ply", ".pcd"})), .map = find_map(path)};
  if (out.scans.empty()) {
    out.scans = name_files(list_files(path / "depth" / drive.camera_name, {".png"}));
    out.kind = out.scans.empty() && out.map ? Geometry::map : Geometry::depth;
    if (out.scans.empty() && !out.map) refuse_other_geometry(path);
  }
  if (const std::string others = out.kind == Geometry::scans ? "" : describe_other_scans(path); !others.empty())
    drive.warnings.push_back("lidar/ holds no scans in a supported format (.bin, .ply, .pcd), but " + others);
  if (out.map && out.kind != Geometry::map)
    drive.warnings.push_back(out.map->filename().string() + " is not used, because the map is built from the scans");
  return out;
}

// Reads the given poses and the GPS positions, if there are any.
void read_positions(const fs::path& path, Drive& drive) {
  if (const fs::path poses = path / "poses.txt"; fs::exists(poses)) {
    drive.poses = read_poses(poses, drive);
    drive.other_files.push_back(poses);
  }
  if (const fs::path gps = path / "gps.txt"; fs::exists(gps)) {
    drive.fixes = read_fixes(gps);
    drive.other_files.push_back(gps);
  }
}

DriveContents read_folder(const fs::path& path, const ReadOptions& options) {
  const DriveConfig config = read_config(path);
  DriveContents recording;
  Drive& drive = recording.drive;
  drive.path = path;
  drive.format = "folder";
  drive.other_files.push_back(config.file);
  for (const auto& [name, camera] : config.cameras) {
    if (has_images(path, name)) drive.camera_names.push_back(name);
    warn_of_unread_images(drive, path / "images" / name);
  }
  if (drive.camera_names.empty()) fail_without_cameras(path, config);
  if (const auto others = describe_uncalibrated_cameras(path, config)) drive.warnings.push_back(*others);
  drive.camera_name = choose_camera(drive, options.camera, config.usual_camera);

  const FolderImages images = find_images(path, drive.camera_name);
  const GeometryFiles geometry = find_geometry(path, drive);
  const std::int64_t period = std::llround(1e9 / config.lidar.rate);
  const Clocks clocks = images.video ? read_video_clocks(drive, images, geometry.scans, config.lidar.rate)
                                     : read_clocks(drive, images.files, geometry.scans, config.lidar.rate);
  drive.frames = make_frames(images.files, clocks);
  if (images.video && images.video->rotation_deg() != 0)
    drive.warnings.push_back(media::describe_video_rotation(images.files.front().file, images.video->rotation_deg()));
  if (images.video)
    recording.read_image = [video = images.video](const Frame& frame) {
      return (*video)[static_cast<std::size_t>(frame.number)];
    };
  drive.scan_headers =
      make_scan_headers(geometry.scans, clocks, geometry.kind == Geometry::depth ? 0 : period, config.lidar.stamp);
  set_camera(drive, config, images, geometry.kind);
  if (geometry.kind == Geometry::map) {
    attach_map(drive, *geometry.map);
  } else if (geometry.kind == Geometry::depth) {
    DepthCamera camera;
    config.depth.apply(camera);
    recording.read_scan = attach_depth_camera(drive, camera);
  }
  config.lidar.apply(drive);
  if (geometry.kind == Geometry::scans) attach_scan_files(recording, config.lidar, config.lidar.rotation());
  labels::match_masks(drive, {labels::camera_masks(path, drive.camera_name)});
  read_positions(path, drive);
  recording.gaps = find_gaps(drive, period);
  if (const fs::path boxes = path / "boxes.json"; fs::exists(boxes)) recording.gaps.push_back(labels::add_labels(drive, boxes));
  return recording;
}

bool recognize_folder(const fs::path& path) {
  const bool sensors = fs::is_directory(path / "lidar") || fs::is_directory(path / "depth");
  return fs::is_directory(path / "images") || (sensors && fs::exists(path / "dvi.toml"));
}

}  // namespace

DriveFormat folder_format() {
  return {"folder",
          "dvi.toml and images/CAMERA: the plain layout for your own data (docs/formats.md)",
          recognize_folder,
          read_folder,
          {"dvi.toml", "images", "lidar|depth|map.ply|map.pcd|map.las"}};
}

}  // namespace dvi::datasets
