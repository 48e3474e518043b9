#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/core/error.h"
#include "dvi/core/json_text.h"
#include "dvi/core/text.h"
#include "dvi/core/text_file.h"
#include "dvi/drive/outline.h"
#include "dvi/labels/coco_runs.h"
#include "dvi/labels/image_labels.h"
#include "dvi/labels/labels.h"

namespace dvi::labels {
namespace {

using nlohmann::json;

std::int64_t read_whole(const json& value, const char* what, std::int64_t most) {
  return to_whole_number(value, what, 0, most);
}

cv::Size read_size(const json& width, const json& height) {
  constexpr int kMaxSidePx = std::numeric_limits<int>::max();
  return {static_cast<int>(read_whole(width, "width", kMaxSidePx)), static_cast<int>(read_whole(height, "height", kMaxSidePx))};
}

double read_coordinate(const json& value) {
  const double number = value.get<double>();
  if (!(std::abs(number) <= kMaxCoordinatePx)) throw std::invalid_argument("a corner lies far outside the image");
  return number;
}

// Reads the polygons of a segmentation. Tools write empty lists, points or lines for objects that have only a box.
std::vector<Polygon> read_polygons(const json& parts) {
  constexpr std::size_t kMinCorners = 3;
  std::vector<Polygon> polygons;
  for (const json& part : parts) {
    if (!part.is_array() || part.size() % 2 != 0) throw std::invalid_argument("a polygon is not a list of pairs x, y");
    if (part.size() > 2 * kMaxCorners) throw std::invalid_argument("a polygon has too many corners");
    Polygon polygon;
    for (std::size_t i = 0; i < part.size(); i += 2)
      polygon.emplace_back(read_coordinate(part[i]), read_coordinate(part[i + 1]));
    if (polygon.size() >= kMinCorners) polygons.push_back(std::move(polygon));
  }
  return polygons;
}

// If no coordinate of a file exceeds this, its polygons and boxes are in fractions of the image instead of pixels.
constexpr double kMaxNormalized = 1.5;

// Returns the largest coordinate of all polygons and boxes of a file; nothing if it has run lengths or no coordinates.
std::optional<double> find_largest_coordinate(const json& annotations) {
  std::optional<double> largest;
  const auto add = [&](const json& values) {
    for (const json& value : values)
      if (value.is_number()) largest = std::max(largest.value_or(0), std::abs(value.get<double>()));
  };
  for (const json& annotation : annotations) {
    const json segmentation = annotation.value("segmentation", json());
    if (segmentation.is_object()) return std::nullopt;
    if (segmentation.is_array())
      for (const json& part : segmentation) add(part);
    if (annotation.contains("bbox") && annotation.at("bbox").is_array()) add(annotation.at("bbox"));
  }
  return largest;
}

// Returns whether polygons run through the centers of the boundary pixels, as by OpenCV's findContours, instead of along the
// edges of pixels as in COCO. The area of the annotation is then nearer to the number of pixels on and within the polygons
// (Pick's theorem).
bool run_through_pixel_centers(const std::vector<Polygon>& polygons, const json& annotation) {
  const json area = annotation.value("area", json());
  if (!area.is_number()) return false;
  double within = 0, pixels = 0;
  for (const Polygon& polygon : polygons) {
    double twice_area = 0, boundary = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const cv::Point2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      if (a.x != std::floor(a.x) || a.y != std::floor(a.y)) return false;
      twice_area += a.x * b.y - b.x * a.y;
      boundary += static_cast<double>(
          std::gcd(static_cast<std::int64_t>(std::abs(b.x - a.x)), static_cast<std::int64_t>(std::abs(b.y - a.y))));
    }
    within += 0.5 * std::abs(twice_area);
    pixels += 0.5 * std::abs(twice_area) + 0.5 * boundary + 1;
  }
  return std::abs(area.get<double>() - pixels) < std::abs(area.get<double>() - within);
}

Instance make_outline(const std::vector<Polygon>& polygons, cv::Size size) {
  cv::Mat1b mask(size, uchar{0});
  for (const Polygon& polygon : polygons)
    cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{{polygon.begin(), polygon.end()}}, 255);
  return to_outline(mask);
}

Instance read_outline(const json& segmentation, cv::Size wanted) {
  const json& size = segmentation.at("size");
  const cv::Size own = read_size(size.at(1), size.at(0));
  if (own != wanted)
    throw std::invalid_argument(fmt::format("its outline is of an image of {}x{} pixels, but the drive's images are {}x{}",
                                            own.width, own.height, wanted.width, wanted.height));
  Instance out{own, {}};
  const json& counts = segmentation.at("counts");
  if (counts.is_string()) {
    out.runs = decode_runs(counts.get_ref<const std::string&>());
  } else {
    for (const json& run : counts)
      out.runs.push_back(static_cast<std::uint32_t>(read_whole(run, "a run", std::numeric_limits<std::uint32_t>::max())));
  }
  require_filled(out.runs, own);
  return out;
}

// Reads the number of a track, which tools store under several keys.
int read_track(const json& annotation) {
  const json attributes = annotation.value("attributes", json::object());
  for (const json* from : {&attributes, &annotation})
    for (const char* key : {"track_id", "instance_id"})
      if (const auto found = from->is_object() ? from->find(key) : from->end();
          found != from->end() && found->is_number_integer())
        if (const auto number = found->get<std::int64_t>(); number >= 0 && number <= std::numeric_limits<int>::max())
          return static_cast<int>(number);
  return -1;
}

class Coco {
 public:
  Coco(const fs::path& file, const Drive& drive) : file_(file), drive_(drive), labels_(file, drive) {}

  void read(const json& document) {
    place_ = "images";
    read_images(document.at("images"));
    place_ = "categories";
    for (const json& category : document.value("categories", json::array()))
      categories_[category.at("id").dump()] = to_lower_case(category.at("name").get<std::string>());
    place_ = "annotations";
    find_unit(document.at("annotations"));
    for (const json& annotation : document.at("annotations")) {
      place_ = "annotation " + annotation.value("id", json()).dump();
      read_annotation(annotation);
    }
  }

  const std::string& place() const { return place_; }
  NamedLabels take() { return labels_.take(); }

 private:
  void read_images(const json& images) {
    std::vector<std::string> names;
    for (const json& image : images) names.push_back(image.at("file_name").get<std::string>());
    const auto [frames, warning] = find_image_frames(file_, names, drive_);
    if (warning) labels_.warn(*warning);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const json& image = images[i];
      if (!frames_.emplace(image.at("id").dump(), frames[i]).second)
        throw std::invalid_argument("two images have the id " + image.at("id").dump());
      if (!frames[i]) continue;
      labels_.know(*frames[i]);
      if (labels_.wanted(*frames[i]) && image.contains("width") && image.contains("height"))
        labels_.require_size(names[i], read_size(image.at("width"), image.at("height")));
    }
  }

  // Scales coordinates that are fractions of the image, 0 to 1, to pixels.
  void find_unit(const json& annotations) {
    constexpr int kMinSidePx = 32;  // side of an image in which all shapes are one pixel at most
    const std::optional<double> largest = find_largest_coordinate(annotations);
    const cv::Size size = labels_.size();
    if (!largest || *largest == 0 || *largest > kMaxNormalized || std::min(size.width, size.height) < kMinSidePx) return;
    unit_ = {static_cast<double>(size.width), static_cast<double>(size.height)};
    labels_.warn(
        fmt::format("{}: its largest coordinate is {:.3g}: coordinates are read as fractions of the image, not as pixels",
                    file_.filename().string(), *largest));
  }

  cv::Point2d corner(const cv::Point2d& given) const { return {given.x * unit_.x, given.y * unit_.y}; }

  void read_annotation(const json& annotation) {
    const std::string image = annotation.at("image_id").dump(), category = annotation.at("category_id").dump();
    const auto frame = frames_.find(image);
    if (frame == frames_.end()) throw std::invalid_argument("it refers to an unknown image " + image);
    if (!frame->second) return;
    if (!labels_.wanted(*frame->second)) return labels_.note(*frame->second);
    const auto named = categories_.find(category);
    Label label;
    label.track = read_track(annotation);
    label.class_number = to_integer(category).value_or(-1);
    label.type = named != categories_.end() ? named->second : "class " + category;
    const auto shape = annotation.find("segmentation");
    if (shape != annotation.end() && shape->is_object())
      return labels_.add_outline(*frame->second, std::move(label), read_outline(*shape, labels_.size()));
    std::vector<Polygon> polygons;
    if (shape != annotation.end() && shape->is_array()) polygons = read_polygons(*shape);
    if (polygons.empty()) return read_box(annotation, *frame->second, std::move(label));
    for (Polygon& polygon : polygons)
      for (cv::Point2d& p : polygon) p = corner(p);
    if (run_through_pixel_centers(polygons, annotation))
      labels_.add_outline(*frame->second, std::move(label), make_outline(polygons, labels_.size()));
    else
      labels_.add_polygons(*frame->second, std::move(label), polygons);
  }

  void read_box(const json& annotation, const std::string& frame, Label label) {
    if (!annotation.contains("bbox")) throw std::invalid_argument("it has neither a segmentation nor a bbox");
    const json& box = annotation.at("bbox");
    if (!box.is_array() || box.size() != 4) throw std::invalid_argument("its bbox is not x, y, width, height");
    const cv::Point2d low(read_coordinate(box[0]), read_coordinate(box[1])),
        extent(read_coordinate(box[2]), read_coordinate(box[3]));
    if (extent.x < 0 || extent.y < 0) throw std::invalid_argument("its bbox has a negative width or height");
    labels_.add_box(frame, std::move(label), corner(low), corner(low + extent));
  }

  const fs::path& file_;
  const Drive& drive_;
  ImageLabels labels_;
  cv::Point2d unit_{1, 1};                                    // pixels per unit of the file's coordinates
  std::string place_ = "it";                                  // the element that is being read, for messages
  std::map<std::string, std::optional<std::string>> frames_;  // by id; none if it is of another camera
  std::map<std::string, std::string> categories_;             // by id
};

}  // namespace

NamedLabels read_coco(const fs::path& file, const Drive& drive) {
  Coco coco(file, drive);
  const auto fail = [&](const std::exception& e) {
    throw InputError(file, coco.place() + ": " + e.what(), "see docs/masks.md for the supported parts of COCO");
  };
  try {
    coco.read(json::parse(read_text(file)));
  } catch (const json::exception& e) {
    fail(e);
  } catch (const std::invalid_argument& e) {
    fail(e);
  }
  return coco.take();
}

}  // namespace dvi::labels
