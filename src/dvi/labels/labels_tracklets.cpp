#include <fmt/format.h>
#include <pugixml.hpp>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/labels/labels.h"

namespace dvi::labels {
namespace {

double read_number(const fs::path& file, const pugi::xml_node& node, const char* name) {
  const auto value = to_number(node.child_value(name));
  if (!value) throw InputError(file, std::string("an <item> has no number <") + name + ">");
  return *value;
}

}  // namespace

LabelsByNumber read_tracklets(const fs::path& file) {
  const std::string text = read_file(file);
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
  if (!parsed)
    throw InputError(file,
                     std::string("is malformed XML: ") + parsed.description() + " at byte " + std::to_string(parsed.offset));
  const pugi::xml_node tracklets = document.child("boost_serialization").child("tracklets");
  if (!tracklets) throw InputError(file, "has no <boost_serialization><tracklets>");

  LabelsByNumber labels;
  int track = 0;
  for (const pugi::xml_node& item : tracklets.children("item")) {
    const std::string type = to_lower_case(item.child_value("objectType"));
    const Eigen::Vector3d size(read_number(file, item, "l"), read_number(file, item, "w"), read_number(file, item, "h"));
    if (!(size.array() > 0).all())
      throw InputError(file, fmt::format("an <item> has the size {:g} x {:g} x {:g} m", size.x(), size.y(), size.z()));
    const auto first = to_integer(item.child_value("first_frame"));
    constexpr int kMaxFrames = 100'000'000;
    if (!first || *first < 0 || *first > kMaxFrames)
      throw InputError(file, "an <item> has no whole number <first_frame> of at least 0");
    int frame = *first;
    for (const pugi::xml_node& pose : item.child("poses").children("item")) {
      Label label;
      label.track = track, label.type = type;
      // The position is that of the center of the bottom face. KITTI's boxes rotate about the vertical axis only.
      const Eigen::Vector3d bottom(read_number(file, pose, "tx"), read_number(file, pose, "ty"), read_number(file, pose, "tz"));
      const Eigen::Matrix3d R = so3_exp({0, 0, read_number(file, pose, "rz")});
      label.box = Box{{R, bottom + Eigen::Vector3d(0, 0, 0.5 * size.z())}, size};
      labels[frame++].push_back(std::move(label));
    }
    ++track;
  }
  for (auto& [frame, list] : labels) std::erase_if(list, [](const Label& label) { return label.type == "dontcare"; });
  return labels;
}

}  // namespace dvi::labels
