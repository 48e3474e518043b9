#include <memory>

#include <fmt/format.h>

#include "dvi/cli/command.h"
#include "dvi/cli/job_options.h"

namespace dvi::cli {

void add_config(Program& program) {
  Command command = program.command("config", "The options");
  const auto options = std::make_shared<JobOptions>();
  const auto all = std::make_shared<bool>(false), markdown = std::make_shared<bool>(false);
  Command dump = command.subcommand("dump", "The options with their values and meaning, as TOML for --config");
  options->add_to(dump);
  dump.flag("--all", *all, "Developer options too: for ablations and tuning");
  dump.flag("--markdown", *markdown, "As a table in Markdown, for docs/reference.md");
  dump.run([options, all, markdown] {
    const auto listed = [&](const Option& option) { return *all || option.audience == Audience::user; };
    job::Job job = options->job("", "", {});
    fmt::print("{}", *markdown ? job.table().dump_markdown(listed) : job.table().dump_toml(listed));
  });
}

}  // namespace dvi::cli
