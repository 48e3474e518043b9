#pragma once

#include <cstdint>
#include <vector>

#include "dvi/objects/completion/masked_returns.h"
#include "dvi/objects/completion/object_space.h"
#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// The parts of objects that were found in scans.
struct ObjectParts {
  const std::vector<OccupiedVoxel>& voxels;  ///< with the number of their group
  const std::vector<SharedTrack>& tracks;
  const MovingReturns& returns;  ///< of the scans
};

/// The numbers of the objects to which parts belong.
struct Identities {
  std::vector<int> of_voxel, of_track;
};

/// Determines which parts belong to one object. A track belongs to the labeled object in whose 3D boxes most of its returns
/// are, else it is an object of its own. A group of voxels belongs to the labeled object, or else to the track, that fills most
/// of it, else it is an object of its own. Labeled objects have the numbers of their labels, others follow.
Identities identify(const CameraMaskEvidence& labeled, const ObjectParts& parts);

}  // namespace dvi::objects
