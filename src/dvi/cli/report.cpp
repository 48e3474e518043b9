#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/cli/command.h"
#include "dvi/core/json_text.h"
#include "dvi/core/threads.h"
#include "dvi/metrics/evaluate.h"
#include "dvi/result/write_report.h"

namespace dvi::cli {

void add_report(Program& program) {
  struct Arguments {
    std::string out, truth, ignore;
    Common common;
  };
  const auto a = std::make_shared<Arguments>();
  Command command = program.command("report", "Write OUT/report.html again, the result as a page to look at");
  command.positional("OUT", a->out, "A result of dvi run");
  command.option("--truth", a->truth, "Folder of true frames, NAME.png, to show beside the result");
  command.option("--ignore", a->ignore, "Folder of masks NAME.png, 255 = do not score");
  a->common.add_to(command, false, false);
  command.run([a] {
    const ThreadLimit limit(a->common.threads);
    Progress progress(a->common.style());
    result::ShownTruth truth{a->truth, {}};
    if (!a->truth.empty())
      truth.evaluation = json_text(metrics::evaluate({a->out, a->truth, a->ignore, {}}, progress.parts()), -1);
    result::write_report(a->out, truth, progress);
    fmt::print("{}/report.html  open it in a browser\n", a->out);
  });
}

}  // namespace dvi::cli
