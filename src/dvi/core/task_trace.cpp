#include "dvi/core/task_trace.h"

#include <cmath>
#include <cstdlib>
#include <memory>
#include <thread>

#include "dvi/core/progress.h"

namespace dvi {

TaskTrace* TaskTrace::of_process() {
  static const char* const file = std::getenv("DVI_TASK_TRACE");
  if (file == nullptr) return nullptr;
  static const std::thread::id owner = std::this_thread::get_id();
  static const auto trace = std::make_unique<TaskTrace>(file);
  return std::this_thread::get_id() == owner ? trace.get() : nullptr;
}

std::ostream& TaskTrace::event() { return out_ << std::lround(1e6 * thread_cpu_seconds()) << ' '; }

void TaskTrace::stage(const std::string& name) { event() << "stage " << name << '\n'; }

void TaskTrace::begin_loop(std::size_t items, std::size_t limit, const std::string& steps) {
  event() << "loop " << items << ' ' << limit << ' ' << steps << '\n';
}

void TaskTrace::begin_task(std::size_t item, std::size_t step) { event() << "task " << item << ' ' << step << '\n'; }

void TaskTrace::end_task() { event() << "end\n"; }

void TaskTrace::end_loop() { event() << "done\n"; }

}  // namespace dvi
