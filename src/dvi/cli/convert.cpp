#include "dvi/commands/convert.h"

#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/cli/command.h"
#include "dvi/core/threads.h"
#include "dvi/job/request.h"

namespace dvi::cli {

void add_convert(Program& program) {
  struct Arguments {
    std::string drive, out;
    job::Request request;
    bool one_camera = false;
    Common common;
  };
  const auto a = std::make_shared<Arguments>();
  Command command = program.command("convert", "Any recording, or a range of it, as a drive in the folder layout");
  command.positional("DRIVE", a->drive, "The recording");
  command.option("-o,--out", a->out, "Folder of the new drive", true);
  job::Job defaults;
  command.options(defaults.table(), a->request.assignments, {"job.camera", "job.topics", "job.frames"});
  command.flag("--one-camera", a->one_camera, "Leave the other cameras out");
  a->common.add_to(command, false, false);
  command.run([a] {
    const ThreadLimit limit(a->common.threads);
    Progress progress(a->common.style());
    const job::ReadChoice choice = a->request.job("", "", {}).read;
    job::require_one_camera(choice.camera, "dvi convert");
    datasets::ReadOptions read{.camera = choice.camera};
    read.topics = choice.topics;
    if (!choice.frames.empty()) read.frames = job::parse_frames(choice.frames);
    const commands::ConvertReport report = commands::convert({a->drive, read, !a->one_camera}, a->out, progress);
    fmt::print("{}: {} images of {}, {} scans, from {} frames {}:{}\n", a->out, report.images, fmt::join(report.cameras, ", "),
               report.scans, report.format, report.first_frame, report.last_frame);
  });
}

}  // namespace dvi::cli
