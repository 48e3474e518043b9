#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "dvi/core/progress.h"

namespace dvi::result {

/// CPU seconds a stage over all threads. Stages nest (sampling asks for depth): the inner one's time is its own only.
class CpuClock {
 public:
  /// Calls `stage` and books its CPU time under `name`, less what stages inside it book.
  template <class Stage, class... Arguments>
  auto time(const std::string& name, const Stage& stage, Arguments&&... arguments) {
    const Scope scope(*this, name);
    return std::invoke(stage, std::forward<Arguments>(arguments)...);
  }

  /// `stage` with its last arguments, its options, bound, and its CPU time booked. Options and clock must outlive it.
  template <class Stage, class... Options>
  auto timed(std::string name, const Stage& stage, const Options&... options) {
    return [this, name = std::move(name), stage, &options...](auto&&... inputs) {
      return time(name, stage, std::forward<decltype(inputs)>(inputs)..., options...);
    };
  }

  std::map<std::string, double> seconds() const {
    const std::lock_guard lock(mutex_);
    return seconds_;
  }

 private:
  struct Scope {
    Scope(CpuClock& owner, const std::string& name) : clock(owner), stage(name), outer(inner), begun(thread_cpu_seconds()) {
      inner = 0;
    }
    ~Scope() {
      const double spent = thread_cpu_seconds() - begun;
      {
        const std::lock_guard lock(clock.mutex_);
        clock.seconds_[stage] += spent - inner;
      }
      inner = outer + spent;
    }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    CpuClock& clock;
    const std::string& stage;
    double outer, begun;
  };
  inline static thread_local double inner = 0;  ///< booked by stages inside the current one, on this thread

  mutable std::mutex mutex_;
  std::map<std::string, double> seconds_;
};

}  // namespace dvi::result
