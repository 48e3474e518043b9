#include "dvi/run/run.h"

#include <memory>

#include <fmt/format.h>

#include "dvi/cli/command.h"
#include "dvi/cli/job_options.h"
#include "dvi/core/threads.h"
#include "dvi/result/result_folder.h"

namespace dvi::cli {

void add_run(Program& program) {
  const auto a = std::make_shared<RunArguments>();
  Command command = program.command("run", "Remove the traffic from a drive");
  a->add_to(command);
  command.examples({"dvi run DRIVE -o OUT                         what its masks, labels or scans say",
                    "dvi run DRIVE -o OUT --masks MASKS           what your masks say",
                    "dvi run DRIVE OTHER -o OUT                   also copy from another drive of the street",
                    "dvi run --config OUT/dvi.toml -o AGAIN       the same once more"});
  command.run(
      [a] {
        const job::Job job = a->job("run");
        const ThreadLimit limit(a->common.threads);
        Progress progress(a->common.style());
        const result::RunReport report = run::run(job, progress);
        progress.end();
        fmt::print("{}\n", a->common.json ? result::to_json(report) : report.brief(job.out));
      },
      [a] { return result::describe_progress(a->out); });
}

}  // namespace dvi::cli
