#include "dvi/core/run_plan.h"

#include <algorithm>

namespace dvi {

void RunPlan::begin(const std::string& stage) {
  const auto ahead = stages_.begin() + static_cast<std::ptrdiff_t>(at_);
  const auto found = std::find_if(ahead, stages_.end(), [&](const PlannedStage& s) { return s.always || s.name == stage; });
  planned_ = found != stages_.end() && found->name == stage;
  if (planned_) at_ = static_cast<std::size_t>(found - stages_.begin()) + 1;
}

void RunPlan::end(double seconds) {
  seconds_ += seconds;
  cost_ += cost_of_current();
  planned_ = false;
}

std::optional<double> RunPlan::seconds_left(double passed, std::optional<double> stage_left) const {
  constexpr double kMinSeconds = 3, kMinShare = 0.03;
  double all = 0, later = 0;
  for (std::size_t i = 0; i < stages_.size(); ++i) {
    all += stages_[i].cost;
    if (i >= at_) later += stages_[i].cost;
  }
  const double current = cost_of_current();
  // The current stage contributes to the estimate once the completed share of it is known.
  const double share = stage_left ? passed / std::max(passed + *stage_left, 1e-9) : 0;
  const double seconds = seconds_ + (stage_left ? passed : 0), cost = cost_ + share * current;
  if (seconds < kMinSeconds || cost < kMinShare * all) return std::nullopt;
  const double rate = seconds / cost;
  return stage_left.value_or(std::max(0.0, rate * current - passed)) + rate * later;
}

}  // namespace dvi
