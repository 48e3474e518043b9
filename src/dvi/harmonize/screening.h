#pragma once

#include <cstdint>

#include "dvi/harmonize/copies.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {

/// Whether the data term of eq. 5 also applies to copies from the target's own drive. In the published form (`published`) the
/// solution follows the boundary even if the boundary is inconsistent.
enum class BoundaryModel : std::uint8_t { robust, published };

/// Computes the screening weights of the copies. With a weight w, a difference between sources and target fades within 1 /
/// sqrt(w) pixels from the boundary. Copies of other drives have a constant weight, because drives differ at the boundary in
/// more than illumination: shadows, parked cars, the sky. For other copies, the weight of the robust model grows with the
/// spread of the differences along the boundary nearby, and with the contradictions of sources at seams, which indicate
/// position errors or changes of the scene.
Screening compute_screening(const Copies& copies, const sample::Candidates& candidates, BoundaryModel model);

}  // namespace dvi::harmonize
