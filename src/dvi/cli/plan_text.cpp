#include "dvi/cli/plan_text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/core/json_text.h"

namespace dvi::cli {

std::string json_of(const run::PlanReport& plan) {
  return json_text(nlohmann::json{{"schema", "dvi-plan/1"}, {"frames", plan.frames}, {"finished", plan.finished}});
}

std::string brief_plan(const run::PlanReport& plan, const std::string& out) {
  return fmt::format(
      "{0} frames planned, {1} to {2}; {3} are finished\n"
      "  dvi fill {4} --frames A:B   any range, in any order, several at once\n"
      "  dvi finish {4}              when all are filled",
      plan.frames.size(), plan.frames.front(), plan.frames.back(), plan.finished, out);
}

}  // namespace dvi::cli
