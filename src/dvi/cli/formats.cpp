#include <fmt/format.h>

#include "dvi/cli/command.h"
#include "dvi/datasets/reader.h"

namespace dvi::cli {

void add_formats(Program& program) {
  program.command("formats", "The layouts of recordings that dvi reads").run([] {
    for (const datasets::DriveFormat& format : datasets::drive_formats())
      fmt::print("{:<14} {}\n", format.name, format.summary);
  });
}

}  // namespace dvi::cli
