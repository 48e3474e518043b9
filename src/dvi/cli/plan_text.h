#pragma once

#include <string>

#include "dvi/run/run.h"

namespace dvi::cli {

/// Returns the document of `dvi plan --json` and `dvi join --json`.
std::string json_of(const run::PlanReport& plan);

/// Returns the summary of a plan, with the commands that fill and finish it.
std::string brief_plan(const run::PlanReport& plan, const std::string& out);

}  // namespace dvi::cli
