#include "dvi/exports/exporter.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "dvi/core/draft.h"
#include "dvi/core/error.h"
#include "dvi/core/json_text.h"

namespace dvi::exports {

const std::vector<ExportFormat>& export_formats() {
  static const std::vector<ExportFormat> formats{colmap_format(), nerfstudio_format(), ply_format(),
                                                 las_format(),    ortho_format(),      mcap_format(),
                                                 video_format(),  holes_format(),      labels_format()};
  return formats;
}

const ExportFormat& find_export_format(const std::string& name) {
  std::vector<std::string> names;
  for (const ExportFormat& format : export_formats()) {
    if (format.name == name) return format;
    names.push_back(format.name);
  }
  throw UsageError(fmt::format("there is no export format '{}'; the formats are {}", name, fmt::join(names, ", ")));
}

ExportReport export_result(const ExportTask& task, const ExportFormat& format, const ExportOptions& options,
                           Progress& progress) {
  options.check();
  require_empty(task.folder, "export");
  const Result result(task.out, task.label_scans);
  const fs::path place = fs::absolute(task.folder / "").lexically_normal().parent_path();
  make_folder(place.parent_path());
  Draft draft(place, place.parent_path() / ("." + place.filename().string() + ".part"));
  make_folder(draft.path());
  progress.begin("export " + format.name, result.frames().size());
  ExportReport report = format.write(result, draft.path(), options, progress);
  progress.end();
  draft.finish();
  return report;
}

std::string to_json(const ExportReport& report, const std::string& format, const fs::path& folder) {
  nlohmann::json counts = nlohmann::json::object();
  for (const auto& [name, count] : report.counts) counts[name] = count;
  return json_text({{"schema", "dvi-export/1"},
                    {"format", format},
                    {"folder", fs::absolute(folder).lexically_normal().string()},
                    {"files", report.files},
                    {"counts", counts}});
}

std::string brief(const ExportReport& report, const fs::path& folder) {
  std::vector<std::string> lines, counts;
  for (const std::string& file : report.files) lines.push_back((folder / file).string());
  for (const auto& [name, count] : report.counts) counts.push_back(fmt::format("{} {}", count, name));
  lines.push_back(fmt::format("{}", fmt::join(counts, ", ")));
  return fmt::format("{}", fmt::join(lines, "\n"));
}

}  // namespace dvi::exports
