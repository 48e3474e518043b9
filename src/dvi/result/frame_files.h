#pragma once

#include <string>

#include "dvi/core/files.h"
#include "dvi/drive/view.h"
#include "dvi/harmonize/filled_frame.h"

namespace dvi::result {

/// Writes the pictures of one frame, `out`/frames/NAME.png and so on, and its data for the report. May be called from several
/// threads at once.
void write_pictures(const fs::path& out, const std::string& name, const harmonize::FilledFrame& frame, const Views& views,
                    std::size_t view);

}  // namespace dvi::result
