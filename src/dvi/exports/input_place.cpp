#include "dvi/exports/input_place.h"

#include <algorithm>

#include "dvi/core/error.h"

namespace dvi::exports {

RecordedInput find_input(const Result& result, const ExportOptions& options) {
  RecordedInput input = result.input();
  if (!options.input.empty()) input.path = options.input;
  input.path = (fs::absolute(input.path).lexically_normal() / "").parent_path();
  return input;
}

bool is_inside(const fs::path& path, const fs::path& folder) {
  const fs::path inner = fs::weakly_canonical(path), outer = fs::weakly_canonical(folder);
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

void require_outside(const fs::path& place, const fs::path& recording) {
  if (fs::is_directory(recording) && is_inside(place, recording))
    throw InputError(place, "is in the folder of the recording", "choose a folder outside of it");
}

}  // namespace dvi::exports
