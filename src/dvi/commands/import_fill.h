#pragma once

#include <cstddef>
#include <string>

#include "dvi/core/files.h"
#include "dvi/core/progress.h"

namespace dvi::commands {

/// The effect of an import, or of its removal.
struct ImportReport {
  std::size_t frames = 0;  ///< changed frames
  std::size_t pixels = 0;  ///< imported pixels; 0 after a removal
  double change = 0;       ///< mean change of the fill at import by harmonization, in gray levels
};

/// Fills the unobserved pixels of a result (interpolated, synthesized, left empty, or imported before) from another program's
/// images: `frames` is a folder with one 8-bit color PNG or JPEG per frame. Images are assigned by name (NAME, or NAME_mask
/// with digits as LaMa writes it); frames without unobserved pixels then need none. If no image has the name of a frame, they
/// are assigned in natural order, and their number must be that of the frames. The fill is adapted to the frame around it
/// (harmonize::adapt_fill()); all other pixels remain as the run wrote them. Every image is checked before the first frame is
/// changed. Throws InputError if `out` is not a finished result, or if the images differ in number, size, or bit depth, have
/// red and blue swapped, or do not show the frames.
ImportReport import_fill(const fs::path& out, const fs::path& frames, Progress& progress);

/// Restores the images that the run wrote. Throws InputError if `out` is not a finished result.
ImportReport undo_import(const fs::path& out, Progress& progress);

/// Format a report as a JSON document, and as lines for the user.
std::string to_json(const ImportReport& report, const fs::path& out);
std::string brief(const ImportReport& report, const fs::path& out);

}  // namespace dvi::commands
