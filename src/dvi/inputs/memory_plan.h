#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include <opencv2/core/types.hpp>

namespace dvi::inputs {

/// How `job.memory_mb` is divided: after 150 MB (at most half) for the program, a third each for the map, for caches, and for
/// work in progress. If a third is too small for one frame in progress, work gets more. While a loop leaves a part of the
/// work's share free, caches use it (lend_free_memory()).
struct MemoryPlan {
  std::size_t map_bytes = 0, cache_bytes = 0, work_bytes = 0;
  int needed_mb = 0;  ///< The least `job.memory_mb` for one frame in progress.
};

/// Divides the memory for images of the given size; a size of 0 x 0 is unknown.
MemoryPlan plan_memory(int memory_mb, cv::Size image);

/// Sets the bounds of Scratch, CacheBudget, and WorkMemory of the process. Returns a warning if `memory_mb` is too small for
/// one frame in progress.
std::optional<std::string> bound_memory(int memory_mb, cv::Size image);

/// Adds the part of the map's share that the map does not occupy to that of work in progress. Call it after the map is built.
void use_free_map_memory_for_work();

/// Returns the memory that one frame takes while it is filled, smoothed, and written.
std::size_t estimate_frame_bytes(cv::Size image);

}  // namespace dvi::inputs
