#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dvi/cli/command.h"
#include "dvi/pipeline/job.h"

namespace dvi::cli {

/// The command line of a job: which drives, which of their data, which options. Shared by run, map and config dump.
struct JobOptions {
  std::optional<std::string> camera, source_cameras, frames, masks, polarity, classes, ego_mask, detector, poses, remove,
      method;
  std::string config;
  std::vector<std::string> set;

  void add_to(Command& command);

  /// The job these make: defaults, then the method's, then --config, then the command line and --set. Paths become absolute.
  pipeline::Job job(const std::string& out, const std::string& target, const std::vector<std::string>& sources) const;
};

}  // namespace dvi::cli
