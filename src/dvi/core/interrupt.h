#pragma once

#include <cstddef>
#include <functional>

namespace dvi {

/// A function that a stage calls after each unit of work. It may throw Interrupted to end the stage.
using Tick = std::function<void()>;

/// A function that a stage calls at the beginning of each part of its work, with the number of calls of the returned Tick.
using BeginPart = std::function<Tick(const char* part, std::size_t ticks)>;
inline Tick no_parts(const char*, std::size_t) {
  return [] {};
}

/// Makes SIGINT and SIGTERM set a flag instead of ending the process.
void catch_interrupts();

/// Throws Interrupted if such a signal has arrived.
void throw_if_interrupted();

}  // namespace dvi
