#include "dvi/run/run_stages.h"

namespace dvi::run {
namespace {

using Stages = std::vector<PlannedStage>;

// CPU seconds per frame, measured on a drive of KITTI. Only their ratios are used: the stages that have ended determine the
// speed of this machine and drive.
const Stages& stages_before_fill() {
  static const Stages stages{{"read", 0.02},     {"plausibility", 0.015}, {"odometry", 0.015},
                             {"loops", 0.001},   {"sharpness", 0.01},     {"ground", 0.01},
                             {"traffic", 0.1},   {"complete", 0.03},      {"camera and labels", 0.1},
                             {"map", 0.015},     {"carve", 0.015},        {"normals", 0.005},
                             {"exposure", 0.03}, {"align", 0.05}};
  return stages;
}

const Stages& stages_after_fill() {
  static const Stages stages{{"video", 0.07}, {"artifacts", 0.035}, {"look", 0.02}, {"report", 0.02}};
  return stages;
}

void append(const Stages& more, Stages& stages) { stages.insert(stages.end(), more.begin(), more.end()); }

}  // namespace

Stages plan_run_stages(const job::Job& job) {
  Stages stages;
  if (job::is_baseline(job.method))
    stages.push_back({"read", 0.02});
  else
    append(stages_before_fill(), stages);
  if (!job::is_baseline(job.method) && job.options.harmonize.unobserved == harmonize::Unobserved::synthesize)
    stages.push_back({"completion", 0.1});
  stages.push_back({"fill", 0.6});
  append(stages_after_fill(), stages);
  return stages;
}

Stages plan_selfcheck_stages(const job::Job& job, const std::vector<std::string>& scenarios) {
  Stages stages;
  for (const std::string& scenario : scenarios) {
    append({{"plausibility", 0.015}, {"odometry", 0.015}, {"loops", 0.001}, {"sharpness", 0.01}, {"holdout " + scenario, 0.15}},
           stages);
    append(plan_run_stages(job), stages);
    append({{"eval " + scenario, 0.06, true}, {"report", 0.08}}, stages);
  }
  return stages;
}

}  // namespace dvi::run
