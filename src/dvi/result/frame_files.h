#pragma once

#include <cstddef>
#include <string>

#include "dvi/core/files.h"
#include "dvi/drive/view.h"
#include "dvi/harmonize/filled_frame.h"

namespace dvi::result {

/// A frame of the result in the folder `out`.
struct OutputFrame {
  fs::path out;
  std::string name;
  std::size_t number = 0;  ///< index of its view
};

/// Writes the pictures of one frame, `out`/frames/NAME.png and so on, and its data for the report. May be called from several
/// threads at once.
void write_pictures(const OutputFrame& to, const harmonize::FilledFrame& frame, const Views& views);

}  // namespace dvi::result
