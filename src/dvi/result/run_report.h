#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"
#include "dvi/core/progress.h"
#include "dvi/result/cpu_clock.h"

namespace dvi::result {

/// Numbers of pixels of a hole by origin. In JSON, `share` has them as shares of the hole, 0 to 1, and `unobserved`, the share
/// of pixels that no source observed, for every kind of filling.
struct HoleReport {
  std::size_t pixels = 0, copied = 0, copied_elsewhere = 0, interpolated = 0, synthesized = 0, empty = 0, imported = 0;

  std::size_t unobserved() const { return interpolated + synthesized + empty + imported; }
  /// Returns the share of the hole, 0 to 1; 0 for an empty hole.
  double share(std::size_t count) const { return pixels > 0 ? static_cast<double>(count) / static_cast<double>(pixels) : 0.0; }
  HoleReport& operator+=(const HoleReport& other);
};
void to_json(nlohmann::json& json, const HoleReport& hole);
void from_json(const nlohmann::json& json, HoleReport& hole);

/// Counts the pixels of a frame by their harmonize::Kind.
HoleReport count_hole(const cv::Mat1b& kind);

/// The cost of a result in all processes that computed it.
struct CostReport {
  std::vector<StageTime> stages;
  std::map<std::string, double> fill_cpu_seconds;  ///< by stage of the fill
  std::size_t frames_made = 0;
  std::size_t peak_memory_bytes = 0;

  /// Adds the cost of another process for the same result.
  CostReport& operator+=(const CostReport& other);
};
void to_json(nlohmann::json& json, const CostReport& report);
void from_json(const nlohmann::json& json, CostReport& report);

/// Returns the cost of a run until now.
CostReport make_cost_report(const Progress& progress, const CpuClock& clock, std::size_t frames_made);

/// Returns the name of a frame in the result (core/frame_name.h) by its entry in report.json.
std::string frame_name(const nlohmann::json& frame);

/// The report of a run: the document report.json, which docs/reference.md describes.
class RunReport {
 public:
  static constexpr const char* kSchema = "dvi-report/1";

  explicit RunReport(nlohmann::json document);

  const nlohmann::json& document() const { return *document_; }
  std::vector<std::string> frame_names() const;
  /// Returns the indices of the frames in order of their numbers, which are those of time.
  std::vector<std::size_t> frame_order() const;

  /// Returns a summary of a few lines: the shares of the hole by origin, registration, cost, and the files in `out`.
  std::string brief(const std::string& out) const;

 private:
  std::shared_ptr<const nlohmann::json> document_;
};

/// Returns the text of report.json.
std::string to_json(const RunReport& report);

/// Reads report.json; none if the file is missing or damaged.
std::optional<RunReport> read_run_report(const fs::path& file);

}  // namespace dvi::result
