#pragma once

#include <optional>

#include "dvi/sample/candidates.h"

namespace dvi::regularize {

/// Eqs. 2-4.
struct Energies {
  double before = 0;  ///< of the candidates as sampled
  double after = 0;
};

/// The candidates after the MRF has moved each within its window.
struct Labeling {
  sample::Candidates candidates;
  std::optional<Energies> energy;  ///< none where nothing was to be moved
  int iterations = 0;
};

}  // namespace dvi::regularize
