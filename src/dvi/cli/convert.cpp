#include "dvi/commands/convert.h"

#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/cli/command.h"
#include "dvi/core/threads.h"
#include "dvi/job/job.h"

namespace dvi::cli {

void add_convert(Program& program) {
  struct Arguments {
    std::string drive, out, camera, frames;
    std::vector<std::string> topics;
    bool one_camera = false;
    Common common;
  };
  const auto a = std::make_shared<Arguments>();
  Command command = program.command("convert", "Any recording, or a range of it, as a drive in the folder layout");
  command.positional("DRIVE", a->drive, "The recording");
  command.option("-o,--out", a->out, "Folder of the new drive", true);
  command.option("--frames", a->frames, "A:B: only these frames, inclusive, by the recording's own numbers");
  command.option("--camera", a->camera, "The camera that is used where none is asked for (default: the recording's first)");
  command.option("--topic", a->topics, "Of a bag: image=TOPIC, points=TOPIC, depth=TOPIC, info=TOPIC, poses=TOPIC, repeatable");
  command.flag("--one-camera", a->one_camera, "Leave the other cameras out");
  a->common.add_to(command, false, false);
  command.run([a] {
    const ThreadLimit limit(a->common.threads);
    Progress progress(a->common.style());
    datasets::ReadOptions read{.camera = a->camera};
    read.topics = a->topics;
    if (!a->frames.empty()) read.frames = job::parse_frames(a->frames);
    const commands::ConvertReport report = commands::convert({a->drive, read, !a->one_camera}, a->out, progress);
    fmt::print("{}: {} images of {}, {} scans, from {} frames {}:{}\n", a->out, report.images, fmt::join(report.cameras, ", "),
               report.scans, report.format, report.first_frame, report.last_frame);
  });
}

}  // namespace dvi::cli
