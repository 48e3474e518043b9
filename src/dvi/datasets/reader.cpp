#include "dvi/datasets/reader.h"

#include <algorithm>

#include "dvi/bags/bag.h"
#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/datasets/colmap_model.h"
#include "dvi/datasets/compare_times.h"
#include "dvi/datasets/file_names.h"
#include "dvi/datasets/pose_jumps.h"
#include "dvi/geometry/plausible.h"
#include "dvi/labels/mask_folder.h"
#include "dvi/media/image_file.h"
#include "dvi/media/image_storage.h"
#include "dvi/media/point_cloud.h"
#include "dvi/media/video_reader.h"

namespace dvi::datasets {
namespace {

// Whether a folder is the output of a run, which has a dvi.toml like a drive.
bool is_result(const fs::path& path) { return fs::is_directory(path / ".dvi") && !fs::exists(path / "images"); }

const DriveFormat* find_format(const fs::path& path) {
  if (is_result(path)) return nullptr;
  for (const DriveFormat& format : drive_formats())
    if (format.recognize(path)) return &format;
  return nullptr;
}

// Finds the first drive below a folder, in order to suggest it.
std::optional<fs::path> find_drive_below(const fs::path& path, int levels) {
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(path, fs::directory_options::skip_permission_denied))
    if (entry.is_directory()) folders.push_back(entry.path());
  std::sort(folders.begin(), folders.end());
  for (const fs::path& folder : folders) {
    if (find_format(folder)) return folder;
    if (levels > 1)
      if (const auto found = find_drive_below(folder, levels - 1)) return found;
  }
  return std::nullopt;
}

bool has_part(const fs::path& folder, std::string_view part) {
  for (; !part.empty(); part.remove_prefix(std::min(part.size(), std::min(part.find('|'), part.size()) + 1)))
    if (fs::exists(folder / part.substr(0, part.find('|')))) return true;
  return false;
}

// Describes the format of which a folder has the most parts, and the parts that are missing. Returns nothing if the folder has
// no part of any format.
std::optional<std::string> describe_nearest_format(const fs::path& folder) {
  const DriveFormat* nearest = nullptr;
  double most = 0;
  std::string lacks;
  for (const DriveFormat& format : drive_formats()) {
    std::string missing;
    std::size_t present = 0;
    for (const std::string& part : format.parts) {
      if (has_part(folder, part))
        ++present;
      else
        missing += (missing.empty() ? "" : ", ") + part.substr(0, part.find('|'));
    }
    const double share = format.parts.empty() ? 0 : static_cast<double>(present) / static_cast<double>(format.parts.size());
    if (share > most) nearest = &format, most = share, lacks = missing;
  }
  if (nearest == nullptr) return std::nullopt;
  return "it is most similar to " + nearest->name + (lacks.empty() ? "" : ", but lacks " + lacks) +
         (nearest->name == folder_format().name ? "; dvi init " + folder.string() + " prepares images and scans of your own"
                                                : "");
}

[[noreturn]] void fail_unknown(const fs::path& path) {
  if (!fs::exists(path)) throw InputError(path, "does not exist", "check the path of the drive");
  if (!fs::is_directory(path))
    throw InputError(path, "is not a recording", "give the folder of a drive, or a bag: .mcap, .db3, .bag");
  if (is_result(path))
    throw InputError(path, "is a result of dvi, not a drive",
                     "give the drive that it was made from: target of [job] in its dvi.toml");
  if (const fs::path model = find_colmap_model(path); !model.empty() && !fs::is_directory(path / "images"))
    throw InputError(path, "holds a COLMAP model, but no folder images/",
                     "put its images into images/ and the model into sparse/0");
  if (const auto below = find_drive_below(path, 2))
    throw InputError(path, "is not a drive", "did you mean " + below->string() + "?");
  if (const auto nearest = describe_nearest_format(path))
    throw InputError(path, "is not a drive in a supported format", *nearest);
  if (!list_files(path, kImageEndings).empty())
    throw InputError(
        path, "holds images, but is not a drive",
        "move them into images/CAMERA, such as images/front, and dvi init " + path.string() + " prepares the other files");
  std::string known;
  for (const DriveFormat& format : drive_formats()) known += "\n  " + format.name + ": " + format.summary;
  throw InputError(path, fs::is_empty(path) ? "is empty" : "is not a drive in a supported format",
                   "supported formats are:" + known);
}

void require_consistent(const Drive& drive) {
  if (drive.frames.empty()) throw InputError(drive.path, "holds no images of camera " + drive.camera_name);
  for (std::size_t i = 1; i < drive.frames.size(); ++i)
    if (drive.frames[i].time_ns <= drive.frames[i - 1].time_ns)
      throw InputError(drive.frames[i].file, "has a time that is not after that of " + drive.frames[i - 1].name,
                       "correct the times");
  require_near(drive.camera_from_lidar.t, drive.path, "its camera");
  for (const StampedPose& pose : drive.poses.poses()) require_near(pose.world_from_body.t, drive.path, "a given pose");
}

void require_plain_names(const Drive& drive) {
  require_plain_name(drive.camera_name, drive.path, "a camera");
  for (const Frame& frame : drive.frames) require_plain_name(frame.name, frame.file, "an image");
  for (const ScanHeader& header : drive.scan_headers) require_plain_name(header.name, header.file, "a scan");
}

// Keeps the frames that are `wanted` and the scans near them.
void keep_frames(Drive& drive, const std::function<bool(const Frame&)>& wanted) {
  constexpr std::int64_t kClockMarginNs = 10'000'000;  // keeps the scan during which a frame was taken
  std::vector<Frame> frames;
  std::vector<fs::path> masks;
  for (std::size_t i = 0; i < drive.frames.size(); ++i) {
    if (!wanted(drive.frames[i])) continue;
    frames.push_back(std::move(drive.frames[i]));
    if (!drive.mask_files.empty()) masks.push_back(std::move(drive.mask_files[i]));
  }
  drive.frames = std::move(frames);
  drive.mask_files = std::move(masks);
  if (drive.frames.empty()) return;
  const std::int64_t begin = drive.frames.front().time_ns - kClockMarginNs, end = drive.frames.back().time_ns + kClockMarginNs;
  std::erase_if(drive.scan_headers, [&](const ScanHeader& header) { return header.end_ns < begin || header.start_ns > end; });
}

void cut_drive(Drive& drive, const FrameRange& range) {
  const int first = drive.frames.front().number, last = drive.frames.back().number;
  if (range.first > range.last || range.first < first || range.last > last)
    throw InputError(drive.path, "frames " + std::to_string(range.first) + ":" + std::to_string(range.last) + " do not exist",
                     "it has frames " + std::to_string(first) + ":" + std::to_string(last));
  keep_frames(drive, [&](const Frame& frame) { return range.contains(frame.number); });
  if (drive.frames.empty())
    throw InputError(drive.path, "has no images for frames " + std::to_string(range.first) + ":" + std::to_string(range.last));
}

void cut_drive(Drive& drive, const TimeSpan& span) {
  keep_frames(drive, [&](const Frame& frame) { return frame.time_ns >= span.first && frame.time_ns <= span.last; });
  if (drive.frames.empty()) throw InputError(drive.path, "camera " + drive.camera_name + " took no image during these frames");
}

void warn_of_gaps(Drive& drive, const std::vector<Gap>& gaps) {
  const int first = drive.frames.front().number, last = drive.frames.back().number;
  for (const Gap& gap : gaps) {
    std::vector<int> frames = gap.frames;
    std::erase_if(frames, [&](int number) { return number < first || number > last; });
    if (!frames.empty()) drive.warnings.push_back(gap.what + " " + format_ranges(frames));
  }
  if (const auto unposed = describe_unposed(drive)) drive.warnings.push_back(*unposed);
}

void attach_lazy_readers(DriveContents& recording) {
  Drive& drive = recording.drive;
  const cv::Size size(drive.camera.width, drive.camera.height);

  if (recording.read_image) {
    drive.images = Lazy<cv::Mat3b>(
        drive.frames.size(), [frames = drive.frames, read = recording.read_image](std::size_t i) { return read(frames[i]); });
  } else {
    std::vector<fs::path> images;
    for (const Frame& frame : drive.frames) images.push_back(frame.file);
    drive.images = Lazy<cv::Mat3b>(images.size(), [images, size, bits = recording.value_bits](std::size_t i) {
      return media::read_scaled_image(images[i], size, bits);
    });
  }
  if (!drive.mask_files.empty()) labels::attach_mask_files(drive);
  drive.scans = Lazy<Scan>(drive.scan_headers.size(), [scan_headers = drive.scan_headers, read = recording.read_scan](
                                                          std::size_t i) { return read(scan_headers[i]); });
}

}  // namespace

const std::vector<DriveFormat>& drive_formats() {
  // Formats that are recognized by a name alone come after those that are recognized by their files.
  static const std::vector<DriveFormat> formats = {
      kitti_360_format(), kitti_raw_format(),   kitti_odometry_format(), nuscenes_format(),
      rosbag_format(),    apolloscape_format(), seven_scenes_format(),   tum_rgbd_format(),
      scannet_format(),   colmap_format(),      folder_format(),
  };
  return formats;
}

bool holds_many_images(const fs::path& file) { return bags::is_bag(file) || media::is_video(file); }

fs::path find_data_root(const Drive& drive) {
  fs::path root = fs::is_directory(drive.path) ? drive.path : drive.path.parent_path();  // a scene of nuScenes is not a folder
  for (const DriveFormat& format : drive_formats())
    if (format.name == drive.format)
      for (int level = 0; level < format.levels_to_root; ++level) root = root.parent_path();
  return root;
}

bool can_list_numbers(Drive& drive, int step) {
  const std::vector<Frame>& frames = drive.frames;
  const auto distance = [](const Frame& a, const Frame& b) { return std::int64_t{b.number} - a.number; };
  if (frames.empty() || distance(frames.front(), frames.back()) / step <= 10 * static_cast<std::int64_t>(frames.size()))
    return true;
  std::size_t jump = 1;
  for (std::size_t i = 2; i < frames.size(); ++i)
    if (distance(frames[i - 1], frames[i]) > distance(frames[jump - 1], frames[jump])) jump = i;
  drive.warnings.push_back("frame numbers jump from " + frames[jump - 1].name + " to " + frames[jump].name +
                           ": an image may have a wrong name; gaps are not listed");
  return false;
}

Drive read_drive(const fs::path& path, const ReadOptions& options) {
  if (path.empty()) throw InputError("the path of the drive is empty; give the folder of a drive");
  fs::path root = fs::absolute(path).lexically_normal();
  if (!root.has_filename()) root = root.parent_path();
  const DriveFormat* format = find_format(root);
  if (!format) fail_unknown(root);
  DriveContents recording = format->read(root, options);
  if (!recording.read_image) {
    recording.value_bits = media::find_value_bits(recording.drive);
    media::warn_of_image_orientation(recording.drive);
  }
  Drive& drive = recording.drive;
  drive.path = root;
  drive.format = format->name;
  leave_out_pose_jumps(drive);
  require_consistent(drive);
  require_plain_names(drive);
  compare_times(drive);
  if (options.frames) cut_drive(drive, *options.frames);
  if (options.span) cut_drive(drive, *options.span);
  if (recording.inspect_scans) recording.inspect_scans(recording);
  for (const ScanHeader& header : drive.scan_headers) media::check_size(header.file, recording.point_bytes);
  warn_of_gaps(drive, recording.gaps);
  attach_lazy_readers(recording);
  return std::move(drive);
}

}  // namespace dvi::datasets
