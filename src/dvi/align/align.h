#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dvi/core/interrupt.h"
#include "dvi/core/options.h"
#include "dvi/drive/view.h"
#include "dvi/map/visible_points.h"

namespace dvi::align {

/// joint: all frames of a sequence at once; paper: the published search.
enum class AlignMethod { joint, paper };
constexpr auto names_of(AlignMethod) {
  return std::array{std::pair{AlignMethod::joint, "joint"}, std::pair{AlignMethod::paper, "paper"}};
}

struct AlignOptions {
  bool enabled = true;
  AlignMethod method = AlignMethod::joint;
  int points = 2000;
  std::optional<double> rotation_deg = {};  ///< none: expected_rotation_deg() of the sensor
  double mounting_deg = 0.2;
  int ring_px = 100;

  void describe(OptionTable& table) {
    table.section("stages");
    table.developer();
    table.add("align", enabled, "Refine the camera's rotations from its images.");
    table.section("align");
    table.add_automatic("rotation_deg", {&rotation_deg}, {0.001, 5},
                        "Expected error of a frame's rotation; auto: 0.1 degrees for a LiDAR, 0.5 for a depth camera.");
    table.add("mounting_deg", mounting_deg, {0.001, 5}, "Expected error of the rotation between LiDAR and camera.");
    table.developer();
    table.add("method", method, "All frames of a drive at once, or pitch and yaw of each against its neighbors (eq. 1).");
    table.add("points", points, {50, 100000}, "Most map points per frame that are compared.");
    table.add("ring_px", ring_px, {1, 2000}, "Method paper: width of the ring around the mask whose map points are compared.");
  }
};

/// Degrees. Given poses are those of the sensor. Color and depth of a handheld camera are exposed up to half an image period
/// apart, 15 ms, in which the hand turns by 30 degrees a second.
double expected_rotation_deg(const AlignOptions& options, Sensor sensor);

/// Meters; 0: the sensor tells positions well enough to leave them. In the 15 ms above, a hand moves by about a centimeter.
double expected_position_m(Sensor sensor);

/// What the refinement did to one view: camera_from_world = (exp(rotation), position) * given.
struct ViewAlignment {
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  ///< radians about the camera's axes: pitch, yaw, roll
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< meters along them
  double offset_before_px = 0, offset_after_px = 0;    ///< median misplacement that the colors tell, of held-out points
  int points = 0;                                      ///< held out; 0: nothing to compare with, left as given
};

/// What all views of a sequence have in common.
struct SequenceAlignment {
  bool kept = false;                                   ///< whether the held-out residual improved; else as given
  Eigen::Vector3d mounting = Eigen::Vector3d::Zero();  ///< radians, camera axes: what the rotations have in common
  std::vector<std::string> warnings = {};
};

/// The refined poses of all views, and how they came about.
struct Cameras {
  std::vector<SE3> camera_from_world;        ///< as the views
  std::vector<ViewAlignment> views;          ///< as the views
  std::vector<SequenceAlignment> sequences;  ///< by number

  Cameras() = default;
  explicit Cameras(const Views& given);  ///< poses as given, nothing compared
};

/// Refines the poses of all views, sequence by sequence, by the colors that several views give the same map points: see
/// docs/algorithms/align.md. An update is kept only if points that it was not made from agree better after it. Ticks
/// align_steps() times.
Cameras align(const Views& views, const map::VisibleMap& map, const AlignOptions& options, const Tick& tick = [] {});

std::size_t align_steps(const Views& views, const AlignOptions& options);

}  // namespace dvi::align
