#pragma once

#include "dvi/core/files.h"

namespace dvi {

/// Keeps a folder to one process, or to some that share it: an advisory lock (flock) on a file in it. The system frees it when
/// the process ends, however it ends.
class FolderLock {
 public:
  enum class Hold { alone, shared };

  /// InputError, naming process and host of who holds it alone, where another process keeps `folder` to itself, or others share
  /// it and it is wanted alone. `file` is made if it is missing and stays behind empty: a file that is removed and made again
  /// could be locked twice. Where a file system knows no locks, sharing goes without.
  FolderLock(const fs::path& folder, const fs::path& file, Hold hold = Hold::alone);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_ = -1;
  Hold hold_;
};

}  // namespace dvi
