#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

#include <pybind11/pybind11.h>

#include "dvi/core/progress.h"

namespace dvi::python {

/// Runs work in a thread of its own, so that Python may wait for it with Ctrl-C and a callback, both in the caller's thread.
/// Exceptions of the work are rethrown by wait(). Destroyed earlier, the work is canceled.
class Task {
 public:
  using Work = std::function<void(Progress& progress)>;
  using Callback = pybind11::object;  ///< None, or called as callback(stage, done, total); total 0 is unknown

  Task(int threads, Work work) : threads_(threads), work_(std::move(work)) {}
  ~Task();
  Task(const Task&) = delete;
  Task& operator=(const Task&) = delete;

  /// Begins the work. May be called once.
  void start();
  /// Until `ready`, which is asked under the task's lock, or the end of the work. Needs the GIL, which it gives up meanwhile.
  void wait(const Callback& callback, const std::function<bool()>& ready);
  /// Waits for the end of the work, rethrows its exception, and repeats its warnings in Python.
  void finish(const Callback& callback);
  /// Stops the work at its next step and waits for that.
  void cancel();

  std::mutex mutex;
  std::condition_variable changed;
  bool canceled = false, ended = false;  ///< under `mutex`

 private:
  void report(const Callback& callback);

  int threads_;
  Work work_;
  Progress progress_{ProgressStyle::quiet};
  std::exception_ptr error_;
  StageProgress reported_;
  std::thread thread_;
};

}  // namespace dvi::python
