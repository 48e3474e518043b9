#include "dvi/core/interrupt.h"

#include <signal.h>

#include <csignal>

#include "dvi/core/error.h"

namespace dvi {
namespace {

volatile std::sig_atomic_t interrupted = 0;

void remember(int) { interrupted = 1; }

}  // namespace

void catch_interrupts() {
  struct sigaction action{};
  action.sa_handler = remember;
  // Without SA_RESTART, a blocked read returns. A second signal ends the process immediately, since the first one may wait for
  // a long step.
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
}

void throw_if_interrupted() {
  if (interrupted != 0) throw Interrupted();
}

}  // namespace dvi
