#pragma once

#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/inputs/recordings.h"
#include "dvi/job/job.h"
#include "dvi/result/run_report.h"

namespace dvi::result {

/// OUT/.dvi/plan.json: what the stages before the fill were made from, so that fills elsewhere, at any time, can tell that they
/// belong to them. Written after the stages.
struct PlanRecord {
  std::string version, program, listing, content, fingerprint;  ///< as fingerprints.h
};

void write_plan_record(const fs::path& out, const PlanRecord& record);

/// InputError where `out` holds no plan.
PlanRecord read_plan_record(const fs::path& out);

/// InputError where the plan was made by another program, from other files or with other options. `content` of the drives
/// where all of it was read; empty: names and sizes are compared.
void require_plan_of(const fs::path& out, const job::Job& job, const inputs::Recordings& drives,
                     const std::string& content = "");

/// What the parts of a result cost that several processes made: OUT/.dvi/costs/NAME.json, one a process.
void keep_cost(const fs::path& out, const std::string& name, const std::string& fingerprint, const CostReport& cost);

/// The sum of those that were kept of this fingerprint.
CostReport kept_costs(const fs::path& out, const std::string& fingerprint);

}  // namespace dvi::result
