#include <memory>
#include <string>

#include <fmt/format.h>

#include "dvi/cli/command.h"
#include "dvi/cli/job_options.h"
#include "dvi/cli/plan_text.h"
#include "dvi/core/threads.h"
#include "dvi/result/result_folder.h"
#include "dvi/run/run.h"

namespace dvi::cli {

void add_join(Program& program) {
  struct Arguments {
    std::string out;
    Common common;
  };
  const auto a = std::make_shared<Arguments>();
  Command command =
      program.command("join", "Join the plans of all sections of a drive (dvi plan --section); then fill, finish");
  command.positional("OUT", a->out, "Folder that dvi plan --section wrote");
  a->common.add_to(command, true);
  command.run(
      [a] {
        const job::Job job = sectioned_job(a->out);
        const ThreadLimit limit(a->common.threads);
        Progress progress(a->common.style());
        const run::PlanReport plan = run::join(job, progress);
        progress.end();
        fmt::print("{}\n", a->common.json ? json_of(plan) : brief_plan(plan, job.out));
      },
      [a] { return result::describe_progress(a->out); });
}

}  // namespace dvi::cli
