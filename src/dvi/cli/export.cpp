#include <memory>

#include <fmt/format.h>

#include "dvi/cli/command.h"
#include "dvi/commands/find_recorded_input.h"
#include "dvi/commands/label_scans.h"
#include "dvi/core/threads.h"
#include "dvi/exports/exporter.h"

namespace dvi::cli {
namespace {

std::string formats_for_help() {
  std::string text = "One of";
  for (const exports::ExportFormat& format : exports::export_formats())
    text += fmt::format("\n{}: {}", format.name, format.summary);
  return text;
}

}  // namespace

void add_export(Program& program) {
  struct Arguments {
    std::string format, out, place;
    exports::ExportOptions options;
    OptionTable table;
    std::vector<Assignment> given;
    Common common;
  };
  const auto a = std::make_shared<Arguments>();
  a->options.describe(a->table);
  Command command = program.command(
      "export",
      "A result in the form that other tools read: COLMAP, nerfstudio, GIS, Foxglove, SemanticKITTI; or as the recording");
  command.positional("FORMAT", a->format, formats_for_help());
  command.positional("OUT", a->out, "A result of dvi run");
  command.option("-o,--out", a->place, "Folder for the files, new or empty; for bag, a file or folder like the recording",
                 true);
  command.options(a->table, a->given);
  a->common.add_to(command, true, false);
  command.examples({"dvi export colmap OUT -o scene               for COLMAP, gsplat",
                    "dvi export ortho OUT -o above --cell-m 0.1   a GeoTIFF",
                    "dvi export video OUT -o video --beside       input and result",
                    "dvi export bag OUT -o clean.mcap             the recorded bag with clean images",
                    "dvi export folder OUT -o clean               the recorded folder with clean images",
                    "dvi export holes OUT -o holes                for an inpainting program, then dvi import-fill OUT FRAMES"});
  command.run([a] {
    const exports::ExportFormat& format = exports::find_export_format(a->format);
    exports::require_used(a->given, a->table, format);
    for (const Assignment& assignment : a->given) a->table.assign(assignment);
    const ThreadLimit limit(a->common.threads);
    Progress progress(a->common.style());
    const exports::ExportReport report = exports::export_result(
        {a->out, a->place, {commands::label_scans, commands::find_recorded_input}}, format, a->options, progress);
    fmt::print("{}\n", a->common.json ? exports::to_json(report, format.name) : exports::brief(report));
  });
}

}  // namespace dvi::cli
