#include <algorithm>
#include <map>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/core/json_text.h"
#include "dvi/core/text.h"
#include "dvi/core/text_file.h"
#include "dvi/labels/id_image.h"
#include "dvi/labels/image_labels.h"
#include "dvi/labels/labels.h"
#include "dvi/media/image_file.h"

namespace dvi::labels {
namespace {

using nlohmann::json;

constexpr int kMaxId = (1 << 24) - 1;

int read_id(const json& value, const char* name) { return static_cast<int>(to_whole_number(value, name, 0, kMaxId)); }

struct Category {
  std::string name;
  bool is_thing = true;
};

std::map<int, Category> read_categories(const json& document) {
  std::map<int, Category> categories;
  for (const json& category : document.value("categories", json::array())) {
    const json thing = category.value("isthing", json(1));
    categories[read_id(category.at("id"), "id")] = {to_lower_case(category.at("name").get<std::string>()),
                                                    thing != json(0) && thing != json(false)};
  }
  // Some converters mark all categories as stuff.
  if (std::none_of(categories.begin(), categories.end(), [](const auto& category) { return category.second.is_thing; }))
    for (auto& [id, category] : categories) category.is_thing = true;
  return categories;
}

// The id of a pixel is R + 256 G + 65536 B.
cv::Mat1i read_ids(const fs::path& file, cv::Size size) {
  const cv::Mat3b colors = media::read_image(file, size);
  cv::Mat1i ids(size);
  std::transform(colors.begin(), colors.end(), ids.begin(),
                 [](const cv::Vec3b& bgr) { return bgr[2] | bgr[1] << 8 | bgr[0] << 16; });
  return ids;
}

class Panoptic {
 public:
  Panoptic(const fs::path& file, const Drive& drive) : file_(file), drive_(drive), labels_(file, drive) {}

  PanopticLabels read(const json& document) {
    place_ = "categories";
    categories_ = read_categories(document);
    place_ = "annotations";
    std::vector<std::string> names;
    for (const json& annotation : document.at("annotations")) names.push_back(annotation.at("file_name").get<std::string>());
    const ImageFrames frames = find_image_frames(file_, names, drive_);
    if (frames.warning) labels_.warn(*frames.warning);
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (!frames.frames[i]) continue;
      place_ = "annotation of " + names[i];
      labels_.know(*frames.frames[i]);
      if (labels_.wanted(*frames.frames[i])) read_image(document.at("annotations")[i], names[i], *frames.frames[i]);
    }
    return {labels_.take(), std::move(images_)};
  }

  const std::string& place() const { return place_; }

 private:
  fs::path find_image(const std::string& name) const {
    const fs::path folder = file_.parent_path();
    for (const fs::path& image : {folder / file_.stem() / name, folder / name})
      if (fs::is_regular_file(image)) return image;
    throw InputError(file_, fmt::format("its image {} is missing", name),
                     fmt::format("put the PNG files into {}", (folder / file_.stem()).string()));
  }

  void read_image(const json& annotation, const std::string& name, const std::string& frame) {
    const fs::path image = find_image(name);
    images_.push_back(image);
    const std::map<int, Instance> outlines = outline_ids(read_ids(image, labels_.size()));
    for (const json& segment : annotation.at("segments_info")) {
      const int id = read_id(segment.at("id"), "id"), category = read_id(segment.at("category_id"), "category_id");
      const auto named = categories_.find(category);
      if (named != categories_.end() && !named->second.is_thing) continue;
      const auto outline = outlines.find(id);
      if (outline == outlines.end())
        throw InputError(image, fmt::format("has no pixel of segment {}, which {} lists", id, file_.filename().string()),
                         "the PNG and the JSON file must be from the same export");
      Label label;
      label.type = named != categories_.end() ? named->second.name : fmt::format("class {}", category);
      label.class_number = category;
      labels_.add_outline(frame, std::move(label), outline->second);
    }
  }

  const fs::path& file_;
  const Drive& drive_;
  ImageLabels labels_;
  std::map<int, Category> categories_;
  std::vector<fs::path> images_;
  std::string place_ = "it";  // the element that is being read, for messages
};

}  // namespace

PanopticLabels read_panoptic(const fs::path& file, const Drive& drive) {
  Panoptic panoptic(file, drive);
  const auto fail = [&](const std::exception& e) -> PanopticLabels {
    throw InputError(file, panoptic.place() + ": " + e.what(), "see docs/masks.md for the supported parts of COCO");
  };
  try {
    return panoptic.read(json::parse(read_text(file)));
  } catch (const json::exception& e) {
    return fail(e);
  } catch (const std::invalid_argument& e) {
    return fail(e);
  }
}

}  // namespace dvi::labels
