#pragma once

#include <cstddef>
#include <functional>

namespace dvi {

/// Called by a stage after each unit of work; may throw to end the stage (Interrupted).
using Tick = std::function<void()>;

/// Called by a stage as it begins each part of its work, with how often the tick that this returns will be called.
using BeginPart = std::function<Tick(const char* part, std::size_t ticks)>;
inline Tick no_parts(const char*, std::size_t) {
  return [] {};
}

/// From now on SIGINT and SIGTERM are remembered instead of ending the process at once.
void catch_interrupts();

/// Throws Interrupted once such a signal has arrived.
void throw_if_interrupted();

}  // namespace dvi
