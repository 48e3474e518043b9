#include "dvi/commands/selfcheck.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/commands/make_holdout.h"
#include "dvi/core/json_text.h"
#include "dvi/metrics/evaluate.h"
#include "dvi/result/write_report.h"
#include "dvi/run/run.h"
#include "dvi/run/run_stages.h"

namespace dvi::commands {
namespace {

std::vector<metrics::ExternalFrames> select_scenario(std::vector<metrics::ExternalFrames> external,
                                                     holdout::Scenario scenario) {
  for (metrics::ExternalFrames& frames : external) frames.folder /= holdout::name(scenario);
  return external;
}

metrics::Evaluation check_scenario(const job::Job& job, holdout::Scenario scenario, const SelfcheckOptions& options,
                                   Progress& progress) {
  const fs::path folder = fs::path(job.out) / holdout::name(scenario);
  job::Job making = job;
  making.out = folder / "case";
  reuse_or_make_holdout(making, {scenario, options.seed}, progress);
  job::Job running = job;
  running.target = fs::absolute(folder / "case/drive").lexically_normal();
  running.out = folder / "result";
  running.read = job::ReadChoice();
  running.read.mask_files.polarity = labels::Polarity::white;  // the polarity of the case's masks
  run::run(running, progress);
  const auto begin = [&](const char* part, std::size_t ticks) {
    progress.begin(fmt::format("{} {}", part, holdout::name(scenario)), ticks);
    return progress.tick();
  };
  metrics::Evaluation evaluation = metrics::evaluate(
      {folder / "result", folder / "case/truth", folder / "case/ignore", select_scenario(options.external, scenario)}, begin);
  progress.end();
  result::show_truth(folder / "result", {folder / "case/truth", json_text(evaluation)}, progress);
  for (const std::string& warning : evaluation.warnings) progress.warn(fmt::format("{}: {}", holdout::name(scenario), warning));
  return evaluation;
}

std::string format_number(double value, int digits) { return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, digits); }

/// Describes the quality to expect on this drive.
class Verdict {
 public:
  void add(holdout::Scenario scenario, const metrics::Evaluation& evaluation) {
    const metrics::Figures &all = evaluation.total[metrics::Origin::all], &copied = evaluation.total[metrics::Origin::copied];
    if (std::isnan(all.psnr)) return;
    scored_.push_back({holdout::name(scenario), all.psnr, copied.psnr, copied.share});
  }

  std::string text() const {
    if (scored_.empty()) return "No pixel could be scored on this drive, because no virtual vehicle is visible in its frames.";
    std::vector<double> copied;
    for (const Scored& s : scored_)
      if (!std::isnan(s.copied_psnr)) copied.push_back(s.copied_psnr);
    std::string text = "Expect on this drive";
    if (copied.empty())
      text += " no copies, because no other frame observes the background of the traffic";
    else
      text += fmt::format(" {:.0f} dB where pixels are copied ({})", mean(copied), describe_psnr(mean(copied)));
    const auto by_share = [](const Scored& a, const Scored& b) { return a.share < b.share; };
    const auto [least, most] = std::minmax_element(scored_.begin(), scored_.end(), by_share);
    if (scored_.size() == 1)
      return text + fmt::format("; {:.0f} % of the pixels behind the vehicle are copied.", 100 * least->share);
    return text +
           fmt::format(
               ".\nThe background of \"{}\" traffic has the highest coverage ({:.0f} % copied), that of \"{}\" the lowest "
               "({:.0f} % copied, {:.0f} dB over all).",
               most->scenario, 100 * most->share, least->scenario, 100 * least->share, least->psnr);
  }

 private:
  struct Scored {
    std::string scenario;
    double psnr, copied_psnr, share;
  };
  static double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  }
  static const char* describe_psnr(double psnr) {
    return psnr >= 30   ? "almost identical to the truth"
           : psnr >= 24 ? "correct content with small differences"
                        : "visibly different";
  }

  std::vector<Scored> scored_;
};

std::string format_header() {
  return fmt::format("{:<14}{:>8}{:>35}{:>35}\n{:<14}{:>8}", "", "", "all scored pixels", "copied pixels", "scenario",
                     "copied") +
         fmt::format("{0:>11}{1:>8}{2:>8}{3:>8}{0:>11}{1:>8}{2:>8}{3:>8}\n", "MAE", "RMSE", "PSNR", "SSIM");
}

std::string format_row(const std::string& title, const metrics::Evaluation& evaluation) {
  const metrics::Figures& copied = evaluation.total[metrics::Origin::copied];
  std::string text = fmt::format("{:<14}{:>8}", title, format_number(100 * copied.share, 1) + " %");
  for (const metrics::Origin origin : {metrics::Origin::all, metrics::Origin::copied}) {
    const metrics::Figures& f = evaluation.total[origin];
    text += fmt::format("{:>11}{:>8}{:>8}{:>8}", format_number(f.mae, 2), format_number(f.rmse, 2), format_number(f.psnr, 2),
                        format_number(f.ssim, 3));
  }
  text += "\n";
  for (const metrics::ExternalEvaluation& external : evaluation.external)
    text += format_row("  " + external.name, external.evaluation);
  return text;
}

}  // namespace

SelfcheckReport selfcheck(const job::Job& job, const SelfcheckOptions& options, Progress& progress) {
  std::vector<std::string> names;
  for (const holdout::Scenario scenario : options.scenarios) names.emplace_back(holdout::name(scenario));
  progress.plan(run::plan_selfcheck_stages(job, names));
  SelfcheckReport report{"", format_header()};
  nlohmann::json rows = nlohmann::json::array();
  Verdict verdict;
  for (const holdout::Scenario scenario : options.scenarios) {
    const metrics::Evaluation evaluation = check_scenario(job, scenario, options, progress);
    report.text += format_row(holdout::name(scenario), evaluation);
    verdict.add(scenario, evaluation);
    rows.push_back({{"scenario", holdout::name(scenario)}, {"evaluation", evaluation}});
  }
  report.json = json_text({{"schema", "dvi-selfcheck/1"},
                           {"drive", job.target},
                           {"method", to_string(job.method)},
                           {"seed", options.seed},
                           {"scenarios", rows},
                           {"verdict", verdict.text()},
                           {"warnings", progress.warnings()}});
  report.text += "\n" + verdict.text() + "\n";
  for (const holdout::Scenario scenario : options.scenarios)
    report.text += fmt::format("  {}  result beside truth\n",
                               (fs::path(job.out) / holdout::name(scenario) / "result/report.html").string());
  report.text.pop_back();
  write_file(fs::path(job.out) / "selfcheck.json", report.json + "\n");
  return report;
}

}  // namespace dvi::commands
