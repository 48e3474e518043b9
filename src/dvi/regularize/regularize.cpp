#include "dvi/regularize/regularize.h"

#include <cstddef>
#include <optional>
#include <utility>

#include "dvi/core/error.h"
#include "dvi/depth/target.h"
#include "dvi/regularize/belief_propagation.h"
#include "dvi/regularize/labeling.h"
#include "dvi/regularize/shift_field.h"
#include "dvi/sample/candidates.h"

namespace dvi::regularize {
namespace {

/// Shifts a pixel's leading candidate. The further ones are removed, because their shifts are unknown.
void shift(sample::Candidates& candidates, std::size_t pixel, cv::Point2f by) {
  if (by == cv::Point2f()) return;
  candidates.leading[pixel].position += by;
  for (sample::Candidate& other : candidates.others(pixel)) other = {};
}

}  // namespace

Labeling regularize(sample::Candidates candidates, const depth::Target& target, const RegularizeOptions& options) {
  if (options.window % 2 == 0) throw UsageError("regularize.window must be odd");
  if (!options.enabled) return {std::move(candidates), std::nullopt, 0};
  const ShiftField field = make_shift_field(candidates, target, options.window, options.alpha);
  const BeliefPropagation solution = propagate_beliefs(field, options.iterations);
  Labeling out{std::move(candidates), Energies{solution.energy_before, solution.energy_after}, solution.iterations};
  for (std::size_t node = 0; node < field.nodes(); ++node)
    shift(out.candidates, static_cast<std::size_t>(field.pixel[node]), cv::Point2f(field.shifts[solution.labels[node]]));
  return out;
}

}  // namespace dvi::regularize
