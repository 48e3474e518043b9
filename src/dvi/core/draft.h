#pragma once

#include "dvi/core/files.h"

namespace dvi {

/// A file or folder that is made beside its place and renamed by finish(), so that the place is whole or absent. What is not
/// finished is removed again.
class Draft {
 public:
  /// `part` lies in the same folder as `place`. What a killed process left there is removed.
  Draft(fs::path place, fs::path part);
  ~Draft();
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;

  const fs::path& path() const { return part_; }  ///< where to write
  /// InputError where the place cannot be taken.
  void finish();

 private:
  fs::path place_, part_;
  bool finished_ = false;
};

/// Of a folder: hidden beside it, by a name that another process for the same place takes over.
Draft draft_folder(const fs::path& folder);

}  // namespace dvi
