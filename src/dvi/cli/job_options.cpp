#include "dvi/cli/job_options.h"

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/result/plan_manifest.h"
#include "dvi/result/section_folder.h"

namespace dvi::cli {

void JobOptions::add_to(Command& command) {
  job::Job defaults;
  command.options(defaults.table(), assignments);
  command.option_file(config, assignments);
}

void RunArguments::add_to(Command& command) {
  command.positional("TARGET", target, "The drive to clean", false);
  command.positional("SOURCE", sources, "Source drives of the same street to copy pixels from");
  command.option("-o,--out", out, "Folder of the result");
  options.add_to(command);
  command.flag("--force", force, "Replace a result of another drive");
  common.add_to(command, true);
}

job::Job RunArguments::job(const std::string& command) {
  job::Job job = options.job(out, target, sources);
  job.force = force;
  out = job.out;
  if (job.target.empty()) throw UsageError(fmt::format("dvi {0} needs a drive: dvi {0} TARGET -o OUT", command));
  if (job.out.empty()) throw UsageError(fmt::format("dvi {} needs a folder for the result: -o OUT", command));
  return job;
}

job::Job planned_job(const std::string& out) {
  result::read_plan(out);
  const job::Request request{(fs::path(out) / "dvi.toml").string(), {}};
  return request.job(fs::absolute(out).lexically_normal().string(), "", {});
}

job::Job sectioned_job(const std::string& out) {
  const std::size_t sections = result::find_planned_sections(out);
  const fs::path options = result::options_of_whole(result::section_folder(out, 1, sections));
  const job::Request request{options.string(), {}};
  return request.job(fs::absolute(out).lexically_normal().string(), "", {});
}

}  // namespace dvi::cli
