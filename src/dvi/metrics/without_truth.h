#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/core/interrupt.h"
#include "dvi/metrics/artifacts.h"
#include "dvi/metrics/look.h"

namespace dvi::metrics {

/// The figures of a result that need neither a truth nor labels.
struct FiguresWithoutTruth {
  Artifacts artifacts;
  std::optional<Look> look;  ///< nothing without unobserved pixels that are filled
};

/// Computes the figures of the frames of a result: count_artifacts() and measure_look(). Reports two parts of progress,
/// "artifacts" and "look", with one tick per frame.
FiguresWithoutTruth measure_without_truth(const fs::path& out, const std::vector<std::string>& names, const BeginPart& begin);

}  // namespace dvi::metrics
