#pragma once

#include <string>
#include <vector>

#include "dvi/audit/audit.h"
#include "dvi/core/progress.h"
#include "dvi/job/job.h"

namespace dvi::commands {

struct AuditReport {
  audit::Audit audit;
  std::string json, text;
};

/// Checks a result against the drives it was made from (the target first), from what is written in it and these alone. What to
/// remove is what the drives say by the options of OUT/dvi.toml, or by `masks` if that is not empty. InputError where `out` is
/// no result, or the drives are not its own.
AuditReport audit_result(const fs::path& out, const std::vector<std::string>& drives, const std::string& masks,
                         Progress& progress);

}  // namespace dvi::commands
