#pragma once

#include "dvi/core/files.h"
#include "dvi/core/interrupt.h"
#include "dvi/eval/evaluation.h"

namespace dvi {

/// Scores the output folder of a run (its frames/, masks/ and kind/) against truth/NAME.png, which must be true within 16 px
/// of the masks and may be anything elsewhere. Pixels of ignore/NAME.png (a folder, or empty for none) above 0 are not
/// scored. Holds a frame a thread at a time. InputError where a folder is not what it should be, a masked frame has no truth,
/// or sizes differ.
Evaluation evaluate(const fs::path& out, const fs::path& truth, const fs::path& ignore, const Tick& tick = {});

}  // namespace dvi
