#pragma once

#include "dvi/inputs/poses.h"
#include "dvi/inputs/recordings.h"
#include "dvi/objects/draw_masks.h"

namespace dvi::inputs {

/// The recordings with their poses and masks, from which the map and the views are made. Holds references only.
struct Inputs {
  const Recordings& drives;
  const Poses& poses;           ///< one per recording
  const objects::Masks& masks;  ///< one per recording
};

}  // namespace dvi::inputs
