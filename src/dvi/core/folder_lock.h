#pragma once

#include "dvi/core/files.h"

namespace dvi {

/// Keeps a folder to one process: an advisory lock (flock) on a file in it. The system frees it when the process ends, however
/// it ends.
class FolderLock {
 public:
  /// InputError, naming process and host of the holder, where another process writes into `folder`. `file` is made if it is
  /// missing and stays behind empty: a file that is removed and made again could be locked twice.
  FolderLock(const fs::path& folder, const fs::path& file);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace dvi
