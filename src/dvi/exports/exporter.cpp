#include "dvi/exports/exporter.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "dvi/core/draft.h"
#include "dvi/core/error.h"
#include "dvi/core/json_text.h"

namespace dvi::exports {

const std::vector<ExportFormat>& export_formats() {
  static const std::vector<ExportFormat> formats{colmap_format(), nerfstudio_format(), ply_format(),   las_format(),
                                                 ortho_format(),  mcap_format(),       video_format(), holes_format(),
                                                 labels_format(), bag_format(),        folder_format()};
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

void require_used(const std::vector<Assignment>& given, const OptionTable& table, const ExportFormat& format) {
  for (const Assignment& assignment : given) {
    const std::string name = table.find(assignment.option).name();
    if (format.uses(name)) continue;
    std::vector<std::string> users;
    for (const ExportFormat& other : export_formats())
      if (other.uses(name)) users.push_back(other.name);
    throw UsageError(fmt::format("dvi export {} has no option {}, which is one of {}", format.name, assignment.option,
                                 fmt::join(users, ", ")));
  }
}

ExportReport export_result(const ExportTask& task, const ExportFormat& format, const ExportOptions& options,
                           Progress& progress) {
  options.check();
  const Result result(task.out, task.from);
  const fs::path place = fs::absolute(task.place / "").lexically_normal().parent_path();
  const bool is_file = format.is_file && format.is_file(result, options, place);
  if (!is_file) require_empty(task.place, "export");
  make_folder(place.parent_path());
  Draft draft(place, is_file ? temporary_beside(place) : place.parent_path() / ("." + place.filename().string() + ".part"));
  if (!is_file) make_folder(draft.path());
  progress.begin("export " + format.name, result.frames().size());
  ExportReport report = format.write(result, draft.path(), options, progress);
  progress.end();
  draft.finish();
  report.folder = is_file ? task.place.parent_path() / "." : task.place;
  report.warnings = progress.warnings();
  if (is_file) report.files = {task.place.filename()};
  return report;
}

std::string to_json(const ExportReport& report, const std::string& format) {
  nlohmann::json counts = nlohmann::json::object();
  for (const auto& [name, count] : report.counts) counts[name] = count;
  return json_text({{"schema", "dvi-export/1"},
                    {"format", format},
                    {"folder", fs::absolute(report.folder / "").lexically_normal().parent_path().string()},
                    {"files", report.files},
                    {"counts", counts},
                    {"warnings", report.warnings}});
}

std::string brief(const ExportReport& report) {
  std::vector<std::string> lines, counts;
  for (const std::string& file : report.files) lines.push_back((report.folder / file).lexically_normal().string());
  if (lines.empty()) lines.push_back(report.folder.string());
  for (const auto& [name, count] : report.counts) counts.push_back(fmt::format("{} {}", count, name));
  lines.push_back(fmt::format("{}", fmt::join(counts, ", ")));
  return fmt::format("{}", fmt::join(lines, "\n"));
}

}  // namespace dvi::exports
