#include "dvi/run/make_map.h"

#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "dvi/cli/command.h"
#include "dvi/cli/job_options.h"
#include "dvi/core/threads.h"

namespace dvi::cli {

void add_map(Program& program) {
  struct Arguments {
    std::string out, drive, trajectory = "none";
    JobOptions options;
    Common common;
  };
  const auto a = std::make_shared<Arguments>();
  Command command = program.command("map", "Poses and the static map of a drive");
  command.positional("DRIVE", a->drive, "The drive");
  command.option("-o,--out", a->out, "Folder for poses.txt, times.txt, map.ply, map.json", true);
  command.option("--trajectory", a->trajectory,
                 "kitti or tum: also write trajectory.txt, the LiDAR poses at the middle of each scan");
  a->options.add_to(command);
  a->common.add_to(command, true);
  command.run([a] {
    const std::optional<result::TrajectoryFormat> trajectory = result::parse_trajectory_format(a->trajectory);
    const ThreadLimit limit(a->common.threads);
    Progress progress(a->common.style());
    const std::string report = run::make_map(a->options.job(a->out, a->drive, {}), trajectory, progress);
    progress.end();
    if (a->common.json)
      fmt::print("{}\n", report);
    else
      fmt::print("{0}/map.ply    the static map\n{0}/poses.txt  the camera's poses\n", a->out);
  });
}

}  // namespace dvi::cli
