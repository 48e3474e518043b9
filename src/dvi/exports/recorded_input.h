#pragma once

#include <functional>

#include "dvi/core/files.h"
#include "dvi/datasets/reader.h"

namespace dvi::exports {

/// The recording from which a result was made.
struct RecordedInput {
  fs::path path;
  datasets::ReadOptions read;  ///< the topics of the run; the camera is that of the result
};

/// Finds the recording of a finished result of `dvi run` (commands::find_recorded_input()).
using FindInput = std::function<RecordedInput(const fs::path& out)>;

}  // namespace dvi::exports
