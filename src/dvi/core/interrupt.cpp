#include "dvi/core/interrupt.h"

#include <csignal>

#include "dvi/core/error.h"

namespace dvi {
namespace {

volatile std::sig_atomic_t interrupted = 0;

// A second signal ends the process the usual way: the first may be waiting for a long step.
void remember(int signal) {
  interrupted = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

void catch_interrupts() {
  std::signal(SIGINT, remember);
  std::signal(SIGTERM, remember);
}

void throw_if_interrupted() {
  if (interrupted != 0) throw Interrupted();
}

}  // namespace dvi
