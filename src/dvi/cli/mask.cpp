#include <memory>

#include <fmt/format.h>

#include "dvi/cli/command.h"
#include "dvi/cli/job_options.h"
#include "dvi/commands/make_masks.h"
#include "dvi/core/threads.h"

namespace dvi::cli {

void add_mask(Program& program) {
  struct Arguments {
    std::string out, drive;
    JobOptions options;
    Common common;
  };
  const auto a = std::make_shared<Arguments>();
  Command command = program.command("mask", "What would be removed from a drive: masks to look at and to correct");
  command.positional("DRIVE", a->drive, "The drive");
  command.option("-o,--out", a->out, "Folder for masks/CAMERA/NAME.png, contact.png, masks.json, coco.json, annotations.xml",
                 true);
  a->options.add_to(command);
  a->common.add_to(command, true);
  command.examples({"dvi mask DRIVE -o MASKS                      look at MASKS/contact.png, correct, then",
                    "dvi run DRIVE -o OUT --masks MASKS"});
  command.run([a] {
    const ThreadLimit limit(a->common.threads);
    Progress progress(a->common.style());
    const job::Job job = a->options.job(a->out, a->drive, {});
    const std::string report = commands::make_masks(job, progress);
    progress.end();
    if (a->common.json)
      fmt::print("{}\n", report);
    else
      fmt::print("{0}/{1}contact.png  the masks on the frames\n{0}/masks        one PNG per frame: dvi run --masks {0}\n",
                 a->out, job::has_other_cameras(job.read.camera) ? "CAMERA/" : "");
  });
}

}  // namespace dvi::cli
