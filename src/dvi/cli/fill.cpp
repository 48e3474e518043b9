#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/cli/command.h"
#include "dvi/cli/job_options.h"
#include "dvi/core/json_text.h"
#include "dvi/core/threads.h"
#include "dvi/result/result_folder.h"
#include "dvi/run/run.h"

namespace dvi::cli {

void add_fill(Program& program) {
  struct Arguments {
    std::string out;
    job::Request frames;
    Common common;
  };
  const auto a = std::make_shared<Arguments>();
  Command command = program.command("fill", "Fill frames of a plan: any range, on any machine, several ranges at once");
  command.positional("OUT", a->out, "Folder that dvi plan wrote");
  job::Job defaults;
  command.options(defaults.table(), a->frames.assignments, {"job.frames"});
  a->common.add_to(command, true);
  command.run(
      [a] {
        std::optional<FrameRange> range;
        const std::string frames = a->frames.job("", "", {}).read.frames;
        if (!frames.empty()) range = job::parse_frames(frames);
        const job::Job job = planned_job(a->out);
        const ThreadLimit limit(a->common.threads);
        Progress progress(a->common.style());
        const run::FillReport fill = run::fill(job, range, progress);
        progress.end();
        const nlohmann::json json{{"schema", "dvi-fill/1"}, {"frames", fill.frames}, {"filled", fill.filled}};
        fmt::print("{}\n", a->common.json ? json_text(json)
                                          : fmt::format("{} frames filled, {} were finished before", fill.filled,
                                                        fill.frames - fill.filled));
      },
      [a] { return result::describe_progress(a->out); });
}

}  // namespace dvi::cli
