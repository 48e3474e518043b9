#pragma once

#include <cstddef>
#include <fstream>
#include <string>

namespace dvi {

/// Writes the loops and tasks of a run with one thread to a file, from which ./dev bench scaling predicts the time with more
/// threads. The variable DVI_TASK_TRACE of the environment names the file; without it, nothing is written.
///
/// Each line has the CPU time of the thread in microseconds, and an event: `stage NAME`, `loop ITEMS LIMIT STEPS` (LIMIT: the
/// most items in progress that the memory allows, 0: any; STEPS: one letter per step, a: any order, o: in order,
/// or b: one step, in blocks of as many items as there are threads), `task ITEM
/// STEP`, `end` (of a task), and `done` (of a loop). Loops and tasks are nested.
class TaskTrace {
 public:
  /// Returns the trace of the process; null unless it is switched on and the calling thread is the one that began it.
  static TaskTrace* of_process();

  explicit TaskTrace(const std::string& file) : out_(file) {}

  void stage(const std::string& name);
  void begin_loop(std::size_t items, std::size_t limit, const std::string& steps);
  void begin_task(std::size_t item, std::size_t step);
  void end_task();
  void end_loop();

 private:
  std::ostream& event();

  std::ofstream out_;
};

}  // namespace dvi
