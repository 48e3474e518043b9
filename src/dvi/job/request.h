#pragma once

#include <string>
#include <vector>

#include "dvi/core/options.h"
#include "dvi/job/job.h"

namespace dvi::job {

/// The caller's description of a job, with any interface: a file of options, and single options.
struct Request {
  std::string config;                   ///< a TOML file, such as the dvi.toml of an earlier result; empty: none
  std::vector<Assignment> assignments;  ///< in the order in which they were given

  /// Makes the job: the defaults, then the values of the method, then the file, then the assignments. Empty paths keep those of
  /// the file. Existing paths become absolute.
  Job job(const std::string& out, const std::string& target, const std::vector<std::string>& sources) const;
};

}  // namespace dvi::job
