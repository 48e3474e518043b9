#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <tuple>
#include <utility>

#include "dvi/core/threads.h"

namespace dvi::result {

/// Sums CPU seconds per stage over all threads. Stages may be nested (sampling computes depth): the time of the inner stage
/// does not count for the outer one.
class CpuClock {
 public:
  /// Calls `stage`, and adds its CPU time, without that of nested stages, to `name`. Returns the result of `stage`.
  template <class Stage, class... Arguments>
  auto time(const std::string& name, const Stage& stage, Arguments&&... arguments) {
    const Scope scope(*this, name);
    return std::invoke(stage, std::forward<Arguments>(arguments)...);
  }

  /// Binds the last arguments of `stage`, its options, and returns a function that calls it with time(). The options and the
  /// clock must outlive the function.
  template <class Stage, class... Options>
  auto wrap(std::string name, Stage stage, const Options&... options) {
    return [this, name = std::move(name), stage, bound = std::tuple<const Options&...>(options...)](auto&&... inputs) {
      return std::apply(
          [&](const Options&... last) { return time(name, stage, std::forward<decltype(inputs)>(inputs)..., last...); }, bound);
    };
  }

  /// Adds the seconds of another clock.
  void add(const std::map<std::string, double>& seconds) {
    const std::lock_guard lock(mutex_);
    for (const auto& [stage, spent] : seconds) seconds_[stage] += spent;
  }

  std::map<std::string, double> seconds() const {
    const std::lock_guard lock(mutex_);
    return seconds_;
  }

 private:
  struct Scope {
    Scope(CpuClock& owner, const std::string& name) : clock(owner), stage(name), outer(inner), begun(task_cpu_seconds()) {
      inner = 0;
    }
    ~Scope() {
      const double spent = task_cpu_seconds() - begun;
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
  inline static thread_local double inner = 0;  ///< CPU seconds of stages nested in the current one, on this thread

  mutable std::mutex mutex_;
  std::map<std::string, double> seconds_;
};

}  // namespace dvi::result
