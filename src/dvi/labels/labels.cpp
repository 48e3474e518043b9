#include "dvi/labels/labels.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/core/text_file.h"
#include "dvi/labels/image_names.h"
#include "dvi/labels/label_folder.h"
#include "dvi/labels/mask_folder.h"
#include "dvi/media/video_reader.h"

namespace dvi::labels {
namespace {

// The rectangles and outlines of KITTI are in images of image_02.
bool is_kitti_label_camera(const Drive& drive) { return drive.format != "kitti-raw" || drive.camera_name == "image_02"; }

LabelsByNumber read_drive_mots(const fs::path& file, const Drive& drive) {
  if (!is_kitti_label_camera(drive))
    throw InputError(file, "holds outlines for image_02, not for " + drive.camera_name,
                     "use --camera image_02, or labels with boxes");
  return read_mots(file, {drive.camera.width, drive.camera.height});
}

LabelsByNumber read_drive_tracking(const fs::path& file, const Drive& drive) {
  LabelsByNumber labels = read_kitti_tracking(file, drive.box_camera_from_lidar.value_or(drive.camera_from_lidar).inverse());
  if (!is_kitti_label_camera(drive))
    for (auto& [number, frame] : labels)
      for (Label& label : frame) label.rect.reset();
  return labels;
}

// Returns the frame numbers of the whole recording, of which the drive may be an excerpt.
std::set<int> list_recorded_numbers(const Drive& drive) {
  std::set<int> numbers;
  for (const Frame& frame : drive.frames) numbers.insert(frame.number);
  const fs::path stamps = drive.path / drive.camera_name / "timestamps.txt";
  if (drive.format == "kitti-raw" && fs::exists(stamps)) {
    const int lines = static_cast<int>(read_lines(stamps).size());
    for (int number = 0; number < lines; ++number) numbers.insert(numbers.end(), number);
    return numbers;
  }
  for (int index = 0; const std::string& name : list_recorded_names(drive)) {
    const auto number = is_all_digits(name) ? to_integer(name) : std::nullopt;
    numbers.insert(number.value_or(index++));
  }
  return numbers;
}

std::string to_text(const std::string& name) { return name; }
std::string to_text(int number) { return std::to_string(number); }

std::string describe_span(const std::set<std::string>& names) { return span_of(names); }
std::string describe_span(const std::set<int>& numbers) {
  if (numbers.empty()) return "none";
  return numbers.size() == 1 ? to_text(*numbers.begin()) : fmt::format("{} to {}", *numbers.begin(), *numbers.rbegin());
}

/// Labels of frames that the recording does not have, described for a warning.
struct UnknownFrames {
  std::vector<std::string> warnings;
  bool all = false;  ///< whether there are no other labels
};

template <class Labels, class Frames>
UnknownFrames find_strays(const fs::path& file, const Labels& labels, const Frames& recorded) {
  Frames missing;
  bool others = false;
  for (const auto& [frame, list] : labels) {
    if (list.empty()) continue;
    others |= recorded.contains(frame);
    if (!recorded.contains(frame)) missing.insert(frame);
  }
  if (missing.empty()) return {};
  return {.warnings = {fmt::format(
              "{} labels {} frames that the drive does not have, first {}: its frames are {}, those of the drive are {}",
              file.filename().string(), missing.size(), to_text(*missing.begin()), describe_span(missing),
              describe_span(recorded))},
          .all = !others};
}

template <class Labels, class Id>
FileLabels to_frames(const fs::path& file, Labels labels, const Drive& drive, Id Frame::* id) {
  FileLabels out;
  out.frames.resize(drive.frames.size());
  std::size_t known = 0;  // the number of frames up to the last one in the file
  for (std::size_t i = 0; i < drive.frames.size(); ++i)
    if (const auto found = labels.find(drive.frames[i].*id); found != labels.end())
      out.frames[i] = std::move(found->second), known = i + 1;
  if (labels.empty() || 20 * (drive.frames.size() - known) <= drive.frames.size()) return out;
  out.frames_after_last.what = fmt::format("{} ends early: it has no labels for frames", file.filename().string());
  for (std::size_t i = known; i < drive.frames.size(); ++i) out.frames_after_last.frames.push_back(drive.frames[i].number);
  return out;
}

/// The identification of frames by their numbers or their names.
template <class Id>
struct FrameIds {
  std::set<Id> recorded;  ///< of the whole recording
  Id Frame::* of_frame;
};

template <class Labels, class Id>
FileLabels match_frames(const fs::path& file, Labels labels, const Drive& drive, FrameIds<Id> ids) {
  for (const Frame& frame : drive.frames) ids.recorded.insert(frame.*ids.of_frame);
  UnknownFrames strays = find_strays(file, labels, ids.recorded);
  FileLabels out = to_frames(file, std::move(labels), drive, ids.of_frame);
  out.warnings = std::move(strays.warnings);
  out.has_only_unknown_frames = strays.all;
  return out;
}

FileLabels to_frames_by_number(const fs::path& file, LabelsByNumber labels, const Drive& drive) {
  return match_frames(file, std::move(labels), drive, FrameIds<int>{list_recorded_numbers(drive), &Frame::number});
}

// Warns of frames that a file with a list of its images does not list. Those after the last one are reported separately.
void warn_of_unlisted(const fs::path& file, const std::set<std::string>& listed, const Drive& drive, FileLabels& labels) {
  std::vector<int> unlisted;
  for (const Frame& frame : drive.frames)
    if (!listed.contains(frame.name)) unlisted.push_back(frame.number);
  const std::size_t after = labels.frames_after_last.frames.size();
  if (listed.empty() || unlisted.size() <= after) return;
  unlisted.resize(unlisted.size() - after);
  labels.warnings.push_back(fmt::format("{} has no labels for {} of {} frames, in which nothing is removed: {}",
                                        file.filename().string(), unlisted.size(), drive.frames.size(),
                                        format_ranges(unlisted)));
}

FileLabels to_frames_by_name(const fs::path& file, NamedLabels labels, const Drive& drive) {
  std::set<std::string> listed;
  for (const auto& [name, list] : labels.frames) listed.insert(name);
  FileLabels out =
      match_frames(file, std::move(labels.frames), drive, FrameIds<std::string>{list_recorded_names(drive), &Frame::name});
  out.warnings.insert(out.warnings.end(), labels.warnings.begin(), labels.warnings.end());
  warn_of_unlisted(file, listed, drive, out);
  return out;
}

FileLabels read_drive_boxes(const fs::path& file, const Drive& drive) {
  BoxesFile boxes = read_boxes_json(file);
  const cv::Size size(drive.camera.width, drive.camera.height);
  for (auto& [name, labels] : boxes.frames)
    for (Label& label : labels) {
      if (boxes.camera != drive.camera_name) {
        label.rect.reset();
        label.instance.reset();
      } else if (label.instance && label.instance->size != size) {
        throw InputError(
            file, fmt::format("frame {}: an outline is of an image of {}x{} pixels, but the drive's images are {}x{}", name,
                              label.instance->size.width, label.instance->size.height, size.width, size.height));
      }
    }
  FileLabels read = to_frames_by_name(file, {std::move(boxes.frames), {}}, drive);
  read.all_around = boxes.camera.empty();
  return read;
}

FileLabels read_drive_panoptic(const fs::path& file, const Drive& drive) {
  PanopticLabels panoptic = read_panoptic(file, drive);
  FileLabels read = to_frames_by_name(file, std::move(panoptic.labels), drive);
  read.files = std::move(panoptic.images);
  return read;
}

FileLabels read_one_labelme(const fs::path& file, const Drive& drive) {
  FileLabels read = to_frames_by_name(file, read_labelme(file, {file}, drive), drive);
  if (const std::size_t files = list_files(file.parent_path(), {".json"}).size(); files > 1)
    read.warnings.push_back(fmt::format("LabelMe writes one file per image; give the folder of {} to read all {} files",
                                        file.filename().string(), files));
  return read;
}

FileLabels read_label_folder(const fs::path& given, const Drive& drive) {
  const auto found = find_label_folder(given, drive.camera_name);
  if (!found) throw InputError(given, "has no label files in a supported format", "see docs/masks.md for the formats");
  const LabelFolder& labels = found->labels;
  FileLabels read = to_frames_by_name(labels.folder, found->format->read(labels, drive), drive);
  read.files = labels.files;
  read.files.insert(read.files.end(), labels.shared.begin(), labels.shared.end());
  return read;
}

bool contains(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }

// Returns the words of a line that begins with two numbers, frame and track.
std::vector<std::string> split_numbered_line(std::string_view text) {
  std::vector<std::string> words = split_words(text.substr(0, text.find('\n')));
  const bool numbered = words.size() >= 6 && to_integer(words[0]) && to_integer(words[1]);
  return numbered ? std::move(words) : std::vector<std::string>();
}

bool is_tracking(std::string_view text) {
  const std::vector<std::string> words = split_numbered_line(text);
  return (words.size() == 17 || words.size() == 18) && !to_number(words[2]);
}

bool is_mots(std::string_view text) {
  const std::vector<std::string> words = split_numbered_line(text);
  return words.size() == 6 && to_integer(words[2]) && to_integer(words[3]);
}

bool is_panoptic(std::string_view text) { return text.starts_with('{') && contains(text, "\"segments_info\""); }

bool is_coco(std::string_view text) {
  return text.starts_with('{') && contains(text, "\"annotations\"") && contains(text, "\"images\"");
}

}  // namespace

const std::vector<LabelFormat>& label_formats() {
  using Path = const fs::path&;
  static const std::vector<LabelFormat> formats = {
      {"KITTI's tracklet_labels.xml", [](std::string_view t) { return t.starts_with('<') && contains(t, "<tracklets"); },
       [](Path file, const Drive& drive) { return to_frames_by_number(file, read_tracklets(file), drive); }},
      {"KITTI tracking labels", is_tracking,
       [](Path file, const Drive& drive) { return to_frames_by_number(file, read_drive_tracking(file, drive), drive); }},
      {"MOTS instances_txt", is_mots,
       [](Path file, const Drive& drive) { return to_frames_by_number(file, read_drive_mots(file, drive), drive); }},
      {"COCO panoptic JSON", is_panoptic, read_drive_panoptic},
      {"COCO JSON", is_coco,
       [](Path file, const Drive& drive) { return to_frames_by_name(file, read_coco(file, drive), drive); }},
      {"CVAT XML (for video or for images)",
       [](std::string_view t) { return t.starts_with('<') && contains(t, "<annotations"); },
       [](Path file, const Drive& drive) { return to_frames_by_name(file, read_cvat(file, drive), drive); }},
      {"LabelMe JSON", is_labelme, read_one_labelme},
      {"boxes.json", [](std::string_view t) { return t.starts_with('{') && contains(t, "\"frames\""); },
       [](Path file, const Drive& drive) { return read_drive_boxes(file, drive); }},
  };
  return formats;
}

std::string_view label_text(std::string_view all) {
  return all.substr(std::min(all.find_first_not_of(" \t\r\n\xEF\xBB\xBF"), all.size()));
}

bool is_labelme(std::string_view text) {
  return text.starts_with('{') && contains(text, "\"shapes\"") &&
         (contains(text, "\"imagePath\"") || contains(text, "\"shape_type\""));
}

bool holds_labels(const fs::path& path, const std::string& camera) {
  return fs::is_directory(path) ? find_label_folder(path, camera).has_value() : !media::is_video(path);
}

FileLabels read_labels(const fs::path& file, const Drive& drive) {
  if (fs::is_directory(file)) return read_label_folder(file, drive);
  const std::string all = read_text(file);
  const std::string_view text = label_text(all);
  if (text.empty()) throw InputError(file, "is empty", "give a file with labels, or a folder of masks");
  refuse_unread_labels(file);
  std::vector<std::string> known;
  for (const LabelFormat& format : label_formats()) {
    if (format.recognize(text)) {
      FileLabels read = format.read(file, drive);
      read.files.push_back(file);
      return read;
    }
    known.push_back(format.name);
  }
  throw InputError(file, "holds no labels in a supported format",
                   fmt::format("supported formats are {}", fmt::join(known, ", ")));
}

Gap add_labels(Drive& drive, const fs::path& file) {
  FileLabels read = read_labels(file, drive);
  FrameLabels& added = read.frames;
  for (std::size_t i = 0; i < added.size(); ++i)
    for (Label& label : added[i]) {
      std::vector<Label>& labels = drive.frames[i].labels;
      const auto same = std::find_if(labels.begin(), labels.end(), [&](const Label& other) {
        return label.instance && !label.box && !other.instance && other.track == label.track;
      });
      if (same != labels.end())
        same->instance = std::move(label.instance);
      else
        labels.push_back(std::move(label));
    }
  drive.warnings.insert(drive.warnings.end(), read.warnings.begin(), read.warnings.end());
  drive.labeled_around = read.all_around && (drive.labeled_around || !drive.labeled);
  drive.labeled = true;
  drive.other_files.push_back(file);
  return std::move(read.frames_after_last);
}

}  // namespace dvi::labels
