#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/cli/command.h"
#include "dvi/cli/job_options.h"
#include "dvi/core/json_text.h"
#include "dvi/core/threads.h"
#include "dvi/result/result_folder.h"
#include "dvi/run/run.h"

namespace dvi::cli {
namespace {

std::string json_of(const run::PlanReport& plan) {
  return json_text(nlohmann::json{{"schema", "dvi-plan/1"}, {"frames", plan.frames}, {"finished", plan.finished}});
}

std::string brief(const run::PlanReport& plan, const std::string& out) {
  return fmt::format(
      "{0} frames planned, {1} to {2}; {3} are finished\n"
      "  dvi fill {4} --frames A:B   any range, in any order, several at once\n"
      "  dvi finish {4}              when all are filled",
      plan.frames.size(), plan.frames.front(), plan.frames.back(), plan.finished, out);
}

}  // namespace

void add_plan(Program& program) {
  const auto a = std::make_shared<RunArguments>();
  Command command = program.command("plan", "Run the global stages: poses, masks, map, exposure, alignment; then fill, finish");
  a->add_to(command);
  command.run(
      [a] {
        const job::Job job = a->job("plan");
        const ThreadLimit limit(a->common.threads);
        Progress progress(a->common.style());
        const run::PlanReport plan = run::plan(job, progress);
        progress.end();
        fmt::print("{}\n", a->common.json ? json_of(plan) : brief(plan, job.out));
      },
      [a] { return result::describe_progress(a->out); });
}

}  // namespace dvi::cli
