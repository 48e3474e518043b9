#pragma once

#include "dvi/inputs/poses.h"
#include "dvi/inputs/recordings.h"
#include "dvi/objects/draw_masks.h"

namespace dvi::inputs {

/// The recordings together with what was found in them before the map is built. Refers to these only.
struct Inputs {
  const Recordings& drives;
  const Poses& poses;           ///< as `drives`
  const objects::Masks& masks;  ///< as `drives`
};

}  // namespace dvi::inputs
