#pragma once

#include <vector>

#include "dvi/regularize/shift_field.h"

namespace dvi::regularize {

/// A label for each node, and what it costs.
struct BeliefPropagation {
  std::vector<int> labels;
  double energy_before = 0;  ///< of no shift anywhere
  double energy_after = 0;   ///< of `labels`; never above energy_before
  int iterations = 0;        ///< until no message changed, or as many as were allowed
};

/// Eq. 2: the data costs of all nodes and the discontinuity costs (eq. 4) of all edges, each once.
double energy(const ShiftField& field, const std::vector<int>& labels);

/// Min-sum loopy belief propagation, an iteration being one sweep in raster order and one back. Keeps the cheapest labeling
/// it met.
BeliefPropagation propagate(const ShiftField& field, int iterations);

}  // namespace dvi::regularize
