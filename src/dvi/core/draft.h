#pragma once

#include "dvi/core/files.h"

namespace dvi {

/// A file or folder that is written beside its final path and renamed by finish(), so that the final path is complete or
/// absent. Without finish(), it is removed.
class Draft {
 public:
  /// `part` has to be in the same folder as `place`. Removes a file that a killed process left at `part`.
  Draft(fs::path place, fs::path part);
  ~Draft();
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;

  /// Returns the path to write to.
  const fs::path& path() const { return part_; }
  /// Renames the draft to `place`. Throws InputError if that fails.
  void finish();

 private:
  fs::path place_, part_;
  bool finished_ = false;
};

/// Returns the draft of a folder: a hidden folder beside it, with a name that a later process for the same folder reuses.
Draft draft_folder(const fs::path& folder);

}  // namespace dvi
