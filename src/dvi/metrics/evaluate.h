#pragma once

#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/core/interrupt.h"
#include "dvi/metrics/evaluation.h"

namespace dvi::metrics {

/// Frames of another program, NAME.png or NAME.jpg.
struct ExternalFrames {
  std::string name;
  fs::path folder;
};

/// "NAME=DIR" each. UsageError where one is not, or two have one name.
std::vector<ExternalFrames> parse_external(const std::vector<std::string>& arguments);

struct EvaluationFolders {
  fs::path out;       ///< of a run: frames/, masks/, kind/, and confidence/ if there is one
  fs::path truth;     ///< NAME.png: true within 16 px of the masks, anything elsewhere
  fs::path ignore{};  ///< NAME.png: pixels above 0 are not scored; empty: all are
  std::vector<ExternalFrames> external{};
};

/// Scores a run against the truth, and the frames of other programs on the same pixels: outside the run's masks they count as
/// the input, whatever they show. Its one part, "eval", ticks once a frame
/// and program. Holds a frame a thread at a time. InputError where a
/// folder is not what it should be, a masked frame has no truth or other program's frame, or sizes differ.
Evaluation evaluate(const EvaluationFolders& folders, const BeginPart& begin = no_parts);

}  // namespace dvi::metrics
