#pragma once

#include <string>
#include <vector>

#include "dvi/audit/audit.h"
#include "dvi/core/progress.h"
#include "dvi/job/job.h"

namespace dvi::commands {

/// The findings of an audit, as JSON, and as text.
struct AuditReport {
  audit::Audit audit;
  std::string json, text;
};

/// Checks the result in `out` against the drives that it was made from, the target first. Only the files of the result and of
/// the drives are used. The options of OUT/dvi.toml determine the objects to remove, or `masks` (as `--masks`) if it is not
/// empty. Throws InputError if `out` is not a result, or if it was made from other drives.
AuditReport audit_result(const fs::path& out, const std::vector<std::string>& drives, const std::string& masks,
                         Progress& progress);

}  // namespace dvi::commands
