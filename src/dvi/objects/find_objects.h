#pragma once

#include <vector>

#include "dvi/core/progress.h"
#include "dvi/objects/camera_objects.h"
#include "dvi/objects/evidence.h"
#include "dvi/objects/object_returns.h"

namespace dvi::objects {

/// The removed objects, per camera of the evidence.
using Objects = std::vector<CameraObjects>;

/// Finds the objects to remove (section 3.1 of the paper), by the sources of each camera: the labeled objects, without the
/// stationary ones with Remove::moving; the objects that the detector finds, tracked over time; the labeled objects in the
/// scans; and the objects that move in the scans. Each source numbers its objects after those of the sources before it. Objects
/// that masks, labels, or detections show in some frames are completed in all frames and cameras of their drive
/// (completion/complete.h), which needs poses and scans. Warnings state when the motion state of objects is unknown, so that
/// all are removed, and when objects cannot be completed.
Objects find_objects(const Evidence& evidence, const RemovalOptions& options, Progress& progress);

/// Does the same search, and returns the objects of the target's drive where its scans show them. The numbers are those of
/// find_objects(); objects that no image shows have others. `evidence` must outlive the result.
ScannedObjects find_scanned_objects(const Evidence& evidence, const RemovalOptions& options, Progress& progress);

}  // namespace dvi::objects
