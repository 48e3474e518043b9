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
#include "dvi/labels/label_folder.h"
#include "dvi/media/numpy_file.h"

namespace dvi::labels {
namespace {

using nlohmann::json;

// Grounded-SAM-2 writes mask_data/mask_NAME.npy and json_data/mask_NAME.json.
std::optional<fs::path> find_description(const fs::path& array) {
  const fs::path name = array.stem().string() + ".json", folder = array.parent_path();
  for (const fs::path& file : {folder / name, folder.parent_path() / "json_data" / name})
    if (fs::is_regular_file(file)) return file;
  return std::nullopt;
}

/// The objects of one image by their number in the array.
std::map<int, Label> read_objects(const fs::path& file) {
  std::map<int, Label> objects;
  try {
    const json document = json::parse(read_text(file));
    const json listed = document.value("labels", json::object());
    for (const auto& [key, object] : listed.items()) {
      const auto id = to_integer(key);
      if (!id) throw std::invalid_argument("'" + key + "' in labels is not the number of an object");
      Label label;
      label.track = *id;
      const json name = object.value("class_name", json());
      label.type = name.is_string() ? to_lower_case(name.get<std::string>()) : "";
      objects[*id] = std::move(label);
    }
  } catch (const json::exception& e) {
    throw InputError(file, e.what(), "see docs/masks.md for the supported parts of Grounded-SAM-2");
  } catch (const std::invalid_argument& e) {
    throw InputError(file, e.what(), "see docs/masks.md for the supported parts of Grounded-SAM-2");
  }
  return objects;
}

void read_array(const fs::path& array, const std::string& frame, ImageLabels& labels) {
  const auto description = find_description(array);
  if (!description)
    throw InputError(array, "has no JSON file, although other arrays of its folder have one",
                     "restore " + array.stem().string() + ".json, or remove all JSON files to remove all objects");
  const std::map<int, Label> objects = read_objects(*description);
  cv::Mat1i ids;
  media::read_numpy(array, labels.size()).convertTo(ids, CV_32S);
  for (auto& [id, outline] : outline_ids(ids)) {
    const auto object = objects.find(id);
    if (object == objects.end())
      throw InputError(array, fmt::format("has an object {} that {} does not list", id, description->string()),
                       "the array and the JSON file must be from the same export");
    labels.add_outline(frame, object->second, outline);
  }
}

}  // namespace

std::optional<LabelFolder> find_named_arrays(const fs::path& folder) {
  LabelFolder found{folder, list_files(folder, {".npy"}), {}};
  for (const fs::path& array : found.files)
    if (const auto file = find_description(array)) found.shared.push_back(*file);
  if (found.shared.empty()) return std::nullopt;  // masks: see match_masks()
  return found;
}

NamedLabels read_named_arrays(const LabelFolder& folder, const Drive& drive) {
  ImageLabels labels(folder.folder, drive);
  std::vector<std::string> names;
  for (const fs::path& file : folder.files) names.push_back(file.filename().string());
  const ImageFrames frames = find_image_frames(folder.folder, names, drive);
  for (std::size_t i = 0; i < folder.files.size(); ++i) {
    labels.know(*frames.frames[i]);
    if (labels.wanted(*frames.frames[i])) read_array(folder.files[i], *frames.frames[i], labels);
  }
  if (frames.warning) labels.warn(*frames.warning);
  return labels.take();
}

}  // namespace dvi::labels
