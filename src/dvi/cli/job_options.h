#pragma once

#include <string>
#include <vector>

#include "dvi/cli/command.h"
#include "dvi/job/request.h"

namespace dvi::cli {

/// The command line of a job: the options that have a flag, a file of options, and --set.
struct JobOptions : job::Request {
  void add_to(Command& command);
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
