#include <memory>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/cli/command.h"
#include "dvi/cli/job_options.h"
#include "dvi/core/json_text.h"
#include "dvi/core/threads.h"
#include "dvi/metrics/evaluate.h"
#include "dvi/result/result_folder.h"
#include "dvi/result/write_report.h"
#include "dvi/run/run.h"
#include "dvi/run/run_stages.h"
#include "dvi/synth/synth.h"

namespace dvi::cli {
namespace {

// The street is made once; a later demo finds it.
std::string demo_street(const fs::path& out, int seed, Progress& progress) {
  const fs::path street = out / "street";
  if (!fs::exists(street / "README.txt")) {
    synth::SynthOptions options;
    options.seed = seed;
    progress.begin("synth", static_cast<std::size_t>(options.frames));
    synth::synthesize(options, street, progress.tick());
    progress.end();
  }
  return street;
}

std::string what_to_look_at(const fs::path& result, bool synthetic) {
  return fmt::format(
      "\nNow open {} in a browser.\n"
      "  Overview    the removed objects, the quality, and the least certain places\n"
      "  Frames      drag the divider between before and after; click a pixel to see where it comes from{}\n"
      "  From above  the path of the drive, and the areas that no source observed",
      (result / "report.html").string(), synthetic ? ";\n              the left side can also show the truth" : "");
}

}  // namespace

void add_demo(Program& program) {
  struct Arguments {
    std::string out = "dvi-demo", drive;
    JobOptions options;
    Common common;
    bool force = false;
  };
  const auto a = std::make_shared<Arguments>();
  Command command = program.command("demo", "Run the main job end to end, on a synthetic street if no drive is given");
  command.positional("DRIVE", a->drive, "A drive", false);
  command.option("-o,--out", a->out, "Folder for everything (default dvi-demo)");
  a->options.add_to(command);
  command.flag("--force", a->force, "Replace a result of another drive");
  a->common.add_to(command, true);
  command.run(
      [a] {
        const ThreadLimit limit(a->common.threads);
        Progress progress(a->common.style());
        const fs::path out = a->out;
        const bool synthetic = a->drive.empty();
        std::vector<PlannedStage> stages = run::plan_run_stages(a->options.job(out / "result", a->drive, {}));
        if (synthetic) stages.insert(stages.begin(), {"synth", 0.3});
        progress.plan(std::move(stages));
        const std::string drive = synthetic ? demo_street(out, a->common.seed, progress) : a->drive;
        job::Job job = a->options.job(out / "result", drive, {});
        job.force = a->force;
        const result::RunReport report = run::run(job, progress);
        progress.end();
        if (a->common.json) {
          fmt::print("{}\n", result::to_json(report));
          return;
        }
        fmt::print("{}\n", report.brief(job.out));
        if (synthetic) {
          const fs::path truth = fs::path(drive) / "truth";
          const metrics::Evaluation evaluation = metrics::evaluate({job.out, truth});
          fmt::print("\nAgainst the truth, inside the mask:\n{}\n", metrics::format_table(evaluation));
          result::show_truth(job.out, {truth, json_text(evaluation)}, progress);
        }
        fmt::print("{}\n", what_to_look_at(fs::path(job.out), synthetic));
      },
      [a] { return result::describe_progress(fs::path(a->out) / "result"); });
}

}  // namespace dvi::cli
