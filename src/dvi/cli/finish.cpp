#include <memory>

#include <fmt/format.h>

#include "dvi/cli/command.h"
#include "dvi/cli/job_options.h"
#include "dvi/core/threads.h"
#include "dvi/result/result_folder.h"
#include "dvi/run/run.h"

namespace dvi::cli {

void add_finish(Program& program) {
  struct Arguments {
    std::string out;
    Common common;
  };
  const auto a = std::make_shared<Arguments>();
  Command command = program.command("finish", "Complete a plan whose frames are filled: map, video, report");
  command.positional("OUT", a->out, "Folder that dvi plan wrote");
  a->common.add_to(command, true);
  command.run(
      [a] {
        const job::Job job = planned_job(a->out);
        const ThreadLimit limit(a->common.threads);
        Progress progress(a->common.style());
        const result::RunReport report = run::finish(job, progress);
        progress.end();
        fmt::print("{}\n", a->common.json ? result::to_json(report) : report.brief(job.out));
      },
      [a] { return result::describe_progress(a->out); });
}

}  // namespace dvi::cli
