#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dvi/cli/command.h"
#include "dvi/job/job.h"

namespace dvi::cli {

/// The command line of a job: which drives, which of their data, which options. Shared by run, map and config dump.
struct JobOptions {
  std::optional<std::string> camera, source_cameras, frames, masks, polarity, classes, ego_mask, detector, poses, remove,
      unobserved, method;
  std::string config;
  std::vector<std::string> set, topics;

  void add_to(Command& command);

  /// The job these make: defaults, then the method's, then --config, then the command line and --set. Paths become absolute.
  job::Job job(const std::string& out, const std::string& target, const std::vector<std::string>& sources) const;
};

/// The command line of run and plan.
struct RunArguments {
  std::string out, target;
  std::vector<std::string> sources;
  JobOptions options;
  Common common;
  bool force = false;

  void add_to(Command& command);

  /// The job these make, whose folder becomes `out`. UsageError, with the name of the command, where drive or folder are
  /// missing.
  job::Job job(const std::string& command);
};

/// The job that `dvi plan` wrote down in OUT.
job::Job planned_job(const std::string& out);

}  // namespace dvi::cli
