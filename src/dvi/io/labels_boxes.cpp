#include <array>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/core/json_text.h"
#include "dvi/io/labels.h"
#include "dvi/io/text.h"

namespace dvi::io {
namespace {

using nlohmann::json;
constexpr int kBoxesVersion = 1, kNewest = 1000;

Eigen::Vector3d vector(const json& value) {
  const auto v = value.get<std::array<double, 3>>();
  return {v[0], v[1], v[2]};
}

Label read_box(const json& box) {
  Label label;
  if (const auto track = box.find("track"); track != box.end())
    label.track = static_cast<int>(whole_number(*track, "track", -1, std::numeric_limits<int>::max()));
  label.type = lower_case(box.at("class").get<std::string>());
  label.box = Box{{so3_exp({0, 0, box.at("yaw").get<double>()}), vector(box.at("center"))}, vector(box.at("size"))};
  if (!(label.box->size.array() > 0).all()) throw std::invalid_argument("a box has no size [length, width, height]");
  return label;
}

}  // namespace

LabelsByName read_boxes_json(const fs::path& file) {
  LabelsByName labels;
  std::string name;
  try {
    const json document = json::parse(read_file(file));
    if (const auto version = whole_number(document.at("version"), "version", 0, kNewest); version != kBoxesVersion)
      throw std::invalid_argument(fmt::format("version is {}, and this program reads {}", version, kBoxesVersion));
    for (const auto& [frame, boxes] : document.at("frames").items()) {
      name = frame;
      labels[frame];
      for (const json& box : boxes)
        if (Label label = read_box(box); label.type != "dontcare") labels[frame].push_back(std::move(label));
    }
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& e) {  // of the JSON library or of ours
    throw InputError(file, (name.empty() ? "" : "frame " + name + ": ") + e.what(), "docs/formats.md shows the layout");
  }
  return labels;
}

}  // namespace dvi::io
