#include <malloc.h>

#include <algorithm>
#include <thread>

#include <opencv2/core/utility.hpp>

#include "dvi/cli/command.h"
#include "dvi/core/interrupt.h"

int main(int argc, char** argv) {
  // Frames are worked on in parallel; OpenCV's own threads inside them would only fight over the cores.
  cv::setNumThreads(1);
  // Freed images stay with the process for the next ones, up to a bound: mapping and clearing them anew for each frame was an
  // eighth of all CPU time. Blocks above the largest threshold that glibc takes still go back to the system at once.
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 512 << 20);
  // What one thread freed serves the others, too: glibc gives each a heap of its own, and all of them fill up with holes.
  mallopt(M_ARENA_MAX, std::max(1, static_cast<int>(std::thread::hardware_concurrency()) / 4));
  dvi::catch_interrupts();
  dvi::cli::Program program;
  program.group("Clean a drive");
  dvi::cli::add_run(program);
  dvi::cli::add_plan(program);
  dvi::cli::add_join(program);
  dvi::cli::add_fill(program);
  dvi::cli::add_finish(program);
  dvi::cli::add_mask(program);
  dvi::cli::add_map(program);
  dvi::cli::add_export(program);
  dvi::cli::add_import_fill(program);
  program.group("Look at a recording");
  dvi::cli::add_check(program);
  dvi::cli::add_forecast(program);
  dvi::cli::add_init(program);
  dvi::cli::add_convert(program);
  dvi::cli::add_formats(program);
  program.group("Check a result");
  dvi::cli::add_report(program);
  dvi::cli::add_inspect(program);
  dvi::cli::add_eval(program);
  dvi::cli::add_audit(program);
  dvi::cli::add_holdout(program);
  dvi::cli::add_selfcheck(program);
  program.group("Try it");
  dvi::cli::add_demo(program);
  dvi::cli::add_synth(program);
  program.group("The program");
  dvi::cli::add_config(program);
  dvi::cli::add_completion(program);
  dvi::cli::add_version(program);
  return program.main(argc, argv);
}
