#include "dvi/core/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "dvi/core/error.h"

namespace dvi {
namespace {

std::string describe_this_process() {
  std::array<char, 256> host{};
  if (gethostname(host.data(), host.size() - 1) != 0) host[0] = '\0';
  return "process " + std::to_string(getpid()) + " on " + (host[0] == '\0' ? "an unnamed host" : host.data());
}

}  // namespace

FolderLock::FolderLock(const fs::path& folder, const fs::path& file, Hold hold)
    : descriptor_(open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666)), hold_(hold) {
  if (descriptor_ < 0)
    throw InputError(file, std::string("cannot be written (") + std::strerror(errno) + ")", "choose a writable folder");
  const bool shared = hold == Hold::shared;
  if (flock(descriptor_, (shared ? LOCK_SH : LOCK_EX) | LOCK_NB) != 0) {
    const bool taken = errno == EWOULDBLOCK;
    if (!taken && shared) return;
    const std::string reason = std::strerror(errno);
    close(descriptor_);
    if (!taken) throw InputError(file, "cannot be locked (" + reason + ")", "choose a folder on another file system");
    const std::string holder = read_file(file);
    throw InputError(folder, "is being written by " + (holder.empty() ? "another process" : holder),
                     "wait for it, or choose another folder");
  }
  if (shared) return;
  const std::string holder = describe_this_process();
  // The text is only for the message to others: the lock works without it, also on a full disk.
  [[maybe_unused]] const bool named =
      ftruncate(descriptor_, 0) == 0 && pwrite(descriptor_, holder.data(), holder.size(), 0) > 0;
}

FolderLock::~FolderLock() {
  if (hold_ == Hold::alone) {
    [[maybe_unused]] const int emptied = ftruncate(descriptor_, 0);  // otherwise the next holder overwrites only a part
  }
  close(descriptor_);
}

}  // namespace dvi
