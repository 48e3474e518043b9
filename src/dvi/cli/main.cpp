#include <malloc.h>

#include <opencv2/core/utility.hpp>

#include "dvi/cli/command.h"
#include "dvi/core/interrupt.h"

int main(int argc, char** argv) {
  // Frames are worked on in parallel; OpenCV's own threads inside them would only fight over the cores.
  cv::setNumThreads(1);
  // Freed images go back to the system at once, so that memory does not creep up with what lies between them.
  mallopt(M_MMAP_THRESHOLD, 1 << 18);
  dvi::catch_interrupts();
  dvi::Program program;
  dvi::add_run(program);
  dvi::add_map(program);
  dvi::add_eval(program);
  dvi::add_audit(program);
  dvi::add_check(program);
  dvi::add_forecast(program);
  dvi::add_holdout(program);
  dvi::add_selfcheck(program);
  dvi::add_synth(program);
  dvi::add_demo(program);
  dvi::add_config(program);
  dvi::add_formats(program);
  dvi::add_version(program);
  return program.main(argc, argv);
}
