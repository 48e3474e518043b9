#pragma once

#include <optional>

#include "dvi/sample/candidates.h"

namespace dvi::regularize {

/// Energies of eq. 2.
struct Energies {
  double before = 0;  ///< The energy of the candidates as sampled.
  double after = 0;   ///< The energy of the shifted candidates.
};

/// The candidates, each shifted within its window by the solution of the MRF.
struct Labeling {
  sample::Candidates candidates;
  std::optional<Energies> energy;  ///< Nothing if the stage is disabled.
  int iterations = 0;              ///< The iterations of belief propagation.
};

}  // namespace dvi::regularize
