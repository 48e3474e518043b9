#include "dvi/pipeline/selfcheck.h"

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/core/json_text.h"
#include "dvi/metrics/evaluate.h"
#include "dvi/pipeline/make_holdout.h"
#include "dvi/pipeline/run.h"

namespace dvi::pipeline {
namespace {

std::vector<metrics::ExternalFrames> of_scenario(std::vector<metrics::ExternalFrames> external, holdout::Scenario scenario) {
  for (metrics::ExternalFrames& frames : external) frames.folder /= holdout::name(scenario);
  return external;
}

metrics::Evaluation check_scenario(const Job& job, holdout::Scenario scenario,
                                   const std::vector<metrics::ExternalFrames>& external, int seed, Progress& progress) {
  const fs::path folder = fs::path(job.out) / holdout::name(scenario);
  Job making = job;
  making.out = folder / "case";
  keep_or_make_holdout(making, {scenario, seed}, progress);
  Job running = job;
  running.target = fs::absolute(folder / "case/drive").lexically_normal();
  running.out = folder / "result";
  running.read = {};
  running.read.mask_files.polarity = io::Polarity::white;  // as the case has them
  run(running, progress);
  const auto begin = [&](const char* part, std::size_t ticks) {
    progress.begin(fmt::format("{} {}", part, holdout::name(scenario)), ticks);
    return progress.tick();
  };
  metrics::Evaluation evaluation = metrics::evaluate(
      {folder / "result", folder / "case/truth", folder / "case/ignore", of_scenario(external, scenario)}, begin);
  progress.end();
  for (const std::string& warning : evaluation.warnings) progress.warn(fmt::format("{}: {}", holdout::name(scenario), warning));
  return evaluation;
}

std::string number(double value, int digits) { return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, digits); }

std::string header() {
  return fmt::format("{:<14}{:>8}{:>35}{:>35}\n{:<14}{:>8}", "", "", "all scored pixels", "copied pixels", "scenario",
                     "copied") +
         fmt::format("{0:>11}{1:>8}{2:>8}{3:>8}{0:>11}{1:>8}{2:>8}{3:>8}\n", "MAE", "RMSE", "PSNR", "SSIM");
}

std::string row(const std::string& title, const metrics::Evaluation& evaluation) {
  const metrics::Figures& copied = evaluation.total[metrics::Origin::copied];
  std::string text = fmt::format("{:<14}{:>8}", title, number(100 * copied.share, 1) + " %");
  for (const metrics::Origin origin : {metrics::Origin::all, metrics::Origin::copied}) {
    const metrics::Figures& f = evaluation.total[origin];
    text += fmt::format("{:>11}{:>8}{:>8}{:>8}", number(f.mae, 2), number(f.rmse, 2), number(f.psnr, 2), number(f.ssim, 3));
  }
  text += "\n";
  for (const metrics::ExternalEvaluation& external : evaluation.external)
    text += row("  " + external.name, external.evaluation);
  return text;
}

}  // namespace

SelfcheckReport selfcheck(const Job& job, const std::vector<holdout::Scenario>& scenarios,
                          const std::vector<metrics::ExternalFrames>& external, int seed, Progress& progress) {
  SelfcheckReport report{"", header()};
  nlohmann::json rows = nlohmann::json::array();
  for (const holdout::Scenario scenario : scenarios) {
    const metrics::Evaluation evaluation = check_scenario(job, scenario, external, seed, progress);
    report.text += row(holdout::name(scenario), evaluation);
    rows.push_back({{"scenario", holdout::name(scenario)}, {"evaluation", evaluation}});
  }
  report.json = json_text({{"schema", "dvi-selfcheck/1"},
                           {"drive", job.target},
                           {"method", to_string(job.method)},
                           {"seed", seed},
                           {"scenarios", rows},
                           {"warnings", progress.warnings()}});
  write_file(fs::path(job.out) / "selfcheck.json", report.json + "\n");
  return report;
}

}  // namespace dvi::pipeline
