#include "dvi/core/draft.h"

#include <system_error>
#include <utility>

#include "dvi/core/error.h"

namespace dvi {
namespace {

void discard(const fs::path& path) {
  std::error_code ignored;  // a file that cannot be removed is reported by the next write
  fs::remove_all(path, ignored);
}

}  // namespace

Draft::Draft(fs::path place, fs::path part) : place_(std::move(place)), part_(std::move(part)) { discard(part_); }

Draft::~Draft() {
  if (!finished_) discard(part_);
}

void Draft::finish() {
  std::error_code error;
  fs::rename(part_, place_, error);
  if (error) throw InputError(place_, "cannot be written (" + error.message() + ")", "free space or choose another folder");
  finished_ = true;
}

Draft draft_folder(const fs::path& folder) {
  const fs::path place = (fs::absolute(folder).lexically_normal() / "").parent_path();
  return {place, place.parent_path() / ("." + place.filename().string() + ".part")};
}

}  // namespace dvi
