#include "dvi/inputs/memory_plan.h"

#include <algorithm>

#include <fmt/format.h>

#include "dvi/core/cache_budget.h"
#include "dvi/core/scratch.h"
#include "dvi/core/work_memory.h"

namespace dvi::inputs {
namespace {

/// Parameters of the plan. The bytes per pixel were measured with images of 3840x2160 px: the peak memory with one frame in
/// progress, less that before the fill.
struct MemoryPlanParams {
  int program_mb = 150;                     ///< Code, libraries, and the heap's fragmentation.
  std::size_t frame_bytes_per_pixel = 145;  ///< Of a frame while it is filled, smoothed, and written.
  std::size_t least_bytes_per_pixel = 20;   ///< Of the caches and the map, so that the images in use fit.
};
constexpr MemoryPlanParams kMemoryPlan;

constexpr std::size_t kMegabyte = 1'000'000;

std::size_t count_pixels(cv::Size image) {
  return static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
}

}  // namespace

std::size_t estimate_frame_bytes(cv::Size image) { return kMemoryPlan.frame_bytes_per_pixel * count_pixels(image); }

MemoryPlan plan_memory(int memory_mb, cv::Size image) {
  const auto shared = static_cast<std::size_t>(std::max(memory_mb - kMemoryPlan.program_mb, memory_mb / 2)) * kMegabyte;
  const std::size_t frame = estimate_frame_bytes(image), least = kMemoryPlan.least_bytes_per_pixel * count_pixels(image);
  MemoryPlan out;
  out.work_bytes = std::max(shared / 3, std::min(frame, shared - std::min(shared, least)));
  out.map_bytes = out.cache_bytes = (shared - out.work_bytes) / 2;
  out.needed_mb = kMemoryPlan.program_mb + static_cast<int>((frame + least) / kMegabyte) + 1;
  return out;
}

std::optional<std::string> bound_memory(int memory_mb, cv::Size image) {
  const MemoryPlan plan = plan_memory(memory_mb, image);
  Scratch::of_process()->set_bound(plan.map_bytes);
  CacheBudget::of_process()->set_bound(plan.cache_bytes);
  CacheBudget::of_process()->set_trimmed_above(static_cast<std::size_t>(memory_mb) * kMegabyte);
  WorkMemory::of_process()->set_bound(plan.work_bytes);
  if (memory_mb >= plan.needed_mb) return std::nullopt;
  return fmt::format(
      "images of {}x{} px need {} MB to fill one frame at a time, but job.memory_mb is {}: the run may exceed it; set it to at "
      "least that (--set job.memory_mb={})",
      image.width, image.height, plan.needed_mb, memory_mb, plan.needed_mb);
}

void use_free_map_memory_for_work() {
  const Scratch& map = *Scratch::of_process();
  WorkMemory& work = *WorkMemory::of_process();
  work.set_bound(work.bound() + map.bound() - std::min(map.bound(), map.in_memory()));
}

}  // namespace dvi::inputs
