#pragma once

#include <vector>

#include "dvi/core/progress.h"
#include "dvi/drive/label.h"
#include "dvi/objects/evidence.h"

namespace dvi::objects {

/// Labels of the objects that are removed, for each camera of the evidence, as its frames.
using Objects = std::vector<SharedLabels>;

/// The objects to remove (section 3.1 of the paper): those labeled, without the stationary ones if only moving ones are to be
/// removed; those that the detector sees, tracked over time; or, where a drive has neither masks nor labels, those that move in
/// its scans. A warning says where it is unknown which objects are stationary, so that all are removed.
Objects find_objects(const Evidence& evidence, const RemovalOptions& options, Progress& progress);

}  // namespace dvi::objects
