#include "dvi/exports/input_place.h"

#include "dvi/core/error.h"
#include "dvi/core/path_inside.h"

namespace dvi::exports {

RecordedInput find_input(const Result& result, const ExportOptions& options) {
  RecordedInput input = result.input();
  if (!options.input.empty()) input.path = options.input;
  input.path = (fs::absolute(input.path).lexically_normal() / "").parent_path();
  return input;
}

void require_outside(const fs::path& place, const fs::path& recording) {
  if (fs::is_directory(recording) && is_inside(place, recording))
    throw InputError(place, "is in the folder of the recording", "choose a folder outside of it");
}

}  // namespace dvi::exports
