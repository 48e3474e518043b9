#include "dvi/commands/selfcheck.h"

#include <memory>

#include <fmt/format.h>

#include "dvi/cli/command.h"
#include "dvi/cli/job_options.h"
#include "dvi/core/threads.h"
#include "dvi/metrics/evaluate.h"

namespace dvi::cli {

void add_selfcheck(Program& program) {
  struct Arguments {
    std::string out = "dvi-selfcheck", drive;
    std::vector<std::string> scenarios = {"lead", "oncoming", "crossing", "parked"}, external;
    JobOptions options;
    Common common;
  };
  const auto a = std::make_shared<Arguments>();
  Command command = program.command("selfcheck", "Score dvi on a drive: insert virtual traffic, remove it, compare");
  command.positional("DRIVE", a->drive, "The drive");
  command.option("-o,--out", a->out, "Folder for cases and results (default dvi-selfcheck)");
  command.option("--scenario", a->scenarios,
                 "lead, oncoming, crossing, parked (these by default), truck, far, banner; any number of times");
  command.option("--external", a->external,
                 "NAME=DIR: also score another program's frames, DIR/SCENARIO/NAME.png or .jpg; repeatable");
  a->options.add_to(command);
  a->common.add_to(command, true);
  command.run(
      [a] {
        std::vector<holdout::Scenario> scenarios;
        for (const std::string& scenario : a->scenarios) scenarios.push_back(holdout::parse_scenario(scenario));
        const std::vector<metrics::ExternalFrames> external = metrics::parse_external(a->external);
        const ThreadLimit limit(a->common.threads);
        Progress progress(a->common.style());
        const commands::SelfcheckReport report =
            commands::selfcheck(a->options.job(a->out, a->drive, {}), {scenarios, external, a->common.seed}, progress);
        fmt::print("{}\n", a->common.json ? report.json : report.text);
      },
      [] { return "finished scenarios and frames are kept, the same command does the rest"; });
}

}  // namespace dvi::cli
