#include "dvi/commands/estimate_coverage.h"

#include <memory>

#include <fmt/format.h>

#include "dvi/cli/command.h"
#include "dvi/cli/job_options.h"
#include "dvi/core/threads.h"

namespace dvi::cli {

void add_forecast(Program& program) {
  struct Arguments {
    std::string out, drive;
    std::vector<std::string> sources;
    JobOptions options;
    Common common;
  };
  const auto a = std::make_shared<Arguments>();
  Command command =
      program.command("forecast", "Compute the coverage of each hole, the share that sources observe, without filling");
  command.positional("DRIVE", a->drive, "The drive");
  command.positional("SOURCE", a->sources, "Source drives of the same street");
  command.option("-o,--out", a->out, "Folder for forecast.png, a chart");
  a->options.add_to(command);
  a->common.add_to(command, true);
  command.run([a] {
    const ThreadLimit limit(a->common.threads);
    Progress progress(a->common.style());
    const commands::CoverageReport report = commands::estimate_coverage(a->options.job(a->out, a->drive, a->sources), progress);
    progress.end();
    fmt::print("{}\n", a->common.json ? commands::to_json(report) : report.table());
  });
}

}  // namespace dvi::cli
