#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "dvi/core/interrupt.h"
#include "dvi/drive/drive.h"
#include "dvi/scan_match/scan_features.h"

namespace dvi::registration {

/// One drive, the target or a source drive.
struct DriveTrack {
  const Drive* drive = nullptr;
  Trajectory world_from_lidar;  ///< in the target's world, or in any
  bool shares_world = false;    ///< of a source drive: its poses claim to be in the target's world
};

/// How well a source drive fits where it was put.
struct PlacementFigures {
  SE3 target_from_source;             ///< from the world of its own trajectory, on the whole
  double overlap = 0;                 ///< share of its scans that lie on what earlier drives saw
  double residual_m = 0;              ///< of these, RMS across surfaces
  double bound_m = 0, bound_deg = 0;  ///< 95 % of errors are smaller
  std::size_t things = 0;             ///< single things that say something of the place (confirm.h) ...
  std::size_t things_agree = 0;       ///< ... and those that agree
  double passed_share = 0;            ///< of what stands for one drive, what the rays of the other went through
  double rival = 0;                   ///< how well the second best place fits, of this one; 1: as well
};

struct Placement {
  Trajectory world_from_lidar;  ///< in the target's world, bent onto the target; empty: not found
  PlacementFigures figures;     ///< where it is not found: of the best place there was

  bool found() const { return !world_from_lidar.empty(); }
};

struct Registered {
  Trajectory target;               ///< its trajectory, bent where source drives say so
  std::vector<Placement> sources;  ///< as the source drives
};

/// Lays source drives onto the target by their scans (docs/algorithms/registration.md). Where nothing is known, places are
/// recognized from above (bird_view.h); what claims to share the target's world is looked for there first. A place counts once
/// the single things there confirm it (confirm.h) and no other place does nearly as well. From there each scan is registered to
/// the scans of the drives placed so far, as far as they overlap, and one pose graph ties all drives together. A source drive
/// that overlaps with another source drive only is placed by that. `hold_target`: its trajectory stays as it is. One part a
/// source drive, "register".
Registered register_drives(const DriveTrack& target, const std::vector<DriveTrack>& sources,
                           const scan_match::MatchOptions& options, bool hold_target, const BeginPart& begin = no_parts);

}  // namespace dvi::registration
