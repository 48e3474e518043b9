#pragma once

#include "dvi/sample/candidates.h"

namespace dvi::regularize {

/// The candidates after the MRF has moved each within its window, with the energies of eqs. 2-4.
struct Labelling {
  sample::Candidates candidates;
  double energy_before = 0;  ///< of the candidates as sampled
  double energy_after = 0;
  int iterations = 0;
};

}  // namespace dvi::regularize
