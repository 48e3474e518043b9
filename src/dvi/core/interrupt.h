#pragma once

#include <functional>

namespace dvi {

/// Called by a stage after each unit of work; may throw to end the stage (Interrupted).
using Tick = std::function<void()>;

/// From now on SIGINT and SIGTERM are remembered instead of ending the process at once.
void catch_interrupts();

/// Throws Interrupted once such a signal has arrived.
void throw_if_interrupted();

}  // namespace dvi
