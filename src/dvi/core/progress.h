#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "dvi/core/interrupt.h"
#include "dvi/core/progress_line.h"
#include "dvi/core/run_plan.h"

namespace dvi {

/// The form in which progress is shown. `automatic` is a bar on a terminal, and a line every few seconds otherwise.
enum class ProgressStyle { automatic, bar, lines, json, quiet };

/// CPU and wall time of one stage in seconds.
struct StageTime {
  std::string stage;
  double seconds = 0, cpu_seconds = 0;
};

/// Shows progress on stderr for people or, as JSON lines, for programs; collects warnings and measures the time of stages.
/// Thread-safe.
class Progress {
 public:
  explicit Progress(ProgressStyle style = ProgressStyle::automatic);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Sets the stages of a whole run in order, so that one line shows the progress of the whole run. A plan within a plan is
  /// ignored, because the outer one covers more.
  void plan(std::vector<PlannedStage> stages);

  /// Begins a stage of `total` units (0: unknown), and ends the previous one.
  void begin(const std::string& stage, std::size_t total);
  /// Counts one completed unit. Throws Interrupted after SIGINT or SIGTERM.
  void advance();
  void end();
  /// Returns advance() as a function for a stage.
  Tick tick() {
    return [this] { advance(); };
  }
  /// Returns begin() and advance() as a function for a stage of several parts.
  BeginPart parts() {
    return [this](const char* part, std::size_t ticks) {
      begin(part, ticks);
      return tick();
    };
  }

  /// Makes the next begin() or advance() throw Interrupted like a signal. May be called from any thread.
  void cancel() { canceled_ = true; }
  /// Returns the current progress; nothing between stages.
  std::optional<StageProgress> now() const;

  void warn(const std::string& message);
  void note(const std::string& message);

  ProgressStyle style() const { return style_; }
  std::vector<std::string> warnings() const;
  std::vector<StageTime> times() const;

 private:
  using Clock = std::chrono::steady_clock;
  void throw_if_canceled() const;
  StageProgress at() const;
  void show(bool last);
  void print(const char* kind, const std::string& message);
  void end_locked();

  std::atomic<bool> canceled_ = false;
  mutable std::mutex mutex_;
  ProgressStyle style_;
  std::string stage_;
  std::size_t total_ = 0, done_ = 0;
  double cpu_begun_ = 0;
  Clock::time_point begun_, shown_;
  RunPlan plan_;
  std::vector<std::string> warnings_;
  std::vector<StageTime> times_;
};

/// Return the CPU time of this process and of this thread so far in seconds.
double process_cpu_seconds();
double thread_cpu_seconds();

}  // namespace dvi
