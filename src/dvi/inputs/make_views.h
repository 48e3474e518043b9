#pragma once

#include <cstddef>
#include <optional>

#include "dvi/align/align.h"
#include "dvi/core/progress.h"
#include "dvi/drive/view.h"
#include "dvi/exposure/exposure.h"
#include "dvi/inputs/find_masks.h"
#include "dvi/inputs/poses.h"
#include "dvi/inputs/recordings.h"

namespace dvi::inputs {

/// The view of a frame, by its index; none where the trajectory holds no pose for its time.
std::optional<View> posed_view(const Drive& drive, std::size_t frame, const Trajectory& world_from_lidar);

/// All posed frames of all drives. Frames without a pose are left out with a warning.
Views make_views(const Recordings& drives, const Poses& poses, const Masks& masks, Progress& progress);

/// All frames of all drives, whether posed or not, each with the identity for its pose: for what does not look at poses.
Views make_unposed_views(const Recordings& drives, const Masks& masks);

/// The same views with the gains and poses that were found for them.
Views refined(const Views& views, const exposure::Gains& gains, const align::Cameras& cameras);

}  // namespace dvi::inputs
