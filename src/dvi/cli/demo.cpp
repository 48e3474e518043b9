#include <memory>

#include <fmt/format.h>

#include "dvi/cli/command.h"
#include "dvi/cli/job_options.h"
#include "dvi/core/threads.h"
#include "dvi/metrics/evaluate.h"
#include "dvi/pipeline/result_folder.h"
#include "dvi/pipeline/run.h"
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
    synth::synthesise(options, street, progress.tick());
    progress.end();
  }
  return street;
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
        const std::string drive = synthetic ? demo_street(out, a->common.seed, progress) : a->drive;
        pipeline::Job job = a->options.job(out / "result", drive, {});
        job.force = a->force;
        const pipeline::RunReport report = pipeline::run(job, progress);
        progress.end();
        fmt::print("{}\n", a->common.json ? to_json(report) : report.brief(job.out));
        if (synthetic && !a->common.json)
          fmt::print("\nAgainst the truth, inside the mask:\n{}\n",
                     metrics::table(metrics::evaluate({job.out, fs::path(drive) / "truth"})));
      },
      [a] { return pipeline::kept_in(fs::path(a->out) / "result"); });
}

}  // namespace dvi::cli
