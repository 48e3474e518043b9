#include "dvi/core/scratch.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <string>

#include "dvi/core/error.h"

namespace dvi {
namespace {

constexpr std::size_t kDefaultBound = 2'000'000'000;
constexpr std::size_t kMinFileBytes = 1 << 16;  // smaller blocks stay in memory

/// An unlinked temporary file. Throws InputError if the folder has no space for it.
class NamelessFile {
 public:
  NamelessFile(const std::filesystem::path& folder, std::size_t bytes) {
    std::string name = (folder / "dvi-scratch-XXXXXX").string();
    file_ = mkstemp(name.data());
    if (file_ < 0) fail(folder, errno);
    unlink(name.c_str());
    if (const int error = posix_fallocate(file_, 0, static_cast<off_t>(bytes))) {
      close(file_);
      fail(folder, error);
    }
  }
  ~NamelessFile() { close(file_); }
  NamelessFile(const NamelessFile&) = delete;
  NamelessFile& operator=(const NamelessFile&) = delete;
  int number() const { return file_; }

 private:
  [[noreturn]] static void fail(const std::filesystem::path& folder, int error) {
    throw InputError(folder, std::string("has no space for data that do not fit into memory (") + std::strerror(error) + ")",
                     "free space, set TMPDIR to a folder with more space, or increase job.memory_mb");
  }
  int file_ = -1;
};

}  // namespace

std::filesystem::path find_temporary_folder() {
  const char* set = std::getenv("TMPDIR");
  return set != nullptr && *set == '\0' ? "/tmp" : std::filesystem::temp_directory_path();
}

const std::shared_ptr<Scratch>& Scratch::of_process() {
  static const auto scratch = std::make_shared<Scratch>(kDefaultBound);
  return scratch;
}

void Scratch::set_bound(std::size_t bound) {
  const std::lock_guard lock(mutex_);
  bound_ = bound;
}

std::size_t Scratch::bound() const {
  const std::lock_guard lock(mutex_);
  return bound_;
}

std::size_t Scratch::in_memory() const {
  const std::lock_guard lock(mutex_);
  return in_memory_;
}

void* Scratch::allocate(std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  if (bytes >= kMinFileBytes && in_memory_ + bytes > bound_) return map_file(bytes);
  void* block = ::operator new(bytes);
  in_memory_ += bytes;
  return block;
}

void* Scratch::map_file(std::size_t bytes) {
  const NamelessFile file(folder_, bytes);
  void* block = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file.number(), 0);
  if (block == MAP_FAILED) throw std::bad_alloc();
  files_[block] = bytes;
  return block;
}

void Scratch::release(void* block, std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  if (files_.erase(block) > 0) {
    munmap(block, bytes);
  } else {
    ::operator delete(block);
    in_memory_ -= bytes;
  }
}

void Scratch::page_out() {
  const std::lock_guard lock(mutex_);
  for (const auto& [block, bytes] : files_)
    madvise(block, bytes, MADV_DONTNEED);  // keeps the data, since the mapping is shared
}

std::size_t Scratch::on_disk() const {
  const std::lock_guard lock(mutex_);
  std::size_t sum = 0;
  for (const auto& [block, bytes] : files_) sum += bytes;
  return sum;
}

}  // namespace dvi
