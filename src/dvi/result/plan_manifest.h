#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/inputs/recordings.h"
#include "dvi/job/job.h"
#include "dvi/result/run_report.h"

namespace dvi::result {

/// The content of the manifest OUT/.dvi/plan.json, which identifies the inputs of the stages before the fill, so that each
/// fill, possibly on another machine, can check that it belongs to the plan. It is written after the stages.
struct PlanManifest {
  std::string version, program, listing, content, fingerprint;  ///< see fingerprints.h
  std::size_t sections = 1;                                     ///< in which the drive was planned; 1: as a whole
};

void write_plan(const fs::path& out, const PlanManifest& plan);

/// Reads the plan. Throws InputError if `out` does not contain one.
PlanManifest read_plan(const fs::path& out);

/// Throws InputError if the plan was made by another program, from other files, or with other options. `content` is the
/// content_of() the drives; if it is empty, the names and sizes of files are compared instead.
void require_plan_of(const fs::path& out, const job::Job& job, const inputs::Recordings& drives,
                     const std::string& content = "");

/// Writes the cost of a part of a result that several processes compute, to the manifest OUT/.dvi/costs/NAME.json.
void write_cost(const fs::path& out, const std::string& name, const std::string& fingerprint, const CostReport& cost);

/// Returns the sum of the costs that were written with this fingerprint.
CostReport sum_costs(const fs::path& out, const std::string& fingerprint);

}  // namespace dvi::result
