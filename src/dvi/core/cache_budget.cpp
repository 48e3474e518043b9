#include "dvi/core/cache_budget.h"

#include <malloc.h>

#include <algorithm>
#include <iterator>

#include "dvi/core/process_memory.h"

namespace dvi {
namespace {

constexpr std::size_t kDefaultBound = std::size_t{1000} << 20;
// Dropped bytes after which the heap is trimmed: at most, relative to the bound, and relative to it while the process takes too
// much memory. A trim costs about as much time as making them.
constexpr std::size_t kMaxTrimAfter = std::size_t{256} << 20, kTrimAfterBounds = 4, kTrimAfterBoundsAboveLimit = 1;

}  // namespace

const std::shared_ptr<CacheBudget>& CacheBudget::of_process() {
  static const auto budget = std::make_shared<CacheBudget>(kDefaultBound);
  return budget;
}

// Dropped items are destroyed after the lock is released, since that may take long. They leave holes in the heap that are not
// always reused.
void CacheBudget::destroy(Items dropped) {
  std::size_t bytes = 0;
  for (const auto& [rank, item] : dropped) bytes += item.size;
  dropped.clear();
  freed_ += bytes;
  if (bytes == 0 || !is_trim_due()) return;
  freed_ = 0;
  malloc_trim(0);
}

bool CacheBudget::is_trim_due() const {
  const std::size_t freed = freed_, in_memory = bound();
  if (freed >= std::min(kMaxTrimAfter, kTrimAfterBounds * in_memory)) return true;
  return trimmed_above_ > 0 && freed >= kTrimAfterBoundsAboveLimit * in_memory && resident_memory() > trimmed_above_;
}

CacheBudget::Items::iterator CacheBudget::drop(Items::iterator item, Items& dropped) {
  used_ -= item->second.size;
  by_key_.erase(item->second.key);
  const auto next = std::next(item);
  dropped.insert(items_.extract(item));
  return next;
}

void CacheBudget::drop_beyond_bound(Items& dropped) {
  for (auto item = items_.begin(); used_ > bound_ + loan_ && item != items_.end();) {
    if (item->second.key == newest_) {
      ++item;
      continue;
    }
    dropped_rank_ = std::max(dropped_rank_, item->first);
    item = drop(item, dropped);
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

CacheBudget::Loan::Loan(std::shared_ptr<CacheBudget> budget, std::size_t bytes) {
  if (bytes > 0 && budget->take_loan(bytes)) budget_ = std::move(budget);
}

CacheBudget::Loan::~Loan() {
  if (budget_) budget_->return_loan();
}

bool CacheBudget::take_loan(std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  if (loan_ > 0) return false;
  loan_ = bytes;
  return true;
}

void CacheBudget::return_loan() {
  Items dropped;
  {
    const std::lock_guard lock(mutex_);
    loan_ = 0;
    drop_beyond_bound(dropped);
  }
  destroy(std::move(dropped));
}

std::size_t CacheBudget::bound() const {
  const std::lock_guard lock(mutex_);
  return bound_ + loan_;
}

std::size_t CacheBudget::used() const {
  const std::lock_guard lock(mutex_);
  return used_;
}

CacheBudget::Value CacheBudget::find(const Key& key) {
  const std::lock_guard lock(mutex_);
  const auto it = by_key_.find(key);
  if (it == by_key_.end()) return nullptr;
  auto item = items_.extract(it->second);
  item.key() = dropped_rank_ + item.mapped().cost_per_byte;
  it->second = items_.insert(std::move(item));
  return it->second->second.value;
}

void CacheBudget::keep(const Key& key, Value value, std::size_t size, double cost) {
  const double cost_per_byte = cost / static_cast<double>(std::max<std::size_t>(size, 1));
  Items dropped;
  {
    const std::lock_guard lock(mutex_);
    newest_ = key;
    by_key_[key] = items_.emplace(dropped_rank_ + cost_per_byte, Item{key, std::move(value), size, cost_per_byte});
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
      if (it != by_key_.end()) drop(it->second, dropped);
    }
  }
  destroy(std::move(dropped));
}

}  // namespace dvi
