#pragma once

#include "dvi/drive/drive.h"
#include "dvi/labels/write_labels.h"
#include "dvi/objects/draw_masks.h"

namespace dvi::commands {

/// Divides the masks of a drive among its removed objects and outlines their parts. The polygons show the masks themselves,
/// with their dilation and shadows: a pixel belongs to the nearest object, and a connected part without an object is an object
/// by itself, which overlaps connect over time.
labels::DrawnLabels outline_masks(const Drive& drive, const objects::CameraMasks& masks);

}  // namespace dvi::commands
