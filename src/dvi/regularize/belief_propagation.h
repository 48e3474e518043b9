#pragma once

#include <vector>

#include "dvi/regularize/shift_field.h"

namespace dvi::regularize {

/// The labels found by belief propagation, and their energies.
struct BeliefPropagation {
  std::vector<int> labels;   ///< One per node.
  double energy_before = 0;  ///< The energy of label 0 at all nodes.
  double energy_after = 0;   ///< The energy of `labels`; never larger than energy_before.
  int iterations = 0;        ///< Number of iterations until no message changed, or the maximum.
};

/// Computes eq. 2: the data costs (eq. 3) of all nodes and the discontinuity costs (eq. 4) of all edges, each once.
double compute_energy(const ShiftField& field, const std::vector<int>& labels);

/// Minimizes the energy by loopy belief propagation (min-sum). An iteration is one sweep in raster order and one in the
/// opposite order. Returns the labels with the lowest energy of all iterations.
BeliefPropagation propagate_beliefs(const ShiftField& field, int iterations);

}  // namespace dvi::regularize
