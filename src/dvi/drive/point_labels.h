#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "dvi/core/cache_budget.h"

namespace dvi {

/// The labels of the returns of one scan, in the form of SemanticKITTI: the class in the lower 16 bits, the instance in the
/// upper ones.
struct PointLabels {
  std::vector<std::uint32_t> values;  ///< one per return; 0: not removed

  std::size_t bytes() const { return bytes_of(values); }
};

/// A class of traffic in the labels of SemanticKITTI, with the id of its stationary and of its moving objects; 0: none.
struct PointClass {
  int stationary = 0, moving = 0;
  std::string_view type;  ///< the name in Label::type; empty: unknown
};
inline constexpr std::array kPointClasses = std::to_array<PointClass>({
    {10, 252, "car"},
    {11, 0, "bicycle"},
    {13, 257, "bus"},
    {15, 0, "motorcycle"},
    {16, 256, "train"},
    {18, 258, "truck"},
    {20, 259, "vehicle"},
    {30, 254, "person"},
    {31, 253, "bicyclist"},
    {32, 255, "motorcyclist"},
    {0, 251, ""},  // moving object segmentation does not distinguish classes
});

/// The class of points that do not move, as moving object segmentation writes it.
inline constexpr std::uint32_t kStaticPointClass = 9;

constexpr int class_of_point(std::uint32_t value) { return static_cast<int>(value & 0xFFFFU); }

/// Returns whether a class id is one of moving objects.
constexpr bool is_moving_point_class(int id) { return id >= 251 && id <= 259; }

/// Returns the class of traffic with this id; null for other ids.
constexpr const PointClass* find_point_class(int id) {
  for (const PointClass& entry : kPointClasses)
    if (id != 0 && (id == entry.stationary || id == entry.moving)) return &entry;
  return nullptr;
}

/// Names of classes in labels of other data sets, each with the name in kPointClasses.
inline constexpr std::array kPointClassSynonyms = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"van", "car"},
    {"pedestrian", "person"},
    {"person_sitting", "person"},
    {"person (sitting)", "person"},
    {"cyclist", "bicyclist"},
    {"rider", "bicyclist"},
    {"motorbike", "motorcycle"},
    {"coach", "bus"},
    {"tram", "train"},
});

/// Returns the class of traffic of a Label::type; that of other vehicles for unknown types.
constexpr const PointClass& point_class_of(std::string_view type) {
  constexpr std::size_t kOtherVehicle = 6;
  static_assert(kPointClasses[kOtherVehicle].type == "vehicle");
  for (const auto& [synonym, name] : kPointClassSynonyms)
    if (type == synonym) type = name;
  for (const PointClass& entry : kPointClasses)
    if (!type.empty() && type == entry.type) return entry;
  return kPointClasses[kOtherVehicle];
}

/// Returns the id of an object by its Label::type, and by whether it moves. Two-wheelers that move have riders.
constexpr int point_class_id(std::string_view type, bool moves) {
  if (moves && type == "bicycle") type = "bicyclist";
  if (moves && type == "motorcycle") type = "motorcyclist";
  const PointClass& entry = point_class_of(type);
  return moves ? entry.moving : entry.stationary;
}

}  // namespace dvi
