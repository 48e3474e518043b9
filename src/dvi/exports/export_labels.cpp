#include <algorithm>
#include <cstring>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "dvi/core/threads.h"
#include "dvi/drive/point_labels.h"
#include "dvi/exports/exporter.h"

namespace dvi::exports {
namespace {

std::string to_bytes(const PointLabels& labels) {
  std::string bytes(labels.values.size() * sizeof(std::uint32_t), '\0');
  std::memcpy(bytes.data(), labels.values.data(), bytes.size());
  return bytes;
}

// Returns the name that SemanticKITTI gives to a class.
std::string_view name_of(const PointClass& entry) {
  return entry.type == "train" ? "on-rails" : entry.type == "vehicle" ? "other-vehicle" : entry.type;
}

// Names the classes in the form of the configuration files of SemanticKITTI's tools.
std::string format_class_names() {
  std::string text = "labels:\n  0: \"unlabeled\"\n";
  for (const PointClass& entry : kPointClasses)
    if (!entry.type.empty()) text += fmt::format("  {}: \"{}\"\n", entry.stationary, name_of(entry));
  for (const PointClass& entry : kPointClasses)
    if (!entry.type.empty() && entry.moving != 0) text += fmt::format("  {}: \"moving-{}\"\n", entry.moving, name_of(entry));
  return text;
}

struct LabelCounts {
  std::size_t points = 0, stationary = 0, moving = 0;
};

LabelCounts count_labels(const PointLabels& labels) {
  LabelCounts counts{.points = labels.values.size()};
  for (const std::uint32_t value : labels.values)
    ++(is_moving_point_class(class_of_point(value)) ? counts.moving : counts.stationary);
  counts.stationary -= static_cast<std::size_t>(std::count(labels.values.begin(), labels.values.end(), 0U));
  return counts;
}

ExportReport write_labels(const Result& result, const fs::path& folder, const ExportOptions&, Progress& progress) {
  const LabeledScans scans = result.label_scans(progress);
  progress.begin("labels", scans.names.size());
  std::vector<LabelCounts> counts(scans.names.size());
  parallel_for(scans.names.size(), [&](std::size_t i) {
    const auto labels = scans.labels[i];
    write_file(folder / (scans.names[i] + ".label"), to_bytes(*labels));
    counts[i] = count_labels(*labels);
    progress.advance();
  });
  progress.end();
  write_file(folder / "labels.yaml", format_class_names());
  LabelCounts total;
  for (const LabelCounts& scan : counts) {
    total.points += scan.points;
    total.moving += scan.moving;
    total.stationary += scan.stationary;
  }
  return {{"labels.yaml"},
          {{"scans", static_cast<double>(counts.size())},
           {"points", static_cast<double>(total.points)},
           {"points of moving objects", static_cast<double>(total.moving)},
           {"points of other objects", static_cast<double>(total.stationary)}}};
}

}  // namespace

ExportFormat labels_format() {
  return {"labels", "NAME.label per scan, the classes of its points (SemanticKITTI, moving object segmentation, map cleaning)",
          write_labels};
}

}  // namespace dvi::exports
