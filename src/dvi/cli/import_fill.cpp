#include "dvi/commands/import_fill.h"

#include <memory>
#include <string>

#include <fmt/format.h>

#include "dvi/cli/command.h"
#include "dvi/core/error.h"
#include "dvi/core/threads.h"

namespace dvi::cli {

void add_import_fill(Program& program) {
  struct Arguments {
    std::string out, frames;
    bool undo = false;
    Common common;
  };
  const auto a = std::make_shared<Arguments>();
  Command command = program.command("import-fill", "Fill the unobserved pixels of a result from the frames of another program");
  command.positional("OUT", a->out, "A result of dvi run");
  command.positional("FRAMES", a->frames, "Folder of the other program's images, one per frame, PNG or JPEG", false);
  command.flag("--undo", a->undo, "Restore the frames of the run");
  a->common.add_to(command, true, false);
  command.examples({"dvi export holes OUT -o holes       frames and masks for the other program",
                    "dvi import-fill OUT holes/filled    its frames", "dvi import-fill OUT --undo          as before"});
  command.run(
      [a] {
        if (a->undo != a->frames.empty())
          throw UsageError("give either FRAMES, the folder of the other program's images, or --undo");
        const ThreadLimit limit(a->common.threads);
        Progress progress(a->common.style());
        const commands::ImportReport report =
            a->undo ? commands::undo_import(a->out, progress) : commands::import_fill(a->out, a->frames, progress);
        progress.end();
        fmt::print("{}\n", a->common.json ? commands::to_json(report, a->out) : commands::brief(report, a->out));
      },
      [] { return std::string("the same command completes the import, and --undo restores the frames of the run"); });
}

}  // namespace dvi::cli
