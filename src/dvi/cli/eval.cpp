#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/cli/command.h"
#include "dvi/commands/evaluate_result.h"
#include "dvi/core/json_text.h"
#include "dvi/core/threads.h"
#include "dvi/metrics/evaluate.h"
#include "dvi/result/write_report.h"

namespace dvi::cli {

void add_eval(Program& program) {
  struct Arguments {
    std::string out, truth, ignore, masks, labels, points;
    std::vector<std::string> external;
    Common common;
  };
  const auto a = std::make_shared<Arguments>();
  Command command = program.command("eval", "Metrics of a result, against the truth if it is known");
  command.positional("OUT", a->out, "A result of dvi run");
  command.option("--truth", a->truth,
                 "Folder of true frames, NAME.png; without it, only artifacts, look, and ghosts are reported");
  command.option("--ignore", a->ignore, "Folder of masks NAME.png, 255 = do not score");
  command.option("--masks", a->masks, "Folder of masks NAME.png, 255 = score, instead of the masks of OUT");
  command.option("--external", a->external,
                 "NAME=DIR: score another program's frames (NAME.png or .jpg) on the same pixels; any number of times");
  command.option("--labels", a->labels,
                 "Labels of the drive with 3D boxes and tracks, for ghosts, if different from the drive's or the run's");
  command.option(
      "--points", a->points,
      "Folder of true labels of the scans' points, NAME.label (SemanticKITTI), to score the labels of dvi export labels");
  a->common.add_to(command, true);
  command.examples({"dvi eval OUT --truth CASE/truth --ignore CASE/ignore", "dvi eval OUT --labels tracking_labels.txt",
                    "dvi eval OUT --points DRIVE/truth_points"});
  command.run([a] {
    const metrics::EvaluationFolders folders{a->out, a->truth, a->ignore, metrics::parse_external(a->external), a->masks};
    const ThreadLimit limit(a->common.threads);
    Progress progress(a->common.style());
    const metrics::Evaluation evaluation = commands::evaluate_result(folders, {a->labels, a->points}, progress);
    for (const std::string& warning : evaluation.warnings) progress.warn(warning);
    if (!a->truth.empty()) result::show_truth(a->out, {a->truth, json_text(evaluation)}, progress);
    if (a->common.json)
      fmt::print("{}\n", json_text(evaluation));
    else
      fmt::print("{}\n", metrics::format_table(evaluation));
  });
}

}  // namespace dvi::cli
