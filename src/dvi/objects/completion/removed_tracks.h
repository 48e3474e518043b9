#pragma once

#include <vector>

#include "dvi/objects/completion/masked_returns.h"
#include "dvi/objects/moving_returns.h"
#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// Returns the moving objects of a drive that masks of its cameras show in several scans.
std::vector<SharedTrack> find_removed_tracks(const std::vector<CameraMaskEvidence>& cameras, const MovingReturns& returns,
                                             const SharedTracks& tracks);

}  // namespace dvi::objects
