#include <memory>

#include <fmt/format.h>

#include "dvi/cli/command.h"
#include "dvi/cli/job_options.h"
#include "dvi/commands/make_holdout.h"
#include "dvi/core/threads.h"

namespace dvi::cli {

void add_holdout(Program& program) {
  struct Arguments {
    std::string out, drive, scenario = "lead", mask_errors = "none";
    JobOptions options;
    Common common;
  };
  const auto a = std::make_shared<Arguments>();
  Command command = program.command("holdout", "Insert virtual traffic into a real drive and keep the true background");
  command.positional("DRIVE", a->drive, "The drive");
  command.option("-o,--out", a->out, "Folder of the case: drive/, truth/, truth_masks/, ignore/, holdout.json", true);
  command.option("--scenario", a->scenario, "lead (default), oncoming, crossing, parked, truck, far or banner");
  command.option("--mask-errors", a->mask_errors,
                 "Errors in the masks of the virtual traffic: none (default), miss, burst, late, tight, boxes or false");
  a->options.add_to(command);
  a->common.add_to(command, true);
  command.examples(
      {"dvi holdout DRIVE -o CASE && dvi run CASE/drive -o OUT && dvi eval OUT --truth CASE/truth --ignore CASE/ignore"});
  command.run([a] {
    holdout::HoldoutOptions options{holdout::parse_scenario(a->scenario), a->common.seed};
    options.mask_errors = holdout::parse_mask_errors(a->mask_errors);
    const ThreadLimit limit(a->common.threads);
    Progress progress(a->common.style());
    commands::make_holdout(a->options.job(a->out, a->drive, {}), options, progress);
    if (a->common.json)
      fmt::print("{}", read_file(fs::path(a->out) / "holdout.json"));
    else
      fmt::print(
          "{0}/drive        the drive with virtual traffic\n{0}/truth        its frames without\n"
          "{0}/truth_masks  the pixels of the virtual traffic\n{0}/ignore       what not to score\n"
          "Next: dvi run {0}/drive -o OUT\n"
          "      dvi eval OUT --truth {0}/truth --ignore {0}/ignore{1}\n"
          "OUT/report.html then shows each frame beside the truth, and the difference.\n",
          a->out, options.mask_errors == holdout::MaskErrors::none ? "" : fmt::format(" --masks {}/truth_masks", a->out));
  });
}

}  // namespace dvi::cli
