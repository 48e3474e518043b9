#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/core/json_text.h"
#include "dvi/core/text_file.h"
#include "dvi/io/coco_runs.h"
#include "dvi/io/image_labels.h"
#include "dvi/io/labels.h"
#include "dvi/io/text.h"

namespace dvi::io {
namespace {

using nlohmann::json;

std::int64_t whole(const json& value, const char* what, std::int64_t most) { return whole_number(value, what, 0, most); }

cv::Size pixels(const json& width, const json& height) {
  constexpr int kMostAcross = std::numeric_limits<int>::max();
  return {static_cast<int>(whole(width, "width", kMostAcross)), static_cast<int>(whole(height, "height", kMostAcross))};
}

double coordinate(const json& value) {
  const double number = value.get<double>();
  if (!(std::abs(number) <= kFarthestPixel)) throw std::invalid_argument("a corner lies far outside of any image");
  return number;
}

std::vector<Polygon> polygons_of(const json& parts) {
  std::vector<Polygon> polygons;
  for (const json& part : parts) {
    if (!part.is_array() || part.size() % 2 != 0) throw std::invalid_argument("a polygon is no list of pairs x, y");
    if (part.size() > 2 * kMostCorners) throw std::invalid_argument("a polygon has too many corners");
    Polygon& polygon = polygons.emplace_back();
    for (std::size_t i = 0; i < part.size(); i += 2) polygon.emplace_back(coordinate(part[i]), coordinate(part[i + 1]));
  }
  return polygons;
}

Instance outline(const json& segmentation, cv::Size wanted) {
  const json& size = segmentation.at("size");
  const cv::Size own = pixels(size.at(1), size.at(0));
  if (own != wanted)
    throw std::invalid_argument(fmt::format("its outline is of an image of {}x{} pixels, the drive's are {}x{}", own.width,
                                            own.height, wanted.width, wanted.height));
  Instance out{own, {}};
  const json& counts = segmentation.at("counts");
  if (counts.is_string()) {
    out.runs = decode_runs(counts.get_ref<const std::string&>());
  } else {
    for (const json& run : counts)
      out.runs.push_back(static_cast<std::uint32_t>(whole(run, "a run", std::numeric_limits<std::uint32_t>::max())));
  }
  require_filled(out.runs, own);
  return out;
}

// Tools keep the number of a track in one of these places.
int track_of(const json& annotation) {
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
      categories_[category.at("id").dump()] = lower_case(category.at("name").get<std::string>());
    place_ = "annotations";
    for (const json& annotation : document.at("annotations")) {
      place_ = "annotation " + annotation.at("id").dump();
      read_annotation(annotation);
    }
  }

  const std::string& place() const { return place_; }
  NamedLabels take() { return labels_.take(); }

 private:
  void read_images(const json& images) {
    std::vector<std::string> names;
    for (const json& image : images) names.push_back(image.at("file_name").get<std::string>());
    const auto frames = frames_of_images(file_, names, drive_);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const json& image = images[i];
      if (!frames_.emplace(image.at("id").dump(), frames[i]).second)
        throw std::invalid_argument("two have the id " + image.at("id").dump());
      if (!frames[i]) continue;
      labels_.know(*frames[i]);
      if (labels_.wanted(*frames[i]) && image.contains("width") && image.contains("height"))
        labels_.require_size(names[i], pixels(image.at("width"), image.at("height")));
    }
  }

  void read_annotation(const json& annotation) {
    const std::string image = annotation.at("image_id").dump(), category = annotation.at("category_id").dump();
    const auto frame = frames_.find(image);
    if (frame == frames_.end()) throw std::invalid_argument("there is no image " + image);
    if (!frame->second) return;
    if (!labels_.wanted(*frame->second)) return labels_.note(*frame->second);
    const auto named = categories_.find(category);
    Label label;
    label.track = track_of(annotation);
    label.type = named != categories_.end() ? named->second : "class " + category;
    const auto shape = annotation.find("segmentation");
    if (shape != annotation.end() && shape->is_object())
      labels_.add_outline(*frame->second, std::move(label), outline(*shape, labels_.size()));
    else if (shape != annotation.end() && shape->is_array() && !shape->empty())
      labels_.add_polygons(*frame->second, std::move(label), polygons_of(*shape));
    else
      read_box(annotation, *frame->second, std::move(label));
  }

  void read_box(const json& annotation, const std::string& frame, Label label) {
    if (!annotation.contains("bbox")) throw std::invalid_argument("it has neither a segmentation nor a bbox");
    const json& box = annotation.at("bbox");
    if (!box.is_array() || box.size() != 4) throw std::invalid_argument("its bbox is not x, y, width, height");
    const cv::Point2d low(coordinate(box[0]), coordinate(box[1])), extent(coordinate(box[2]), coordinate(box[3]));
    if (extent.x < 0 || extent.y < 0) throw std::invalid_argument("its bbox has a negative width or height");
    labels_.add_box(frame, std::move(label), low, low + extent);
  }

  const fs::path& file_;
  const Drive& drive_;
  ImageLabels labels_;
  std::string place_ = "it";                                  // of what is being read
  std::map<std::string, std::optional<std::string>> frames_;  // by id; none: of another camera
  std::map<std::string, std::string> categories_;             // by id
};

}  // namespace

NamedLabels read_coco(const fs::path& file, const Drive& drive) {
  Coco coco(file, drive);
  const auto fail = [&](const std::exception& e) {
    throw InputError(file, coco.place() + ": " + e.what(), "docs/masks.md says what is read of COCO files");
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

}  // namespace dvi::io
