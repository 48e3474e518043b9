#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace dvi {

/// A stage of a run that is still to come, and what it costs in proportion to the others.
struct PlannedStage {
  std::string name;
  double cost = 0;
  bool always = false;  ///< never skipped: what comes after it cannot begin before
};

/// How far a whole run is: which of its stages it is at, and how long it will still take, by what the stages before have taken.
/// Stages that are skipped count as done; stages that are not planned belong to the one before.
class RunPlan {
 public:
  RunPlan() = default;
  explicit RunPlan(std::vector<PlannedStage> stages) : stages_(std::move(stages)) {}

  bool empty() const { return stages_.empty(); }
  void begin(const std::string& stage);
  /// The stage that began has ended after so many seconds.
  void end(double seconds);

  std::size_t number() const { return at_; }  ///< of the stage it is at, from 1; 0 before the first
  std::size_t count() const { return stages_.size(); }

  /// Seconds until the end of the run, of whose stage so many seconds have passed and `stage_left` are left, where that is
  /// known. None while too little is done to tell: 3 seconds, and 3 % of the cost.
  std::optional<double> seconds_left(double passed, std::optional<double> stage_left) const;

 private:
  double cost_of_current() const { return planned_ ? stages_[at_ - 1].cost : 0; }

  std::vector<PlannedStage> stages_;
  std::size_t at_ = 0;
  bool planned_ = false;           // the stage that runs
  double seconds_ = 0, cost_ = 0;  // of the stages that ended
};

}  // namespace dvi
