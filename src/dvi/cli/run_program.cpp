#include "dvi/cli/run_program.h"

#include <malloc.h>

#include <algorithm>
#include <thread>

#include <opencv2/core/utility.hpp>

#include "dvi/cli/command.h"
#include "dvi/core/interrupt.h"

namespace dvi::cli {

int run_program(int argc, char** argv) {
  // Frames are worked on in parallel; OpenCV's own threads inside them would only fight over the cores.
  cv::setNumThreads(1);
  // Freed images stay with the process for the next ones, up to a bound: mapping and clearing them anew for each frame was an
  // eighth of all CPU time. Blocks above the largest threshold that glibc takes still go back to the system at once.
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 512 << 20);
  // What one thread freed serves the others, too: glibc gives each a heap of its own, and all of them fill up with holes.
  mallopt(M_ARENA_MAX, std::max(1, static_cast<int>(std::thread::hardware_concurrency()) / 4));
  catch_interrupts();
  Program program;
  program.group("Clean a drive");
  add_run(program);
  add_plan(program);
  add_join(program);
  add_fill(program);
  add_finish(program);
  add_mask(program);
  add_map(program);
  add_export(program);
  add_import_fill(program);
  program.group("Look at a recording");
  add_check(program);
  add_forecast(program);
  add_init(program);
  add_convert(program);
  add_formats(program);
  program.group("Check a result");
  add_report(program);
  add_inspect(program);
  add_eval(program);
  add_audit(program);
  add_holdout(program);
  add_selfcheck(program);
  program.group("Try it");
  add_demo(program);
  add_synth(program);
  program.group("The program");
  add_config(program);
  add_completion(program);
  add_version(program);
  return program.main(argc, argv);
}

}  // namespace dvi::cli
