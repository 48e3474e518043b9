#include "dvi/core/work_memory.h"

#include <algorithm>
#include <limits>

namespace dvi {
namespace {

constexpr std::size_t kUnlimited = std::numeric_limits<std::size_t>::max();

}  // namespace

const std::shared_ptr<WorkMemory>& WorkMemory::of_process() {
  static const auto memory = std::make_shared<WorkMemory>(kUnlimited);
  return memory;
}

std::size_t WorkMemory::count_items(std::size_t bytes_per_item, std::size_t max_items) const {
  if (bytes_per_item == 0) return max_items;
  return std::min(max_items, std::max<std::size_t>(1, bound_ / bytes_per_item));
}

std::size_t WorkMemory::count_free(std::size_t bytes_per_item, std::size_t items) const {
  const std::size_t bound = bound_;
  if (bytes_per_item == 0 || bound == kUnlimited) return 0;
  return bound - std::min(bound, bytes_per_item * items);
}

}  // namespace dvi
