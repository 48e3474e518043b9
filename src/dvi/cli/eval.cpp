#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/cli/command.h"
#include "dvi/core/json_text.h"
#include "dvi/core/threads.h"
#include "dvi/metrics/evaluate.h"
#include "dvi/result/write_report.h"

namespace dvi::cli {

void add_eval(Program& program) {
  struct Arguments {
    std::string out, truth, ignore, masks;
    std::vector<std::string> external;
    Common common;
  };
  const auto a = std::make_shared<Arguments>();
  Command command = program.command("eval", "Metrics of a result against the truth");
  command.positional("OUT", a->out, "A result of dvi run");
  command.option("--truth", a->truth, "Folder of true frames, NAME.png", true);
  command.option("--ignore", a->ignore, "Folder of masks NAME.png, 255 = do not score");
  command.option("--masks", a->masks, "Folder of masks NAME.png, 255 = score, instead of the masks of OUT");
  command.option("--external", a->external,
                 "NAME=DIR: score another program's frames (NAME.png or .jpg) on the same pixels; any number of times");
  a->common.add_to(command, true);
  command.examples({"dvi eval OUT --truth CASE/truth --ignore CASE/ignore"});
  command.run([a] {
    const metrics::EvaluationFolders folders{a->out, a->truth, a->ignore, metrics::parse_external(a->external), a->masks};
    const ThreadLimit limit(a->common.threads);
    Progress progress(a->common.style());
    const metrics::Evaluation evaluation = metrics::evaluate(folders, progress.parts());
    progress.end();
    for (const std::string& warning : evaluation.warnings) progress.warn(warning);
    result::show_truth(a->out, {a->truth, json_text(evaluation)}, progress);
    if (a->common.json)
      fmt::print("{}\n", json_text(evaluation));
    else
      fmt::print("{}\n", metrics::format_table(evaluation));
  });
}

}  // namespace dvi::cli
