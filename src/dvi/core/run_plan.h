#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace dvi {

/// A future stage of a run and its cost in proportion to the others.
struct PlannedStage {
  std::string name;
  double cost = 0;
  bool always = false;  ///< the stage is never skipped, so later ones cannot begin before it
};

/// The progress of a whole run: the current stage, and the remaining time by the duration of the previous stages. Skipped
/// stages count as done; unplanned stages belong to the previous one.
class RunPlan {
 public:
  RunPlan() = default;
  explicit RunPlan(std::vector<PlannedStage> stages) : stages_(std::move(stages)) {}

  bool empty() const { return stages_.empty(); }
  void begin(const std::string& stage);
  /// Ends the current stage after its duration.
  void end(double seconds);

  std::size_t number() const { return at_; }  ///< of the current stage, from 1; 0 before the first one
  std::size_t count() const { return stages_.size(); }

  /// Estimates the seconds until the end of the run. `passed` seconds of the current stage have passed, and `stage_left` are
  /// left if known. Returns nothing before 3 seconds and 3 % of the cost.
  std::optional<double> seconds_left(double passed, std::optional<double> stage_left) const;

 private:
  double cost_of_current() const { return planned_ ? stages_[at_ - 1].cost : 0; }

  std::vector<PlannedStage> stages_;
  std::size_t at_ = 0;
  bool planned_ = false;           // whether the current stage is in the plan
  double seconds_ = 0, cost_ = 0;  // sums over the ended stages
};

}  // namespace dvi
