#pragma once

#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/inputs/recordings.h"
#include "dvi/job/job.h"
#include "dvi/result/run_report.h"

namespace dvi::result {

/// OUT/.dvi/plan.json, a manifest: what the stages before the fill were made from, so that fills elsewhere, at any time, can
/// check that they belong to them. Written after the stages.
struct PlanManifest {
  std::string version, program, listing, content, fingerprint;  ///< as fingerprints.h
};

void write_plan(const fs::path& out, const PlanManifest& plan);

/// InputError where `out` holds no plan.
PlanManifest read_plan(const fs::path& out);

/// InputError where the plan was made by another program, from other files or with other options. `content` of the drives
/// where all of it was read; empty: names and sizes are compared.
void require_plan_of(const fs::path& out, const job::Job& job, const inputs::Recordings& drives,
                     const std::string& content = "");

/// Keeps what a part of a result cost, for results that several processes make: OUT/.dvi/costs/NAME.json, one manifest each.
void keep_cost(const fs::path& out, const std::string& name, const std::string& fingerprint, const CostReport& cost);

/// The sum of those that were kept of this fingerprint.
CostReport kept_costs(const fs::path& out, const std::string& fingerprint);

}  // namespace dvi::result
