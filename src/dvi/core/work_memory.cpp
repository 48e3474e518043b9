#include "dvi/core/work_memory.h"

#include <algorithm>
#include <limits>

namespace dvi {

const std::shared_ptr<WorkMemory>& WorkMemory::of_process() {
  static const auto memory = std::make_shared<WorkMemory>(std::numeric_limits<std::size_t>::max());
  return memory;
}

std::size_t WorkMemory::count_items(std::size_t bytes_per_item, std::size_t max_items) const {
  if (bytes_per_item == 0) return max_items;
  return std::min(max_items, std::max<std::size_t>(1, bound_ / bytes_per_item));
}

}  // namespace dvi
