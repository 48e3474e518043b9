#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/cli/command.h"
#include "dvi/core/threads.h"
#include "dvi/eval/evaluate.h"

namespace dvi {

void add_eval(Program& program) {
  struct Arguments {
    std::string out, truth, ignore;
    Common common;
  };
  const auto a = std::make_shared<Arguments>();
  Command command = program.command("eval", "Metrics of a result against the truth");
  command.positional("OUT", a->out, "A result of dvi run");
  command.option("--truth", a->truth, "Folder of true frames, NAME.png", true);
  command.option("--ignore", a->ignore, "Folder of masks NAME.png, 255 = do not score");
  a->common.add_to(command, true);
  command.run([a] {
    const ThreadLimit limit(a->common.threads);
    Progress progress(a->common.style());
    progress.begin("eval", 0);
    const Evaluation evaluation = evaluate(a->out, a->truth, a->ignore, progress.tick());
    progress.end();
    for (const std::string& warning : evaluation.warnings) progress.warn(warning);
    if (a->common.json)
      fmt::print("{}\n", nlohmann::json(evaluation).dump(1));
    else
      fmt::print("{}\n", table(evaluation));
  });
}

}  // namespace dvi
