#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/labels/label_folder.h"
#include "dvi/labels/labels.h"

namespace dvi::labels {
namespace {

using Text = std::string_view;

bool contains(Text text, Text part) { return text.find(part) != Text::npos; }

bool has_all(Text text, std::initializer_list<Text> parts) {
  return std::all_of(parts.begin(), parts.end(), [&](Text part) { return contains(text, part); });
}

Text get_first_line(Text text) { return text.substr(0, text.find_first_of("\r\n")); }

// Lines are frame,track,x,y,width,height,...
bool is_mot(Text text) {
  const Text line = get_first_line(text);
  if (std::count(line.begin(), line.end(), ',') < 5) return false;
  return std::all_of(line.begin(), line.end(),
                     [](char c) { return (c >= '0' && c <= '9') || contains(",.-+eE ", Text(&c, 1)); });
}

// Lines have class, truncation, occlusion, alpha, and box: 15 words, or 16 with a score. The first word is not a number.
bool is_kitti_object(Text text) {
  const std::vector<std::string> words = split_words(get_first_line(text));
  if (words.size() < 14 || words.size() > 16 || to_number(words[0])) return false;
  return std::all_of(words.begin() + 1, words.end(), [](const std::string& word) { return to_number(word).has_value(); });
}

struct UnreadFormat {
  Text name;
  bool (*recognize)(Text text);
  Text remedy;
};

constexpr Text kConvertToCoco =
    "convert it to COCO JSON (CVAT, Roboflow, and datumaro do), or draw it as PNG files, one per image";

constexpr auto kUnreadFormats = std::to_array<UnreadFormat>({
    {"NumPy archives", [](Text t) { return t.starts_with("PK") && contains(t, ".npy"); },
     "write each mask as a separate file, named like its image: np.save(NAME + '.npy', mask.astype('uint16'))"},
    {"a single NumPy array", [](Text t) { return t.starts_with("\x93NUMPY"); },
     "give the folder of the arrays, one per image, named like its image"},
    {"files in a ZIP archive", [](Text t) { return t.starts_with("PK\x03\x04"); },
     "unpack it, and give the file or folder in it"},
    {"YOLO labels of one image", [](Text t) { return is_yolo(t, true); }, "give the folder of the label files"},
    {"MOT labels", is_mot, kConvertToCoco},
    {"KITTI object labels, one text file per image", is_kitti_object,
     "give the tracking labels of the sequence (one file whose lines begin with frame and track), or COCO JSON"},
    {"Pascal VOC XML, one file per image", [](Text t) { return contains(t, "<annotation") && contains(t, "<bndbox"); },
     kConvertToCoco},
    {"COCO captions", [](Text t) { return has_all(t, {"\"annotations\"", "\"caption\""}) && !contains(t, "\"bbox\""); },
     "give the file of instances"},
    {"COCO results without the list of images",
     [](Text t) { return t.starts_with('[') && has_all(t, {"\"image_id\"", "\"category_id\""}); },
     "add them as \"annotations\" to the file that has \"images\" and \"categories\""},
    {"Label Studio JSON", [](Text t) { return t.starts_with('[') && has_all(t, {"\"annotations\"", "\"data\""}); },
     "export it as COCO"},
    {"BDD100K labels", [](Text t) { return t.starts_with('[') && has_all(t, {"\"labels\"", "\"category\""}); }, kConvertToCoco},
    {"Cityscapes polygons, one JSON file per image",
     [](Text t) { return has_all(t, {"\"imgHeight\"", "\"objects\"", "\"polygon\""}); },
     "give the folder of labelIds or instanceIds PNG files with --classes car,truck,person"},
    {"VGG Image Annotator JSON", [](Text t) { return has_all(t, {"\"shape_attributes\"", "\"regions\""}); },
     "export it as COCO"},
});

const UnreadFormat* find_unread_format(Text text) {
  const auto found = std::find_if(kUnreadFormats.begin(), kUnreadFormats.end(),
                                  [&](const UnreadFormat& format) { return format.recognize(text); });
  return found == kUnreadFormats.end() ? nullptr : &*found;
}

}  // namespace

void refuse_unread_labels(const fs::path& path) {
  if (!fs::exists(path)) return;  // the reader reports it
  const std::vector<fs::path> files =
      fs::is_directory(path) ? list_files(path, {".txt", ".xml", ".json", ".npz"}) : std::vector<fs::path>{path};
  constexpr std::size_t kMaxInspected = 25;  // lists of classes and files of images without objects may come first
  for (std::size_t i = 0; i < std::min(files.size(), kMaxInspected); ++i) {
    const fs::path& file = files[i];
    const std::string all = read_file(file);
    if (const UnreadFormat* format = find_unread_format(label_text(all)))
      throw InputError(path,
                       fmt::format("holds {}, which dvi does not support{}", format->name,
                                   file == path ? "" : ": the first is " + file.filename().string()),
                       std::string(format->remedy));
  }
}

}  // namespace dvi::labels
