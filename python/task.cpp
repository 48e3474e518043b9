#include "task.h"

#include <chrono>
#include <optional>
#include <utility>

#include <opencv2/core/utility.hpp>

#include "dvi/core/threads.h"

namespace dvi::python {
namespace py = pybind11;

namespace {

// As the program has it: frames are worked on in parallel. Put back afterward, for Debian's cv2 shares the library.
class OpenCvOnOneThread {
 public:
  OpenCvOnOneThread() : before_(cv::getNumThreads()) { cv::setNumThreads(1); }
  ~OpenCvOnOneThread() { cv::setNumThreads(before_); }
  OpenCvOnOneThread(const OpenCvOnOneThread&) = delete;
  OpenCvOnOneThread& operator=(const OpenCvOnOneThread&) = delete;

 private:
  int before_;
};

}  // namespace

void Task::start() {
  thread_ = std::thread([this] {
    try {
      const OpenCvOnOneThread one;
      const ThreadLimit limit(threads_);
      work_(progress_);
    } catch (...) {
      error_ = std::current_exception();
    }
    const std::lock_guard lock(mutex);
    ended = true;
    changed.notify_all();
  });
}

Task::~Task() { cancel(); }

void Task::cancel() {
  if (!thread_.joinable()) return;
  const py::gil_scoped_release released;
  {
    const std::lock_guard lock(mutex);
    canceled = true;
    progress_.cancel();
    changed.notify_all();
  }
  thread_.join();
}

void Task::report(const Callback& callback) {
  const std::optional<StageProgress> now = progress_.now();
  if (callback.is_none() || !now || (now->stage == reported_.stage && now->done == reported_.done)) return;
  reported_ = *now;
  callback(now->stage, now->done, now->total);
}

void Task::wait(const Callback& callback, const std::function<bool()>& ready) {
  constexpr std::chrono::milliseconds kLook(50);
  for (bool come = false; !come;) {
    {
      const py::gil_scoped_release released;
      std::unique_lock lock(mutex);
      come = changed.wait_for(lock, kLook, [&] { return ended || ready(); });
    }
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      report(callback);
    } catch (...) {
      cancel();
      throw;
    }
  }
}

void Task::finish(const Callback& callback) {
  wait(callback, [] { return false; });
  if (thread_.joinable()) thread_.join();
  const py::object warn = py::module_::import("warnings").attr("warn");
  for (const std::string& warning : progress_.warnings()) warn(warning);
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
}

}  // namespace dvi::python
