#include "dvi/commands/check.h"

#include <memory>

#include <fmt/format.h>

#include "dvi/cli/command.h"
#include "dvi/cli/job_options.h"
#include "dvi/core/error.h"
#include "dvi/core/threads.h"

namespace dvi::cli {

void add_check(Program& program) {
  struct Arguments {
    std::string drive, out;
    JobOptions options;
    Common common;
    bool coverage = false;
  };
  const auto a = std::make_shared<Arguments>();
  Command command = program.command("check", "Describe a drive: is it complete and consistent, which data are missing");
  command.positional("DRIVE", a->drive, "The drive");
  command.option("-o,--out", a->out, "Folder for pictures: the LiDAR on three images, and the drive from above");
  command.flag("--coverage", a->coverage, "Also compute the share of the holes that sources observe, which takes much longer");
  a->options.add_to(command);
  a->common.add_to(command, true);
  command.examples({"dvi check DRIVE", "dvi check DRIVE --frames 10:49 --json"});
  command.run([a] {
    const ThreadLimit limit(a->common.threads);
    Progress progress(a->common.style());
    const commands::CheckReport report = commands::check(a->options.job(a->out, a->drive, {}), a->coverage, progress);
    progress.end();
    fmt::print("{}\n", a->common.json ? commands::to_json(report) : report.brief());
    if (!report.ready) throw InputError(a->drive, "is not ready for dvi run", "see the warnings of the report");
  });
}

}  // namespace dvi::cli
