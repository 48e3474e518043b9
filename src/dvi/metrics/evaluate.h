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

/// Parses arguments of the form "NAME=DIR". Throws UsageError if one has another form or if a name occurs twice.
std::vector<ExternalFrames> parse_external(const std::vector<std::string>& arguments);

struct EvaluationFolders {
  fs::path out;       ///< result of a run: frames/, masks/, kind/, and optionally confidence/
  fs::path truth;     ///< NAME.png: must be true within 16 px of the masks; empty: only figures without a truth
  fs::path ignore{};  ///< NAME.png: pixels above 0 are not scored; may be empty
  std::vector<ExternalFrames> external{};
  fs::path masks{};  ///< NAME.png: pixels above 0 are scored, instead of the masks of the run; may be empty
};

/// Scores a run against the truth, and the frames of other programs on the same pixels. Outside the masks of the run and the
/// scored pixels, frames of other programs are replaced by the input. Reports a part of progress, "eval", with one tick per
/// frame and program; without a truth, also a part "look". Keeps one frame per thread in memory. Throws InputError if a folder
/// has other contents, if the truth or another program's frame is missing for a masked frame, if `masks` lacks a frame, or if
/// sizes differ. Throws UsageError if the other folders are given without a truth.
Evaluation evaluate(const EvaluationFolders& folders, const BeginPart& begin = no_parts);

}  // namespace dvi::metrics
