#include "dvi/labels/class_ids.h"

#include <algorithm>
#include <array>
#include <map>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/drive/traffic_classes.h"

namespace dvi::labels {
namespace {

constexpr int kNoTrainId = 255;

struct ClassId {
  int id, train_id;
  std::string_view name, group;
  std::array<uchar, 3> rgb;
};

// The labels of Cityscapes; those from 34 on are additions of KITTI-360.
constexpr std::array kCityscapes = std::to_array<ClassId>({
    {0, 255, "unlabeled", "void", {0, 0, 0}},
    {1, 255, "ego vehicle", "void", {0, 0, 0}},
    {2, 255, "rectification border", "void", {0, 0, 0}},
    {3, 255, "out of roi", "void", {0, 0, 0}},
    {4, 255, "static", "void", {0, 0, 0}},
    {5, 255, "dynamic", "void", {111, 74, 0}},
    {6, 255, "ground", "void", {81, 0, 81}},
    {7, 0, "road", "flat", {128, 64, 128}},
    {8, 1, "sidewalk", "flat", {244, 35, 232}},
    {9, 255, "parking", "flat", {250, 170, 160}},
    {10, 255, "rail track", "flat", {230, 150, 140}},
    {11, 2, "building", "construction", {70, 70, 70}},
    {12, 3, "wall", "construction", {102, 102, 156}},
    {13, 4, "fence", "construction", {190, 153, 153}},
    {14, 255, "guard rail", "construction", {180, 165, 180}},
    {15, 255, "bridge", "construction", {150, 100, 100}},
    {16, 255, "tunnel", "construction", {150, 120, 90}},
    {17, 5, "pole", "object", {153, 153, 153}},
    {18, 255, "polegroup", "object", {153, 153, 153}},
    {19, 6, "traffic light", "object", {250, 170, 30}},
    {20, 7, "traffic sign", "object", {220, 220, 0}},
    {21, 8, "vegetation", "nature", {107, 142, 35}},
    {22, 9, "terrain", "nature", {152, 251, 152}},
    {23, 10, "sky", "sky", {70, 130, 180}},
    {24, 11, "person", "human", {220, 20, 60}},
    {25, 12, "rider", "human", {255, 0, 0}},
    {26, 13, "car", "vehicle", {0, 0, 142}},
    {27, 14, "truck", "vehicle", {0, 0, 70}},
    {28, 15, "bus", "vehicle", {0, 60, 100}},
    {29, 255, "caravan", "vehicle", {0, 0, 90}},
    {30, 255, "trailer", "vehicle", {0, 0, 110}},
    {31, 16, "train", "vehicle", {0, 80, 100}},
    {32, 17, "motorcycle", "vehicle", {0, 0, 230}},
    {33, 18, "bicycle", "vehicle", {119, 11, 32}},
    {34, 2, "garage", "construction", {64, 128, 128}},
    {35, 4, "gate", "construction", {190, 153, 153}},
    {36, 255, "stop", "construction", {150, 120, 90}},
    {37, 5, "smallpole", "object", {153, 153, 153}},
    {38, 255, "lamp", "object", {0, 64, 64}},
    {39, 255, "trash bin", "object", {0, 128, 192}},
    {40, 255, "vending machine", "object", {128, 64, 0}},
    {41, 255, "box", "object", {64, 64, 128}},
    {42, 255, "unknown construction", "void", {102, 0, 0}},
    {43, 255, "unknown vehicle", "void", {51, 0, 51}},
    {44, 255, "unknown object", "void", {32, 32, 32}},
});

struct ScanClassId {
  int id;
  std::string_view name;
};

// The name of a class includes its moving objects.
constexpr std::array kSemanticKitti = std::to_array<ScanClassId>({
    {0, "unlabeled"},
    {1, "outlier"},
    {10, "car"},
    {11, "bicycle"},
    {13, "bus"},
    {15, "motorcycle"},
    {16, "on rails"},
    {18, "truck"},
    {20, "other vehicle"},
    {30, "person"},
    {31, "bicyclist"},
    {32, "motorcyclist"},
    {40, "road"},
    {44, "parking"},
    {48, "sidewalk"},
    {49, "other ground"},
    {50, "building"},
    {51, "fence"},
    {52, "other structure"},
    {60, "lane marking"},
    {70, "vegetation"},
    {71, "trunk"},
    {72, "terrain"},
    {80, "pole"},
    {81, "traffic sign"},
    {99, "other object"},
    {252, "moving car"},
    {253, "moving bicyclist"},
    {254, "moving person"},
    {255, "moving motorcyclist"},
    {256, "moving on rails"},
    {257, "moving bus"},
    {258, "moving truck"},
    {259, "moving other vehicle"},
});

cv::Vec3b to_bgr(const ClassId& entry) { return {entry.rgb[2], entry.rgb[1], entry.rgb[0]}; }

// Converts "traffic-light" and "Traffic_Light" to "traffic light".
std::string to_plain_name(std::string name) {
  name = to_lower_case(std::move(name));
  for (char& c : name)
    if (c == '-' || c == '_') c = ' ';
  return fmt::format("{}", fmt::join(split_words(name), " "));
}

std::vector<std::string> split_names(std::string_view list) {
  std::vector<std::string> names = split_at_commas(list);
  for (std::string& name : names) name = to_plain_name(std::move(name));
  return names;
}

void add_cityscapes_class(const std::string& name, bool by_train_id, ChosenClasses& chosen) {
  for (const ClassId& entry : kCityscapes) {
    const int id = by_train_id ? entry.train_id : entry.id;
    if (by_train_id && id == kNoTrainId) continue;
    if (name != entry.name && name != entry.group && to_integer(name) != id) continue;
    chosen.ids.insert(id);
    chosen.colors.push_back(to_bgr(entry));
  }
}

void add_semantic_kitti_class(const std::string& name, ChosenClasses& chosen) {
  for (const ScanClassId& entry : kSemanticKitti)
    if (entry.name == name || entry.name == "moving " + name) chosen.ids.insert(entry.id);
}

std::string list_table_names(const std::string& table) {
  std::vector<std::string> names;
  if (table == "semantic-kitti")
    for (const ScanClassId& entry : kSemanticKitti) names.emplace_back(entry.name);
  else
    for (const ClassId& entry : kCityscapes)
      if (table == "cityscapes" || entry.train_id != kNoTrainId) names.emplace_back(entry.name);
  if (table != "semantic-kitti") names.insert(names.end(), {"human", "vehicle"});
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

ChosenClasses parse_classes(const std::string& text) {
  const std::size_t colon = text.find(':');
  std::string table = colon == std::string::npos ? "cityscapes" : text.substr(0, colon);
  if (table == "kitti-360") table = "cityscapes";
  if (table != "cityscapes" && table != "cityscapes-train" && table != "semantic-kitti")
    throw UsageError("--classes " + text + ": there is no table '" + table +
                     "'; there are cityscapes, kitti-360, cityscapes-train and semantic-kitti");
  ChosenClasses chosen;
  for (const std::string& name : split_names(std::string_view(text).substr(colon == std::string::npos ? 0 : colon + 1))) {
    const auto number = is_all_digits(name) ? to_integer(name) : std::nullopt;
    const std::size_t before = chosen.ids.size() + chosen.colors.size();
    if (table == "semantic-kitti")
      add_semantic_kitti_class(name, chosen);
    else
      add_cityscapes_class(name, table == "cityscapes-train", chosen);
    if (number)
      chosen.ids.insert(*number);
    else if (chosen.ids.size() + chosen.colors.size() == before)
      throw UsageError(fmt::format("--classes {}: there is no class '{}' in {}; give numbers or names of {}", text, name, table,
                                   list_table_names(table)));
  }
  return chosen;
}

bool has_class_colors(const cv::Mat3b& picture) {
  std::set<int> known;
  const auto packed = [](const cv::Vec3b& color) { return color[0] | color[1] << 8 | color[2] << 16; };
  for (const ClassId& entry : kCityscapes) known.insert(packed(to_bgr(entry)));
  int last = 0;
  bool colored = false;
  for (const cv::Vec3b& color : picture) {
    if (packed(color) == last) continue;
    last = packed(color);
    if (!known.contains(last)) return false;
    colored |= last != 0;
  }
  return colored;
}

cv::Mat1b make_class_mask(const cv::Mat& picture, const ChosenClasses& classes) {
  cv::Mat1b mask(picture.size(), uchar{0});
  if (picture.type() == CV_8UC3) {
    std::transform(picture.begin<cv::Vec3b>(), picture.end<cv::Vec3b>(), mask.begin(), [&](const cv::Vec3b& color) {
      return std::find(classes.colors.begin(), classes.colors.end(), color) == classes.colors.end() ? 0 : 255;
    });
    return mask;
  }
  std::vector<uchar> chosen(1 << 16, 0);
  for (int value = 0; value < 1 << 16; ++value)
    if (classes.ids.contains(value) ||
        (value >= classes.instances_per_class && classes.ids.contains(value / classes.instances_per_class)))
      chosen[static_cast<std::size_t>(value)] = 255;
  if (picture.type() == CV_16UC1)
    std::transform(picture.begin<ushort>(), picture.end<ushort>(), mask.begin(), [&](ushort value) { return chosen[value]; });
  else
    std::transform(picture.begin<uchar>(), picture.end<uchar>(), mask.begin(), [&](uchar value) { return chosen[value]; });
  return mask;
}

bool are_kitti_ids(const std::vector<cv::Mat>& pictures) {
  std::size_t pixels = 0, without_instance = 0;
  for (const cv::Mat& picture : pictures) {
    if (picture.type() != CV_16UC1) return false;
    for (const ushort value : cv::Mat1w(picture)) {
      if (value == 0) continue;
      if (value < kKittiInstancesPerClass || value / kKittiInstancesPerClass > kCityscapes.back().id) return false;
      ++pixels;
      without_instance += value % kKittiInstancesPerClass == 0 ? 1 : 0;
    }
  }
  return pixels > 0 && 4 * without_instance >= pixels;
}

void warn_of_unknown_types(Drive& drive) {
  std::map<std::string, std::size_t> unknown;
  std::set<std::string> known;
  for (const Frame& frame : drive.frames)
    for (const Label& label : frame.labels) {
      if (is_traffic_class(label.type))
        known.insert(label.type);
      else
        ++unknown[label.type];
    }
  if (unknown.empty()) return;
  std::vector<std::string> counts, names(known.begin(), known.end());
  for (const auto& [type, count] : unknown)
    counts.push_back(fmt::format("{} {}", count, type.empty() ? "without a name" : type));
  if (names.empty())
    for (const auto& [type, count] : unknown) names.push_back(type);
  drive.warnings.push_back(fmt::format(
      "labels of classes that are not known as traffic are removed as well ({}); to remove some classes only, give them as in "
      "--classes \"{}\"",
      fmt::join(counts, ", "), fmt::join(names, ",")));
}

void keep_label_types(Drive& drive, const std::string& text) {
  std::set<std::string> types, wanted;
  std::set<int> numbers, wanted_numbers;
  for (const Frame& frame : drive.frames)
    for (const Label& label : frame.labels) types.insert(to_plain_name(label.type)), numbers.insert(label.class_number);
  bool any = types.empty();
  for (std::string name : split_names(text)) {
    const bool is_number = is_all_digits(name) && !types.contains(name);
    if (is_number && to_integer(name)) wanted_numbers.insert(*to_integer(name));
    if (is_number && types.contains("class " + name)) name = "class " + name;  // for classes without names
    wanted.insert(name);
    const bool exists = types.contains(name) || (is_number && to_integer(name) && numbers.contains(*to_integer(name)));
    any |= exists;
    if (exists) continue;
    drive.warnings.push_back(
        fmt::format("--classes {}: no label has the class '{}'; the classes are {}", text, name, fmt::join(types, ", ")));
  }
  if (!any) throw UsageError(drive.warnings.back());
  for (Frame& frame : drive.frames)
    std::erase_if(frame.labels, [&](const Label& label) {
      return !wanted.contains(to_plain_name(label.type)) && !wanted_numbers.contains(label.class_number);
    });
}

}  // namespace dvi::labels
