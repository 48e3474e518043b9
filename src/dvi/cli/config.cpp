#include <memory>

#include <fmt/format.h>

#include "dvi/cli/command.h"
#include "dvi/cli/job_options.h"

namespace dvi::cli {

void add_config(Program& program) {
  Command command = program.command("config", "The options");
  const auto options = std::make_shared<JobOptions>();
  Command dump = command.subcommand("dump", "Every option with its default and meaning, as TOML for --config");
  options->add_to(dump);
  dump.run([options] { fmt::print("{}", options->job("", "", {}).table().dump_toml()); });
}

}  // namespace dvi::cli
