#include "dvi/io/labels.h"

#include "dvi/core/error.h"
#include "dvi/io/kitti_calibration.h"
#include "dvi/io/text.h"

namespace dvi::io {
namespace {

enum class Kind { tracklets, tracking, mots, boxes, unknown };

Kind kind_of(const fs::path& file) {
  const std::string text = read_file(file);
  const std::size_t begin = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (begin == std::string::npos) return Kind::unknown;
  if (text[begin] == '<') return text.find("<tracklets", begin) != std::string::npos ? Kind::tracklets : Kind::unknown;
  if (text[begin] == '{') return Kind::boxes;
  const std::vector<std::string> words = split_words(std::string_view(text).substr(begin, text.find('\n', begin) - begin));
  const bool numbered = words.size() >= 6 && to_integer(words[0]) && to_integer(words[1]);
  if (numbered && words.size() == 6 && to_integer(words[2]) && to_integer(words[3])) return Kind::mots;
  if (numbered && (words.size() == 17 || words.size() == 18) && !to_number(words[2])) return Kind::tracking;
  return Kind::unknown;
}

// KITTI's boxes stand in the axes of the rectified camera 0; of another drive only its own camera is known.
SE3 lidar_from_label_camera(const Drive& drive) {
  if (drive.format != "kitti-raw") return drive.camera_from_lidar.inverse();
  return read_kitti_calibration(drive.path.parent_path(), drive.camera_name).rect0_from_lidar.inverse();
}

// KITTI's rectangles and outlines are drawn in image_02.
bool of_this_camera(const Drive& drive) { return drive.format != "kitti-raw" || drive.camera_name == "image_02"; }

LabelsByNumber read_numbered(Kind kind, const fs::path& file, const Drive& drive) {
  if (kind == Kind::tracklets) return read_tracklets(file);
  if (kind == Kind::mots) {
    if (!of_this_camera(drive))
      throw InputError(file, "holds outlines in image_02, not in " + drive.camera_name, "use --camera image_02 or boxes");
    return read_mots(file, {drive.camera.width, drive.camera.height});
  }
  LabelsByNumber labels = read_kitti_tracking(file, lidar_from_label_camera(drive));
  if (!of_this_camera(drive))
    for (auto& [number, frame] : labels)
      for (Label& label : frame) label.rect.reset();
  return labels;
}

}  // namespace

std::vector<std::vector<Label>> read_labels(const fs::path& file, const Drive& drive) {
  const Kind kind = kind_of(file);
  if (kind == Kind::unknown)
    throw InputError(file, "holds no labels that dvi knows",
                     "it reads tracklet_labels.xml, KITTI tracking labels, MOTS instances_txt and boxes.json");
  std::vector<std::vector<Label>> out(drive.frames.size());
  const auto hand_out = [&](auto labels, const auto& key) {
    for (std::size_t i = 0; i < out.size(); ++i)
      if (const auto found = labels.find(key(drive.frames[i])); found != labels.end()) out[i] = std::move(found->second);
  };
  if (kind == Kind::boxes)
    hand_out(read_boxes_json(file), [](const Frame& frame) { return frame.name; });
  else
    hand_out(read_numbered(kind, file, drive), [](const Frame& frame) { return frame.number; });
  return out;
}

void add_labels(Drive& drive, const fs::path& file) {
  std::vector<std::vector<Label>> added = read_labels(file, drive);
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
  drive.labelled = true;
  drive.other_files.push_back(file);
}

}  // namespace dvi::io
