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

enum class ProgressStyle { automatic, bar, lines, json, quiet };

/// CPU and wall seconds of one stage.
struct StageTime {
  std::string stage;
  double seconds = 0, cpu_seconds = 0;
};

/// Tells a person (or, as JSON lines, a machine) on stderr how far the work is; collects warnings and times a stage.
/// `automatic` is a bar on a terminal and a line every few seconds elsewhere. Safe to advance from many threads.
class Progress {
 public:
  explicit Progress(ProgressStyle style = ProgressStyle::automatic);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// The stages of a whole run, in order: from now on one line shows how far all of it is. A plan within a plan is ignored: the
  /// outer one knows more.
  void plan(std::vector<PlannedStage> stages);

  /// Begins a stage of `total` units (0: unknown); ends the one before.
  void begin(const std::string& stage, std::size_t total);
  void advance();  ///< One unit done. Throws Interrupted after SIGINT or SIGTERM.
  void end();
  /// advance() as a stage wants it.
  Tick tick() {
    return [this] { advance(); };
  }
  /// begin() and advance() as a stage of several parts wants them.
  BeginPart parts() {
    return [this](const char* part, std::size_t ticks) {
      begin(part, ticks);
      return tick();
    };
  }

  /// Makes the next begin() or advance() throw Interrupted, as a signal would. From any thread.
  void cancel() { canceled_ = true; }
  /// Where the work is; none between stages.
  std::optional<StageProgress> now() const;

  void warn(const std::string& message);
  void note(const std::string& message);

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

/// CPU seconds of this process, and of this thread, so far; peak resident memory in bytes.
double process_cpu_seconds();
double thread_cpu_seconds();
std::size_t peak_memory();

}  // namespace dvi
