#include "dvi/pipeline/summary.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace dvi::pipeline {

std::string run_summary(const std::string& report_json, const std::string& out) {
  const nlohmann::json report = nlohmann::json::parse(report_json);
  const nlohmann::json& share = report["hole"]["share"];
  const auto percent = [&](const char* kind) { return 100 * share[kind].get<double>(); };
  std::string text = fmt::format("{} frames, {} hole pixels: {:.1f} % copied", report["frames"].size(),
                                 report["hole"]["pixels"].get<std::size_t>(), percent("copied"));
  if (percent("copied_elsewhere") > 0) text += fmt::format(", {:.1f} % from other drives", percent("copied_elsewhere"));
  text += fmt::format(", {:.1f} % never seen", percent("never_seen"));
  const nlohmann::json& cost = report["cost"];
  double cpu = 0;
  for (const auto& stage : cost["stages"]) cpu += stage["cpu_seconds"].get<double>();
  const double made = std::max(1.0, cost["frames_made"].get<double>());
  text +=
      fmt::format("\n{:.1f} CPU s a frame, peak memory {:.0f} MB", cpu / made, cost["peak_memory_bytes"].get<double>() / 1e6);
  text += fmt::format(
      "\n  {0}/frames       the drive without its traffic\n  {0}/video.mp4    as a video\n"
      "  {0}/compare.mp4  input above result\n  {0}/contact.png  some frames on one sheet\n"
      "  {0}/report.json  all figures",
      out);
  return text;
}

}  // namespace dvi::pipeline
