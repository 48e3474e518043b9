#pragma once

#include <vector>

#include "dvi/core/interrupt.h"
#include "dvi/core/options.h"
#include "dvi/drive/view.h"
#include "dvi/map/static_map.h"

namespace dvi {

struct AlignOptions {
  bool enabled = true;
  int ring_px = 100;
  int points = 2000;
  int passes = 3;
  double max_angle_deg = 0.6;
  double finest_step_deg = 0.005;

  void describe(OptionTable& table) {
    table.section("align");
    table.add("enabled", enabled, "Refine the camera's pitch and yaw per frame (eq. 1).");
    table.add("ring_px", ring_px, {1, 2000}, "Width of the ring round the mask whose map points are compared.");
    table.add("points", points, {50, 100000}, "Most map points compared between two frames.");
    table.add("passes", passes, {1, 20}, "Rounds of search and joint solution.");
    table.add("max_angle_deg", max_angle_deg, {0.01, 5}, "Largest correction of a frame.");
    table.add("finest_step_deg", finest_step_deg, {0.0005, 0.5}, "Last step of the search.");
  }
};

/// What the refinement did to one view.
struct ViewAlignment {
  double pitch = 0, yaw = 0;  ///< radians, about the camera's x and y axis: camera_from_world = R(pitch, yaw) * given
  double energy_before = 0, energy_after = 0;  ///< eq. 1, mean over its points
  int points = 0;
};

/// Refines the rotation of all views of each drive by eq. 1 of the paper: E = sum |c(p) - c(q)|^2 over the map points p of the
/// ring round the mask, c(q) the colour that a frame near in time gives the point. The pitch and yaw between two frames is
/// found by discrete search, coarse to fine; the frames of a drive are then solved for jointly from all these pairs (least
/// squares on the differences), so that none is refined against one that is not. Positions stay. A drive's correction is kept
/// only if it lowers the energy. Returns one entry a view and changes the poses of `views`. One tick a view and pass.
std::vector<ViewAlignment> align(Views& views, const StaticMap& map, const AlignOptions& options, const Tick& tick = [] {});

/// The rotation of pitch about x and yaw about y.
Eigen::Matrix3d pitch_yaw(double pitch, double yaw);

}  // namespace dvi
