#pragma once

#include <optional>

#include "dvi/harmonize/filled_frame.h"
#include "dvi/regularize/labeling.h"

namespace dvi::result {

/// A frame after all stages, with the figures that the stages report for it.
struct FilledView {
  harmonize::FilledFrame frame;
  std::optional<regularize::Energies> energy;  ///< of eqs. 2-4, if belief propagation ran
};

}  // namespace dvi::result
