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

  /// Makes the job, and sets `out` to its folder. Throws UsageError with the name of the command if the drive or the folder
  /// is missing.
  job::Job job(const std::string& command);
};

/// Returns the job whose options `dvi plan` wrote to OUT/dvi.toml.
job::Job planned_job(const std::string& out);

/// Returns the job whose sections `dvi plan --section` planned in OUT.
job::Job sectioned_job(const std::string& out);

}  // namespace dvi::cli
