#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/labels/class_names.h"
#include "dvi/labels/image_labels.h"
#include "dvi/labels/label_folder.h"

namespace dvi::labels {
namespace {

constexpr std::size_t kBoxNumbers = 4;      // center x, center y, width, height
constexpr std::size_t kPolygonNumbers = 6;  // three corners
constexpr double kTolerance = 0.01;         // coordinates slightly outside the image

bool is_whole(double value) { return value == std::floor(value) && std::abs(value) < 1e9; }

/// Counts lines by a number at their end.
struct EndStatistics {
  std::size_t lines = 0, whole = 0, above_one = 0, one = 0;
  bool is_repeated = false;  ///< two lines of a file have the same number

  void add(double value, std::set<double>& in_file) {
    ++lines;
    whole += is_whole(value) ? 1 : 0;
    above_one += value > 1 ? 1 : 0;
    one += value == 1 ? 1 : 0;
    is_repeated |= !in_file.insert(value).second;
  }
  bool all_whole() const { return lines > 0 && whole == lines; }
};

/// The content of the lines after the class, decided by all files of a folder: the numbers of a shape, and then, with options
/// of the detector, its confidence and the number of its track.
struct LineLayout {
  bool has_polygons = false;
  bool has_pairs = false;  ///< whether lines with an even number of numbers end in confidence and track
  bool has_track = false;  ///< whether a single number at the end is a track instead of a confidence
  bool has_extras = false;
};

class LayoutFinder {
 public:
  void add_file(const std::vector<TextLine>& lines) {
    std::set<double> singles, pairs;
    for (const TextLine& line : lines) {
      const std::size_t count = line.size() - 1;
      ++lines_, ++counts_[count];
      if (count < kBoxNumbers + 1) continue;
      has_polygons_ |= count > kPolygonNumbers;
      const double last = line.number(count);
      if (count == kPolygonNumbers) sixes_.add(last, pairs);
      if (count % 2 == 1)
        singles_.add(last, singles);
      else if (count > kPolygonNumbers)
        evens_.add(last, pairs);
    }
  }

  /// Throws InputError about `folder` if its files have the 17 keypoints of people instead of polygons.
  LineLayout find(const fs::path& folder) const {
    constexpr std::size_t kPoseNumbers = kBoxNumbers + 17 * 3, kMaxExtras = 2, kMinEqualLines = 3;
    const std::size_t first = counts_.empty() ? 0 : counts_.begin()->first;
    if (counts_.size() == 1 && lines_ >= kMinEqualLines && first >= kPoseNumbers && first <= kPoseNumbers + kMaxExtras)
      throw InputError(folder, fmt::format("has {} numbers in each line: keypoints of people, not polygons", first),
                       "use a network for detection or segmentation, yolo segment predict");
    LineLayout out;
    out.has_polygons = has_polygons_ || (sixes_.lines > 0 && !sixes_.all_whole());
    // The last coordinate of a polygon is not 1 in all lines, except in very few.
    constexpr std::size_t kMinLines = 3;
    const EndStatistics& ends = out.has_polygons ? evens_ : sixes_;
    out.has_pairs =
        ends.all_whole() && (!out.has_polygons || ends.above_one > 0 || (ends.one == ends.lines && ends.lines >= kMinLines));
    out.has_track = !out.has_pairs && singles_.all_whole() && !singles_.is_repeated;
    out.has_extras = out.has_pairs || singles_.lines > 0;
    return out;
  }

 private:
  std::map<std::size_t, std::size_t> counts_;  // lines by their number of numbers
  std::size_t lines_ = 0;
  bool has_polygons_ = false;
  EndStatistics singles_;  ///< of lines with an odd number of numbers
  EndStatistics sixes_;    ///< of lines with six numbers: triangles, or boxes with confidence and track
  EndStatistics evens_;    ///< of longer lines with an even number
};

/// Reads the lines of all files.
class Yolo {
 public:
  Yolo(const LabelFolder& folder, const Drive& drive)
      : labels_(folder.folder, drive), names_(find_class_names(folder.folder)) {}

  void set_layout(const LineLayout& layout) { layout_ = layout; }
  void know(const std::string& frame) { labels_.know(frame); }
  bool wanted(const std::string& frame) const { return labels_.wanted(frame); }
  void note(const std::string& frame) { labels_.note(frame); }

  void read_line(const TextLine& line, const std::string& frame) {
    const std::size_t extras = count_extras(line), numbers = line.size() - 1 - extras;
    Label label;
    label.class_number = read_class(line);
    label.type = name_class(line, label.class_number);
    if (extras == 2 || (extras == 1 && layout_.has_track)) label.track = line.integer(line.size() - 1);
    for (std::size_t i = 1; i <= numbers; ++i) require_fraction(line, i);
    if (extras == 2 || (extras == 1 && !layout_.has_track)) require_confidence(line, numbers + 1);
    if (numbers >= kPolygonNumbers) return labels_.add_polygons(frame, std::move(label), {read_polygon(line, numbers)});
    const bool is_box = numbers == kBoxNumbers && !(layout_.has_polygons && layout_.has_extras);
    if (is_box) return add_box(line, frame, std::move(label));
    if (!layout_.has_polygons)
      line.fail(fmt::format("has {} numbers after the class", line.size() - 1),
                "a box has four numbers, and a polygon at least six: see docs/masks.md");
    ++without_area_;
  }

  NamedLabels take(const fs::path& folder) {
    if (without_area_ > 0)
      labels_.warn(
          fmt::format("{}: {} polygons with fewer than three corners are ignored", folder.filename().string(), without_area_));
    return labels_.take();
  }

  void warn(std::string text) { labels_.warn(std::move(text)); }

 private:
  std::size_t count_extras(const TextLine& line) const {
    const std::size_t count = line.size() - 1;
    if (count % 2 == 1) return 1;
    return layout_.has_pairs && count >= 2 && (layout_.has_polygons || count == kBoxNumbers + 2) ? 2 : 0;
  }

  static int read_class(const TextLine& line) {
    const double number = line.number(0);
    if (!is_whole(number) || number < 0) line.fail("'" + line.word(0) + "' is not the number of a class");
    return static_cast<int>(number);
  }

  // A class without a name is called by its number, like those of COCO.
  std::string name_class(const TextLine& line, int number) const {
    if (names_.names.empty()) return fmt::format("class {}", number);
    const auto named = names_.names.find(number);
    if (named == names_.names.end())
      line.fail(fmt::format("class {} has no name in {}, whose classes are {} to {}", number, names_.file.string(),
                            names_.names.begin()->first, names_.names.rbegin()->first),
                "give the names of these labels, or remove that file to select classes by number");
    return named->second;
  }

  static void require_fraction(const TextLine& line, std::size_t i) {
    if (const double value = line.number(i); !(value >= -kTolerance && value <= 1 + kTolerance))
      line.fail(fmt::format("'{}' is not a fraction of the image", line.word(i)),
                "coordinates must be divided by the image's width and height, so that they are 0 to 1");
  }

  static void require_confidence(const TextLine& line, std::size_t i) {
    if (const double value = line.number(i); !(value >= 0 && value <= 1))
      line.fail(fmt::format("'{}' is neither a coordinate nor a confidence, and not the number of a track", line.word(i)),
                "see docs/masks.md for the supported lines");
  }

  cv::Point2d to_pixels(double x, double y) const { return {x * labels_.size().width, y * labels_.size().height}; }

  Polygon read_polygon(const TextLine& line, std::size_t numbers) const {
    if (numbers > 2 * kMaxCorners) line.fail("has too many corners");
    Polygon polygon;
    for (std::size_t i = 1; i < numbers; i += 2) polygon.push_back(to_pixels(line.number(i), line.number(i + 1)));
    return polygon;
  }

  // Rounds an edge that differs from the edge of a pixel by the rounding of the text only, which has six digits.
  cv::Point2d snap(const cv::Point2d& corner) const {
    constexpr double kTextRounding = 1e-6;  // fraction of the image
    const auto snap_side = [](double value, int side) {
      return std::abs(value - std::round(value)) <= kTextRounding * side ? std::round(value) : value;
    };
    return {snap_side(corner.x, labels_.size().width), snap_side(corner.y, labels_.size().height)};
  }

  void add_box(const TextLine& line, const std::string& frame, Label label) {
    const cv::Point2d center = to_pixels(line.number(1), line.number(2)),
                      half = 0.5 * to_pixels(line.number(3), line.number(4));
    labels_.add_box(frame, std::move(label), snap(center - half), snap(center + half));
  }

  ImageLabels labels_;
  ClassNames names_;
  LineLayout layout_;
  std::size_t without_area_ = 0;
};

std::vector<TextLine> read_yolo_lines(const fs::path& file) {
  std::vector<TextLine> lines = read_text_lines(file);
  std::erase_if(lines, [](const TextLine& line) { return line.size() == 0; });
  return lines;
}

}  // namespace

bool is_yolo(std::string_view text, bool strict) {
  const std::vector<std::string> words = split_words(text.substr(0, text.find_first_of("\r\n")));
  if (words.size() <= kBoxNumbers || !to_number(words[0]) || !is_whole(*to_number(words[0]))) return false;
  return std::all_of(words.begin() + 1, words.end(), [&](const std::string& word) {
    const auto value = to_number(word);
    const bool may_be_extra = &word - &words.front() > static_cast<std::ptrdiff_t>(kBoxNumbers);
    return value && (!strict || may_be_extra || (*value >= -kTolerance && *value <= 1 + kTolerance));
  });
}

std::optional<LabelFolder> find_yolo(const fs::path& folder) {
  std::vector<fs::path> files = list_files(folder, {".txt"});
  std::erase_if(files, is_yolo_list);
  if (files.empty()) return std::nullopt;
  // Beside masks, there may be other text files.
  const bool has_images = !list_files(folder, {".png", ".jpg", ".jpeg"}).empty();
  const auto filled = std::find_if(files.begin(), files.end(), [](const fs::path& file) { return fs::file_size(file) > 0; });
  if (filled == files.end() ? has_images : !is_yolo(label_text(read_file(*filled)), has_images)) return std::nullopt;
  LabelFolder found{folder, files, {}};
  if (const ClassNames classes = find_class_names(folder); !classes.names.empty()) found.shared.push_back(classes.file);
  return found;
}

NamedLabels read_yolo(const LabelFolder& folder, const Drive& drive) {
  Yolo yolo(folder, drive);
  std::vector<std::string> names;
  LayoutFinder layout;
  for (const fs::path& file : folder.files) {
    names.push_back(file.filename().string());
    layout.add_file(read_yolo_lines(file));
  }
  yolo.set_layout(layout.find(folder.folder));
  const ImageFrames frames = find_image_frames(folder.folder, names, drive);
  std::set<std::string> with_file;
  for (std::size_t i = 0; i < folder.files.size(); ++i) {
    const std::string& frame = *frames.frames[i];
    with_file.insert(frame);
    for (const TextLine& line : read_yolo_lines(folder.files[i])) {
      if (yolo.wanted(frame))
        yolo.read_line(line, frame);
      else
        yolo.note(frame);
    }
  }
  std::vector<int> without_file;
  for (const Frame& frame : drive.frames) {
    yolo.know(frame.name);
    if (!with_file.contains(frame.name)) without_file.push_back(frame.number);
  }
  if (!without_file.empty())
    yolo.warn(fmt::format("{}: {} of {} frames have no label file and count as frames without objects: {}",
                          folder.folder.filename().string(), without_file.size(), drive.frames.size(),
                          format_ranges(without_file)));
  if (frames.warning) yolo.warn(*frames.warning);
  return yolo.take(folder.folder);
}

}  // namespace dvi::labels
