#include "dvi/core/cache_budget.h"

#include <malloc.h>

namespace dvi {
namespace {

constexpr std::size_t kDefaultBound = std::size_t{1000} << 20;
constexpr std::size_t kTrimAfter = std::size_t{256} << 20;  // bytes dropped; a trim costs about what it takes to make them

}  // namespace

const std::shared_ptr<CacheBudget>& CacheBudget::of_process() {
  static const auto budget = std::make_shared<CacheBudget>(kDefaultBound);
  return budget;
}

// Dropped items are destroyed by the callers, after the lock is released: that may take long. They leave holes in the heap,
// which others of their size do not always fill.
void CacheBudget::destroy(Items dropped) {
  std::size_t bytes = 0;
  for (const Item& item : dropped) bytes += item.size;
  dropped.clear();
  freed_ += bytes;
  if (bytes == 0 || freed_ < kTrimAfter) return;
  freed_ = 0;
  malloc_trim(0);
}

void CacheBudget::drop_beyond_bound(Items& dropped) {
  while (used_ > bound_ && items_.size() > 1) {
    used_ -= items_.back().size;
    by_key_.erase(items_.back().key);
    dropped.splice(dropped.end(), items_, std::prev(items_.end()));
  }
}

void CacheBudget::set_bound(std::size_t bound) {
  Items dropped;
  {
    const std::lock_guard lock(mutex_);
    bound_ = bound;
    drop_beyond_bound(dropped);
  }
  destroy(std::move(dropped));
}

std::size_t CacheBudget::used() const {
  const std::lock_guard lock(mutex_);
  return used_;
}

CacheBudget::Value CacheBudget::find(const void* cache, std::size_t index) {
  const std::lock_guard lock(mutex_);
  const auto it = by_key_.find({cache, index});
  if (it == by_key_.end()) return nullptr;
  items_.splice(items_.begin(), items_, it->second);
  return it->second->value;
}

void CacheBudget::keep(const void* cache, std::size_t index, Value value, std::size_t size) {
  Items dropped;
  {
    const std::lock_guard lock(mutex_);
    items_.push_front({{cache, index}, std::move(value), size});
    by_key_[items_.front().key] = items_.begin();
    used_ += size;
    drop_beyond_bound(dropped);
  }
  destroy(std::move(dropped));
}

void CacheBudget::forget(const void* cache, std::size_t count) {
  Items dropped;
  {
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < count; ++i) {
      const auto it = by_key_.find({cache, i});
      if (it == by_key_.end()) continue;
      used_ -= it->second->size;
      dropped.splice(dropped.end(), items_, it->second);
      by_key_.erase(it);
    }
  }
  destroy(std::move(dropped));
}

}  // namespace dvi
