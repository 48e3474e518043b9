#include "dvi/result/run_report.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/core/frame_name.h"
#include "dvi/core/json_text.h"
#include "dvi/core/process_memory.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/result/stage_json.h"

namespace dvi::result {

using nlohmann::json;

HoleReport& HoleReport::operator+=(const HoleReport& other) {
  pixels += other.pixels;
  copied += other.copied;
  copied_elsewhere += other.copied_elsewhere;
  interpolated += other.interpolated;
  synthesized += other.synthesized;
  empty += other.empty;
  imported += other.imported;
  return *this;
}

void to_json(json& j, const HoleReport& hole) {
  std::vector counts{std::pair{"copied", hole.copied}, std::pair{"copied_elsewhere", hole.copied_elsewhere},
                     std::pair{"interpolated", hole.interpolated}, std::pair{"synthesized", hole.synthesized},
                     std::pair{"empty", hole.empty}};
  if (hole.imported > 0) counts.emplace_back("imported", hole.imported);  // a run itself imports nothing
  json share = {{"unobserved", hole.share(hole.unobserved())}};
  j = {{"pixels", hole.pixels}};
  for (const auto& [key, count] : counts) {
    j[key] = count;
    share[key] = hole.share(count);
  }
  j["share"] = share;
}
void from_json(const json& j, HoleReport& hole) {
  hole = {j.at("pixels"),      j.at("copied"), j.at("copied_elsewhere"),           j.at("interpolated"),
          j.at("synthesized"), j.at("empty"),  j.value("imported", std::size_t{0})};
}

HoleReport count_hole(const cv::Mat1b& kind) {
  using harmonize::Kind;
  std::array<std::size_t, 7> count{};
  for (const uchar k : kind) ++count[std::min<std::size_t>(k, count.size() - 1)];
  const auto of = [&](Kind k) { return count[static_cast<std::size_t>(k)]; };
  return {kind.total() - of(Kind::original),
          of(Kind::copied),
          of(Kind::copied_elsewhere),
          of(Kind::interpolated),
          of(Kind::synthesized),
          of(Kind::empty),
          of(Kind::imported)};
}

CostReport make_cost_report(const Progress& progress, const CpuClock& clock, std::size_t frames_made) {
  return {progress.times(), clock.seconds(), frames_made, peak_memory()};
}

CostReport& CostReport::operator+=(const CostReport& other) {
  for (const StageTime& time : other.stages) {
    const auto same = std::find_if(stages.begin(), stages.end(), [&](const StageTime& t) { return t.stage == time.stage; });
    if (same == stages.end()) {
      stages.push_back(time);
    } else {
      same->seconds += time.seconds;
      same->cpu_seconds += time.cpu_seconds;
    }
  }
  for (const auto& [stage, seconds] : other.fill_cpu_seconds) fill_cpu_seconds[stage] += seconds;
  frames_made += other.frames_made;
  peak_memory_bytes = std::max(peak_memory_bytes, other.peak_memory_bytes);
  return *this;
}

void to_json(json& j, const CostReport& cost) {
  const double n = static_cast<double>(std::max<std::size_t>(cost.frames_made, 1));
  json fill = json::object();
  for (const auto& [stage, seconds] : cost.fill_cpu_seconds)
    fill[stage] = {{"cpu_seconds", seconds}, {"cpu_seconds_per_frame", seconds / n}};
  j = {{"stages", stages_json(cost.stages, "frame", cost.frames_made)},
       {"fill", fill},
       {"frames_made", cost.frames_made},
       {"peak_memory_bytes", cost.peak_memory_bytes}};
}
void from_json(const json& j, CostReport& cost) {
  for (const json& stage : j.at("stages"))
    cost.stages.push_back({stage.at("stage"), stage.at("seconds"), stage.at("cpu_seconds")});
  for (const auto& [stage, seconds] : j.at("fill").items()) cost.fill_cpu_seconds[stage] = seconds.at("cpu_seconds");
  j.at("frames_made").get_to(cost.frames_made);
  j.at("peak_memory_bytes").get_to(cost.peak_memory_bytes);
}

namespace {

/// Returns ", 12.0 % unobserved (9.0 % synthesized, 3.0 % interpolated)".
std::string describe_unobserved(const HoleReport& hole) {
  std::string how;
  for (const auto& [count, name] : {std::pair(hole.synthesized, "synthesized"), std::pair(hole.interpolated, "interpolated"),
                                    std::pair(hole.empty, "left black"), std::pair(hole.imported, "imported")})
    if (count > 0) how += fmt::format("{}{:.1f} % {}", how.empty() ? "" : ", ", 100 * hole.share(count), name);
  return fmt::format(", {:.1f} % unobserved", 100 * hole.share(hole.unobserved())) + (how.empty() ? "" : " (" + how + ")");
}

/// Returns a line if most of the hole belongs to stationary objects, which need not be removed; otherwise nothing.
std::string describe_stationary(const json& stationary, const HoleReport& hole) {
  if (stationary.is_null()) return {};
  const double share = hole.share(stationary.at("pixels").get<std::size_t>());
  if (share <= 0.5) return {};
  return fmt::format("\n{} of {} removed tracks are stationary; they are {:.0f} % of the hole; --remove moving would keep them",
                     stationary.at("stationary").get<std::size_t>(), stationary.at("tracks").get<std::size_t>(), 100 * share);
}

/// Returns a line if objects were completed in frames whose masks lack them; otherwise nothing.
std::string describe_completed(const json& objects) {
  const auto completed = objects.at("completed").get<std::size_t>(), frames = objects.at("completed_frames").get<std::size_t>();
  if (completed == 0) return {};
  return fmt::format("\n{} of {} removed objects were completed, in {} frame{} whose masks lack parts of them (objects.json)",
                     completed, objects.at("removed").get<std::size_t>(), frames, frames == 1 ? "" : "s");
}

/// Returns a line for each object that remains visible.
std::string describe_residue(const json& objects) {
  std::string out;
  for (const json& sentence : objects.value("residue", json::array())) out += "\n" + sentence.get<std::string>();
  return out;
}

std::string describe_registration(const json& drive) {
  const json& placed = drive.at("registration");
  if (placed.is_null()) return {};
  return fmt::format("\n{}: {:.0f} % of its scans overlap; placed to {:.1f} cm and {:.2f} degrees (95 %)",
                     fs::path(drive.at("path").get<std::string>()).filename().string(),
                     100 * placed.at("overlap").get<double>(), 100 * placed.at("bound_m").get<double>(),
                     placed.at("bound_deg").get<double>());
}

std::string describe_cost(const json& cost) {
  double cpu = 0;
  for (const json& stage : cost.at("stages")) cpu += stage.at("cpu_seconds").get<double>();
  const auto frames = std::max<std::size_t>(1, cost.at("frames_made").get<std::size_t>());
  return fmt::format("\n{:.1f} CPU s per frame, peak memory {:.0f} MB", cpu / static_cast<double>(frames),
                     cost.at("peak_memory_bytes").get<double>() / 1e6);
}

}  // namespace

RunReport::RunReport(json document) : document_(std::make_shared<const json>(std::move(document))) {}

std::string frame_name(const json& frame) { return join_frame_name(frame.value("camera", ""), frame.at("name")); }

std::vector<std::size_t> RunReport::frame_order() const {
  const json& frames = document().at("frames");
  std::vector<std::size_t> order(frames.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return frames[a].at("number").get<int>() < frames[b].at("number").get<int>();
  });
  return order;
}

std::vector<std::string> RunReport::frame_names() const {
  std::vector<std::string> names;
  for (const json& frame : document().at("frames")) names.push_back(frame_name(frame));
  return names;
}

namespace {

/// Lists the files for a person; those of each camera are in its folder.
std::string describe_files(const std::string& out, std::size_t cameras) {
  const std::string of_camera = cameras > 1 ? out + "/CAMERA" : out;
  return fmt::format(
      "\n  {0}/report.html  removed objects and the quality of the result: open it in a browser\n"
      "  {1}/frames       the drive without its traffic\n  {1}/video.mp4    as a video\n"
      "  {1}/compare.mp4  input above result\n  {1}/contact.png  some frames on one sheet\n"
      "  {0}/report.json  all figures",
      out, of_camera);
}

}  // namespace

std::string RunReport::brief(const std::string& out) const {
  const auto hole = document().at("hole").get<HoleReport>();
  std::string text = fmt::format("{} frames, {} hole pixels: {:.1f} % copied", document().at("frames").size(), hole.pixels,
                                 100 * hole.share(hole.copied));
  if (hole.copied_elsewhere > 0)
    text += fmt::format(", {:.1f} % from other cameras or drives", 100 * hole.share(hole.copied_elsewhere));
  text += describe_unobserved(hole) + describe_completed(document().at("objects")) +
          describe_residue(document().at("objects")) + describe_stationary(document().at("stationary"), hole);
  for (const json& drive : document().at("drives")) text += describe_registration(drive);
  return text + describe_cost(document().at("cost")) + describe_files(out, document().value("cameras", json::array()).size());
}

std::string to_json(const RunReport& report) { return json_text(report.document()); }

std::optional<RunReport> read_run_report(const fs::path& file) {
  if (!fs::is_regular_file(file)) return std::nullopt;
  try {
    RunReport report(json::parse(read_file(file)));
    if (report.document().at("schema") != RunReport::kSchema) return std::nullopt;
    report.frame_names();
    report.brief("");  // throws if a figure is missing
    return report;
  } catch (const json::exception&) {  // answered: truncated by a crash, or changed by hand
    return std::nullopt;
  }
}

}  // namespace dvi::result
