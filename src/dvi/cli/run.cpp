#include "dvi/pipeline/run.h"

#include <memory>

#include <fmt/format.h>

#include "dvi/cli/command.h"
#include "dvi/cli/job_options.h"
#include "dvi/core/error.h"
#include "dvi/core/threads.h"
#include "dvi/pipeline/result_folder.h"

namespace dvi::cli {

void add_run(Program& program) {
  struct Arguments {
    std::string out, target;
    std::vector<std::string> sources;
    JobOptions options;
    Common common;
    bool force = false;
  };
  const auto a = std::make_shared<Arguments>();
  Command command = program.command("run", "Remove the traffic from a drive");
  command.positional("TARGET", a->target, "The drive to clean", false);
  command.positional("SOURCE", a->sources, "Source drives of the same street to copy pixels from");
  command.option("-o,--out", a->out, "Folder of the result");
  a->options.add_to(command);
  command.flag("--force", a->force, "Replace a result of another drive");
  a->common.add_to(command, true);
  command.run(
      [a] {
        pipeline::Job job = a->options.job(a->out, a->target, a->sources);
        job.force = a->force;
        a->out = job.out;
        if (job.target.empty()) throw UsageError("dvi run needs a drive: dvi run TARGET -o OUT");
        if (job.out.empty()) throw UsageError("dvi run needs a folder for the result: -o OUT");
        const ThreadLimit limit(a->common.threads);
        Progress progress(a->common.style());
        const pipeline::RunReport report = pipeline::run(job, progress);
        progress.end();
        fmt::print("{}\n", a->common.json ? pipeline::to_json(report) : report.brief(job.out));
      },
      [a] { return pipeline::kept_in(a->out); });
}

}  // namespace dvi::cli
