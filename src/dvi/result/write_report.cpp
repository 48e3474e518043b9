#include "dvi/result/write_report.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>

#include <unistd.h>

#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/core/frame_name.h"
#include "dvi/core/json_text.h"
#include "dvi/core/threads.h"
#include "dvi/report/report.h"
#include "dvi/result/manifest.h"
#include "dvi/result/result_layout.h"
#include "dvi/result/run_report.h"

namespace dvi::result {
namespace {

using nlohmann::json;

/// Returns the options in which a job differs from the defaults of its method, without its inputs and output.
std::string list_changed_options(job::Job job) {
  job::Job plain;
  plain.method = job.method;
  job::use_method(plain.method, plain.options);
  OptionTable now = job.table(), before = plain.table();
  json changed = json::array();
  for (std::size_t i = 0; i < now.options().size(); ++i) {
    const Option &option = now.options()[i], &old = before.options()[i];
    const std::string name = option.name();
    if (name == "job.target" || name == "job.sources" || name == "job.out" || option.text() == old.text()) continue;
    changed.push_back({{"name", name}, {"value", option.text()}, {"default", old.text()}, {"doc", option.doc}});
  }
  return json_text(changed, -1);
}

/// Returns the changed options in OUT/dvi.toml.
std::string read_options(const fs::path& out, std::vector<std::string>& problems) {
  try {
    job::Job job;
    job.table().load_toml(out / "dvi.toml");
    return list_changed_options(job);
  } catch (const UsageError& e) {  // answered: options of an earlier version
    problems.push_back(std::string("dvi.toml was written by another version of dvi: ") + e.what());
  } catch (const InputError&) {  // answered
    problems.emplace_back("dvi.toml is missing or cannot be read");
  }
  return "[]";
}

/// Reads report.json of a result. If it does not exist, returns the frames that are finished.
json read_run(const fs::path& out, std::vector<std::string>& problems) {
  if (fs::exists(out / "report.json")) {
    json run = json::parse(read_file(out / "report.json"), nullptr, false);
    if (run.is_object() && run.value("frames", json()).is_array()) return run;
    problems.emplace_back("report.json is damaged");
  } else {
    problems.emplace_back("the run is not finished; the same command continues it");
  }
  HoleReport hole;
  json frames = json::array();
  for (const std::string& name : list_begun_frames(out))
    if (const std::optional<Manifest> manifest = read_manifest(frame_manifest(out, name)); manifest && manifest->content) {
      frames.push_back(*manifest->content);
      hole += manifest->content->at("hole").get<HoleReport>();
    }
  return {{"frames", frames}, {"hole", hole}};
}

std::vector<std::string> names_of(const json& run) {
  std::vector<std::string> names;
  for (const json& frame : run.at("frames"))
    names.push_back(frame.is_object() && frame.value("name", json()).is_string() ? frame_name(frame) : "");
  return names;
}

/// Throws InputError if the folder is read-only, before any frame is read.
void require_writable(const fs::path& out) {
  if (access(out.c_str(), W_OK) != 0)
    throw InputError(out, std::string("cannot be written (") + std::strerror(errno) + ")",
                     "copy it to a writable folder for a new report; an existing report.html can be opened where it is");
}

fs::path report_frame_manifest(const fs::path& out, const std::string& name) { return out / ".dvi/report" / (name + ".json"); }

fs::path report_manifest(const fs::path& out) { return out / ".dvi/report.json"; }

/// Writes the manifest of the report's files, which detects damaged files.
void write_report_manifest(const fs::path& out) {
  std::vector<std::string> files{"report.html"};
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(out / "report"))
    if (entry.is_regular_file()) files.push_back(fs::relative(entry.path(), out).string());
  std::sort(files.begin(), files.end());
  write_manifest(report_manifest(out), {"", list_contents(out, files)});
}

}  // namespace

bool is_report_complete(const fs::path& out) { return is_confirmed(report_manifest(out), "", out); }

void write_report_frame_manifest(const fs::path& out, const std::string& name, std::size_t number,
                                 const std::string& fingerprint) {
  write_manifest(report_frame_manifest(out, name), {fingerprint, list_contents(out, report::list_frame_files(out, number))});
}

void remove_report_frame_manifest(const fs::path& out, const std::string& name) {
  fs::remove(report_frame_manifest(out, name));
}

void write_report(const job::Job& job, const ReportedFrames& frames, const std::function<std::string()>& report_json,
                  const Tick& tick) {
  std::vector<char> written(frames.names.size());
  parallel_for(written.size(), [&](std::size_t i) {
    written[i] = is_confirmed(report_frame_manifest(job.out, frames.names[i]), frames.fingerprint, job.out) ? 1 : 0;
  });
  report::write_report({.out = job.out,
                        .names = frames.names,
                        .run = report_json,
                        .options = list_changed_options(job),
                        .evaluation = "null",
                        .written = written},
                       tick);
  write_report_manifest(job.out);
}

void write_report(const fs::path& out, const ShownTruth& truth, Progress& progress) {
  if (list_frames(out).empty() && !fs::is_directory(out / ".dvi"))
    throw InputError(out, "is not a result of dvi", "dvi report takes the output folder of dvi run");
  require_writable(out);
  std::vector<std::string> problems;
  const json run = read_run(out, problems);
  const std::string options = read_options(out, problems);
  const std::vector<std::string> names = names_of(run);
  progress.begin("report", names.size());
  report::write_report({.out = out,
                        .names = names,
                        .run = [&] { return json_text(run, -1); },
                        .options = options,
                        .evaluation = truth.evaluation.empty() ? "null" : truth.evaluation,
                        .truth = truth.folder,
                        .problems = problems},
                       progress.tick());
  if (fs::is_directory(out / ".dvi")) write_report_manifest(out);
  progress.end();
}

void show_truth(const fs::path& out, const ShownTruth& truth, Progress& progress) {
  if (!fs::is_directory(out / ".dvi")) return;
  try {
    write_report(out, truth, progress);
  } catch (const InputError& e) {  // answered: the scores do not depend on the report
    progress.warn(std::string("the report does not show the truth: ") + e.what());
  }
}

}  // namespace dvi::result
