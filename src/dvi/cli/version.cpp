#include "dvi/core/version.h"

#include <fmt/format.h>

#include "dvi/cli/command.h"

namespace dvi::cli {

void add_version(Program& program) {
  program.command("version", "The version of dvi").run([] { fmt::print("dvi {}\n", kVersion); });
}

}  // namespace dvi::cli
