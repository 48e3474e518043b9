#include <array>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/core/json_text.h"
#include "dvi/core/text.h"
#include "dvi/core/text_file.h"
#include "dvi/geometry/rigid.h"
#include "dvi/labels/coco_runs.h"
#include "dvi/labels/labels.h"

namespace dvi::labels {
namespace {

using nlohmann::json;
using RowMajor3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
constexpr int kBoxesVersion = 1, kMaxVersion = 1000;

Eigen::Vector3d to_vector(const json& value) {
  const auto v = value.get<std::array<double, 3>>();
  return {v[0], v[1], v[2]};
}

Eigen::Matrix3d read_rotation(const json& box) {
  if (!box.contains("rotation")) return so3_exp({0, 0, box.at("yaw").get<double>()});
  const auto r = box.at("rotation").get<std::array<double, 9>>();
  const auto pose = to_rigid({r[0], r[1], r[2], 0, r[3], r[4], r[5], 0, r[6], r[7], r[8], 0});
  if (!pose) throw std::invalid_argument("a rotation " + describe_rotation_problem(Eigen::Map<const RowMajor3d>(r.data())));
  return pose->R;
}

Instance read_outline(const json& outline) {
  constexpr int kMaxSidePx = 1 << 20;
  Instance instance;
  instance.size.height = static_cast<int>(to_whole_number(outline.at("size").at(0), "height", 1, kMaxSidePx));
  instance.size.width = static_cast<int>(to_whole_number(outline.at("size").at(1), "width", 1, kMaxSidePx));
  for (const json& run : outline.at("counts"))
    instance.runs.push_back(
        static_cast<std::uint32_t>(to_whole_number(run, "a run", 0, std::numeric_limits<std::uint32_t>::max())));
  require_filled(instance.runs, instance.size);
  return instance;
}

Label read_box(const json& box) {
  Label label;
  if (const auto track = box.find("track"); track != box.end())
    label.track = static_cast<int>(to_whole_number(*track, "track", -1, std::numeric_limits<int>::max()));
  label.type = to_lower_case(box.at("class").get<std::string>());
  if (const auto rect = box.find("rect"); rect != box.end()) {
    const auto r = rect->get<std::array<double, 4>>();
    label.rect = cv::Rect2d(r[0], r[1], r[2], r[3]);
    if (!(label.rect->width > 0 && label.rect->height > 0)) throw std::invalid_argument("a rect has no width and height");
  }
  if (const auto outline = box.find("outline"); outline != box.end()) label.instance = read_outline(*outline);
  if (!box.contains("center") && (label.rect || label.instance)) return label;
  label.box = Box{{read_rotation(box), to_vector(box.at("center"))}, to_vector(box.at("size"))};
  if (!(label.box->size.array() > 0).all()) throw std::invalid_argument("a box has no size [length, width, height]");
  return label;
}

}  // namespace

BoxesFile read_boxes_json(const fs::path& file) {
  BoxesFile out;
  LabelsByName& labels = out.frames;
  std::string name;
  try {
    const json document = json::parse(read_text(file));
    if (const auto version = to_whole_number(document.at("version"), "version", 0, kMaxVersion); version != kBoxesVersion)
      throw std::invalid_argument(fmt::format("version is {}, but this program reads version {}", version, kBoxesVersion));
    out.camera = document.value("camera", std::string());
    for (const auto& [frame, boxes] : document.at("frames").items()) {
      name = frame;
      labels[frame];
      for (const json& box : boxes)
        if (Label label = read_box(box); label.type != "dontcare") labels[frame].push_back(std::move(label));
    }
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& e) {  // the JSON library throws several types
    throw InputError(file, (name.empty() ? "" : "frame " + name + ": ") + e.what(), "see docs/formats.md for the layout");
  }
  return out;
}

}  // namespace dvi::labels
