#include "dvi/synth/synth.h"

#include <memory>

#include <fmt/format.h>

#include "dvi/cli/command.h"
#include "dvi/core/threads.h"

namespace dvi::cli {

void add_synth(Program& program) {
  struct Arguments {
    std::string out, config;
    std::vector<Assignment> given;
    synth::SynthOptions options;
    OptionTable table;
    Common common;
  };
  const auto a = std::make_shared<Arguments>();
  a->options.describe(a->table);
  Command command = program.command("synth", "A synthetic street, or room, with exact truth, as a drive in the folder layout");
  command.option("-o,--out", a->out, "Folder of the drive", true);
  command.options(a->table, a->given);
  command.option_file(a->config, a->given);
  a->common.add_to(command, false, false);  // its seed is an option of the street
  command.examples({"dvi synth -o street --frames 20", "dvi synth -o room --room"});
  command.run([a] {
    if (!a->config.empty()) a->table.load_toml(a->config);
    for (const Assignment& assignment : a->given) a->table.assign(assignment);
    const ThreadLimit limit(a->common.threads);
    Progress progress(a->common.style());
    progress.begin("synth", static_cast<std::size_t>(a->options.frames));
    synth::synthesize(a->options, a->out, progress.tick());
    progress.end();
    fmt::print("{0}          the drive\n{0}/truth    the same frames without traffic\n", a->out);
  });
}

}  // namespace dvi::cli
