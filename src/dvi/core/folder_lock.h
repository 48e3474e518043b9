#pragma once

#include "dvi/core/files.h"

namespace dvi {

/// Locks a folder for one process, or for several that share it, by an advisory lock (flock) on a file in it. The system
/// releases the lock whenever the process ends.
class FolderLock {
 public:
  enum class Hold { alone, shared };

  /// Takes the lock. Throws InputError with process and host of the holder if another process holds `folder` alone, or if it is
  /// wanted alone and others share it. `file` is created if necessary and is left empty: a file that is removed and created
  /// again could be locked twice. If the file system does not support locks, a shared lock is skipped.
  FolderLock(const fs::path& folder, const fs::path& file, Hold hold = Hold::alone);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_ = -1;
  Hold hold_;
};

}  // namespace dvi
