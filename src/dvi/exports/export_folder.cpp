#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/bags/bag.h"
#include "dvi/core/error.h"
#include "dvi/core/frame_name.h"
#include "dvi/core/path_inside.h"
#include "dvi/core/threads.h"
#include "dvi/exports/exporter.h"
#include "dvi/exports/input_place.h"
#include "dvi/media/remove_points.h"

namespace dvi::exports {
namespace {

// The files of a recording, by their path relative to the folder above all of them.
class RecordingFiles {
 public:
  RecordingFiles(const fs::path& root, const fs::path& out) : root_(root), out_(out) {}

  // Adds a file that the reader uses, also if it is a link. Files outside of the root are counted only.
  void add_used(const fs::path& file) {
    if (file.empty() || !fs::is_regular_file(file)) return;
    const fs::path relative = file.lexically_normal().lexically_relative(root_);
    if (relative.empty() || *relative.begin() == "..")
      outside_.insert(file.string());
    else
      files_.insert(relative);
  }

  // Adds the files below a folder, without links and without results of dvi.
  void add_all(const fs::path& folder) {
    for (auto at = fs::recursive_directory_iterator(folder); at != fs::recursive_directory_iterator(); ++at) {
      if (at->is_symlink()) {
        links_.insert(at->path().lexically_relative(root_));
      } else if (at->is_directory()) {
        if (fs::exists(at->path() / ".dvi") || is_inside(at->path(), out_)) at.disable_recursion_pending();
      } else if (at->is_regular_file()) {
        files_.insert(at->path().lexically_relative(root_));
      }
    }
  }

  // Adds the files in a folder, but not those in its subfolders.
  void add_siblings(const fs::path& folder) {
    if (!fs::is_directory(folder)) return;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) add_used(entry.path());
  }

  std::vector<fs::path> list() const { return {files_.begin(), files_.end()}; }
  std::size_t count_left_out() const {
    const auto is_left_out = [&](const fs::path& link) { return !files_.contains(link) && !contains_files(link); };
    return outside_.size() + static_cast<std::size_t>(std::count_if(links_.begin(), links_.end(), is_left_out));
  }

 private:
  // Returns whether files of a linked folder are used.
  bool contains_files(const fs::path& link) const {
    const auto next = files_.lower_bound(link / "");
    return next != files_.end() && next->string().starts_with(link.string() + "/");
  }

  fs::path root_, out_;
  std::set<fs::path> files_, links_;
  std::set<std::string> outside_;
};

void add_files_of(const Drive& drive, RecordingFiles& files) {
  for (const Frame& frame : drive.frames) files.add_used(frame.file);
  for (const ScanHeader& scan : drive.scan_headers) files.add_used(scan.file);
  for (const fs::path& file : drive.mask_files) files.add_used(file);
  for (const fs::path& file : drive.other_files) files.add_used(file);
  files.add_used(drive.map_file);
  files.add_used(drive.mask_video);
}

// Lists the files of a drive. A scene of nuScenes does not have a folder of its own: its tables are those of all scenes, and
// its loader needs the maps, too.
RecordingFiles list_files_of(const Drive& drive, const RecordedInput& input, const fs::path& out) {
  const fs::path root = datasets::find_data_root(drive);
  RecordingFiles files(root, out);
  add_files_of(drive, files);
  if (fs::is_directory(drive.path)) {
    files.add_all(drive.path);
    return files;
  }
  for (const std::string& camera : drive.camera_names) {
    datasets::ReadOptions read = input.read;
    read.camera = camera;
    add_files_of(datasets::read_drive(drive.path, read), files);
  }
  std::set<fs::path> folders{root / "maps"};
  for (const fs::path& table : drive.other_files) folders.insert(table.parent_path());
  for (const fs::path& folder : folders) files.add_siblings(folder);
  return files;
}

void copy_plain(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::create_directories(to.parent_path(), error);
  if (!error) fs::copy_file(from, to, error);
  if (error) throw InputError(from, fmt::format("cannot be copied ({})", error.message()), "free space or make it readable");
}

// Opens the whole recording of a result once for each of its cameras. Throws InputError if its images are not single files.
std::vector<Drive> open_recording(const Result& result, const RecordedInput& input) {
  if (bags::is_bag(input.path)) throw InputError(input.path, "is a bag", "export it as a bag: dvi export bag");
  std::vector<Drive> out;
  for (const ResultCamera& camera : result.cameras()) {
    datasets::ReadOptions read = input.read;
    read.camera = camera.name;
    out.push_back(datasets::read_drive(input.path, read));
    if (const fs::path& first = out.back().frames.front().file; datasets::holds_many_images(first))
      throw InputError(first, "is a video, whose frames cannot be replaced", "export the result as a video: dvi export video");
  }
  return out;
}

// Returns the file of each frame of a result in its drives, one per camera.
std::vector<fs::path> find_frame_files(const Result& result, const std::vector<Drive>& drives, const fs::path& root) {
  std::vector<std::map<std::string, fs::path>> by_name(drives.size());
  for (std::size_t k = 0; k < drives.size(); ++k)
    for (const Frame& frame : drives[k].frames) by_name[k][frame.name] = frame.file;
  std::vector<fs::path> out;
  for (const ResultFrame& frame : result.frames()) {
    const auto file = by_name[frame.camera].find(image_of_frame(frame.name));
    if (file == by_name[frame.camera].end())
      throw InputError(drives.front().path,
                       fmt::format("has no image {} of {}, which the run cleaned", image_of_frame(frame.name),
                                   drives[frame.camera].camera_name),
                       kSameRecording);
    out.push_back(file->second.lexically_normal());
    if (*out.back().lexically_relative(root).begin() == "..")
      throw InputError(out.back(), fmt::format("is outside of {}", root.string()), "move it into the recording");
  }
  return out;
}

void require_scans(const Drive& drive) {
  if (drive.sensor == Sensor::depth_camera || drive.scan_headers.empty())
    throw InputError(drive.path, "has no scans from which points can be removed", "export without --points");
}

// The scan files of a recording and the labels of their points, without the returns of removed objects.
class CleanScans {
 public:
  // Throws InputError if a scan does not exist.
  CleanScans(const Drive& drive, LabeledScans scans) : scans_(std::move(scans)) {
    std::map<std::string, fs::path> by_name;
    for (const ScanHeader& header : drive.scan_headers) by_name[header.name] = header.file.lexically_normal();
    for (const std::string& name : scans_.names) {
      const auto file = by_name.find(name);
      if (file == by_name.end())
        throw InputError(drive.path, fmt::format("has no scan {}, which the run read", name), kSameRecording);
      by_file_[file->second] = by_name_.size();
      by_name_.emplace(name, by_name_.size());
    }
  }

  std::size_t size() const { return by_file_.size(); }

  // Returns the scan of a file: that of its points, or that of their labels, NAME.label.
  std::optional<std::size_t> find(const fs::path& file) const {
    const auto find_in = [](const auto& numbers, const auto& key) {
      const auto number = numbers.find(key);
      return number == numbers.end() ? std::nullopt : std::optional(number->second);
    };
    return is_label(file) ? find_in(by_name_, file.stem().string()) : find_in(by_file_, file);
  }

  // Writes a file of find() without the removed points, and returns their number, which is 0 for a file of labels.
  std::size_t write(std::size_t scan, const fs::path& from, const fs::path& to) const {
    const std::vector<bool> removed = find_removed_points(scans_, scan);
    make_folder(to.parent_path());
    write_file(to, media::remove_points(from, read_file(from), removed));
    return is_label(from) ? 0 : static_cast<std::size_t>(std::count(removed.begin(), removed.end(), true));
  }

 private:
  static bool is_label(const fs::path& file) { return file.extension() == ".label"; }

  LabeledScans scans_;
  std::map<fs::path, std::size_t> by_file_;     // numbers of the scans
  std::map<std::string, std::size_t> by_name_;  // the same
};

// Writes the clean image of a frame, and returns whether it differs from the recorded one.
bool write_frame(const media::ImageEdit& edit, const fs::path& from, const fs::path& to, int jpeg_quality) {
  const std::string recorded = read_file(from);
  const std::optional<std::string> clean = media::edit_image_file(from, recorded, edit, jpeg_quality);
  if (!clean) throw InputError(from, "is not the image that the run cleaned", kSameRecording);
  make_folder(to.parent_path());
  write_file(to, *clean);
  return *clean != recorded;
}

ExportReport write_folder(const Result& result, const fs::path& folder, const ExportOptions& options, Progress& progress) {
  const RecordedInput input = find_input(result, options);
  const std::vector<Drive> drives = open_recording(result, input);
  const Drive& drive = drives.front();
  const fs::path root = datasets::find_data_root(drive);
  const std::vector<fs::path> frames = find_frame_files(result, drives, root);
  const RecordingFiles files = list_files_of(drive, input, result.folder());
  if (options.points) require_scans(drive);
  const CleanScans scans(drive, options.points ? result.label_scans(progress) : LabeledScans{});
  if (options.points) progress.begin("export folder", frames.size());
  std::vector<fs::path> others;
  const std::set<fs::path> replaced(frames.begin(), frames.end());
  for (const fs::path& file : files.list())
    if (!replaced.contains(root / file)) others.push_back(file);

  std::vector<char> changed(frames.size(), 0);
  parallel_for(frames.size(), [&](std::size_t i) {
    changed[i] = write_frame(result.edit(i), frames[i], folder / frames[i].lexically_relative(root), options.quality) ? 1 : 0;
    progress.advance();
  });
  progress.begin("copy", others.size());
  std::vector<std::size_t> removed_points(others.size(), 0);
  parallel_for(others.size(), [&](std::size_t i) {
    const fs::path from = root / others[i], to = folder / others[i];
    if (const std::optional<std::size_t> scan = scans.find(from))
      removed_points[i] = scans.write(*scan, from, to);
    else
      copy_plain(from, to);
    progress.advance();
  });
  std::vector<RecordedPart> recorded;
  std::vector<std::string> other_cameras = drive.camera_names;
  for (std::size_t k = 0; k < drives.size(); ++k) {
    recorded.push_back({drives[k].camera_name, drives[k].frames.size(), result.count_frames(k)});
    std::erase(other_cameras, drives[k].camera_name);
  }
  const std::size_t unchanged = warn_of_traffic(recorded, other_cameras, progress);
  if (const std::size_t left_out = files.count_left_out(); left_out > 0)
    progress.warn(fmt::format("{} links and files outside of {} are not copied", left_out, root.string()));
  const fs::path relative = drive.path.lexically_relative(root);
  ExportReport report{relative == "." ? std::vector<std::string>{} : std::vector<std::string>{relative.string()},
                      {{"cleaned images", static_cast<double>(frames.size())},
                       {"of them changed", static_cast<double>(std::count(changed.begin(), changed.end(), 1))},
                       {"other images of the cameras", static_cast<double>(unchanged)},
                       {"other files", static_cast<double>(others.size())}}};
  if (!options.points) return report;
  warn_of_returns({"the LiDAR", drive.scan_headers.size(), scans.size()}, {}, progress);
  report.counts.emplace_back("cleaned scans", static_cast<double>(scans.size()));
  report.counts.emplace_back("removed points", std::accumulate(removed_points.begin(), removed_points.end(), 0.0));
  return report;
}

bool is_recording_file(const Result& result, const ExportOptions& options, const fs::path& place) {
  require_outside(place, find_input(result, options).path);
  return false;
}

}  // namespace

ExportFormat folder_format() {
  return {"folder",
          "the recording in its own layout and file formats (KITTI, nuScenes, and others) with clean images",
          write_folder,
          is_recording_file,
          {"export.quality", "export.input", "export.points"}};
}

}  // namespace dvi::exports
