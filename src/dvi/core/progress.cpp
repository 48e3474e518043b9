#include "dvi/core/progress.h"

#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/core/json_text.h"
#include "dvi/core/task_trace.h"

namespace dvi {
namespace {

constexpr double kBarPeriodS = 0.1, kLinePeriodS = 5.0;

double cpu_seconds(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Returns the width of the terminal on stderr.
std::size_t find_terminal_columns() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

double process_cpu_seconds() { return cpu_seconds(CLOCK_PROCESS_CPUTIME_ID); }
double thread_cpu_seconds() { return cpu_seconds(CLOCK_THREAD_CPUTIME_ID); }

Progress::Progress(ProgressStyle style) : style_(style) {
  if (style_ == ProgressStyle::automatic) style_ = isatty(STDERR_FILENO) != 0 ? ProgressStyle::bar : ProgressStyle::lines;
}

Progress::~Progress() { end(); }

void Progress::plan(std::vector<PlannedStage> stages) {
  const std::lock_guard lock(mutex_);
  if (plan_.empty()) plan_ = RunPlan(std::move(stages));
}

void Progress::begin(const std::string& stage, std::size_t total) {
  throw_if_canceled();
  const std::lock_guard lock(mutex_);
  end_locked();
  stage_ = stage;
  total_ = total;
  done_ = 0;
  begun_ = shown_ = Clock::now();
  cpu_begun_ = process_cpu_seconds();
  plan_.begin(stage_);
  if (TaskTrace* trace = TaskTrace::of_process()) trace->stage(stage_);
  show(false);
}

void Progress::advance() {
  throw_if_canceled();
  const std::lock_guard lock(mutex_);
  ++done_;
  const std::chrono::duration<double> since = Clock::now() - shown_;
  if (since.count() >= (style_ == ProgressStyle::bar ? kBarPeriodS : kLinePeriodS)) show(false);
}

void Progress::end() {
  const std::lock_guard lock(mutex_);
  end_locked();
}

void Progress::end_locked() {
  if (stage_.empty()) return;
  show(true);
  const std::chrono::duration<double> wall = Clock::now() - begun_;
  plan_.end(wall.count());
  times_.push_back({stage_, wall.count(), process_cpu_seconds() - cpu_begun_});
  stage_.clear();
}

void Progress::throw_if_canceled() const {
  throw_if_interrupted();
  if (canceled_) throw Interrupted();
}

StageProgress Progress::at() const {
  StageProgress at{stage_, done_, total_, std::chrono::duration<double>(Clock::now() - begun_).count()};
  if (!plan_.empty()) at.of_run = RunProgress{plan_.number(), plan_.count(), plan_.seconds_left(at.seconds, at.seconds_left())};
  return at;
}

std::optional<StageProgress> Progress::now() const {
  const std::lock_guard lock(mutex_);
  return stage_.empty() ? std::nullopt : std::optional(at());
}

void Progress::show(bool last) {
  shown_ = Clock::now();
  const StageProgress at = this->at();
  if (style_ == ProgressStyle::json) {
    nlohmann::json line = {{"event", last ? "stage_end" : "progress"},
                           {"stage", at.stage},
                           {"done", at.done},
                           {"total", at.total},
                           {"seconds", at.seconds}};
    if (at.of_run) {
      line["run"] = {{"stage_number", at.of_run->number}, {"stages", at.of_run->count}, {"seconds_left", nullptr}};
      if (at.of_run->seconds_left) line["run"]["seconds_left"] = *at.of_run->seconds_left;
    }
    fmt::print(stderr, "{}\n", json_text(line, -1));
  } else if (style_ == ProgressStyle::bar) {
    // At the end of a stage, the line of a whole run is cleared, since that of the next stage or the result replaces it.
    if (last && at.of_run)
      fmt::print(stderr, "\r\033[K");
    else
      fmt::print(stderr, "\r\033[K{}{}", format_bar_line(at, last, find_terminal_columns()), last ? "\n" : "");
    std::fflush(stderr);
  } else if (style_ == ProgressStyle::lines && (last || at.done > 0)) {
    fmt::print(stderr, "{}\n", format_log_line(at, last));
  }
}

void Progress::print(const char* kind, const std::string& message) {
  if (style_ == ProgressStyle::json)
    // Messages are for people, so bytes that are not UTF-8 become U+FFFD.
    fmt::print(
        stderr, "{}\n",
        nlohmann::json{{"event", kind}, {"message", message}}.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  else if (style_ != ProgressStyle::quiet)
    fmt::print(stderr, "{}{}: {}\n", style_ == ProgressStyle::bar ? "\r\033[K" : "", kind, to_printable(message));
}

void Progress::warn(const std::string& message) {
  const std::lock_guard lock(mutex_);
  if (std::find(warnings_.begin(), warnings_.end(), message) != warnings_.end()) return;
  warnings_.push_back(message);
  print("warning", message);
}

void Progress::note(const std::string& message) {
  const std::lock_guard lock(mutex_);
  print("note", message);
}

std::vector<std::string> Progress::warnings() const {
  const std::lock_guard lock(mutex_);
  return warnings_;
}

std::vector<StageTime> Progress::times() const {
  const std::lock_guard lock(mutex_);
  return times_;
}

}  // namespace dvi
