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
  std::optional<double> rotation_deg = {};  ///< default: get_expected_rotation_deg() of the sensor
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
    table.add("method", method,
              "joint: all frames of a drive at once; paper: pitch and yaw of each frame against its neighbors (eq. 1).");
    table.add("points", points, {50, 100000}, "Largest number of map points per frame that are compared.");
    table.add("ring_px", ring_px, {1, 2000}, "Method paper: width of the ring around the mask whose map points are compared.");
  }
};

/// Returns the expected error of a rotation in degrees. Color and depth images of a handheld camera are exposed up to half a
/// period (15 ms) apart, while the hand rotates by 30 degrees per second.
double get_expected_rotation_deg(const AlignOptions& options, Sensor sensor);

/// Returns the expected error of a position in meters; 0 if positions are precise enough and not refined. In the 15 ms above, a
/// hand moves by about a centimeter.
double get_expected_position_m(Sensor sensor);

/// The refinement of one view: camera_from_world = (exp(rotation), position) * given.
struct ViewAlignment {
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  ///< radians about the camera axes: pitch, yaw, roll
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< meters along the camera axes
  double offset_before_px = 0, offset_after_px = 0;    ///< median position error of held-out points, from their colors
  int points = 0;  ///< held-out points; 0: the view has nothing to compare with and keeps its pose
};

/// The refinement of a sequence.
struct SequenceAlignment {
  bool kept = false;  ///< whether the held-out residual improved; otherwise poses stay as given
  Eigen::Vector3d mounting = Eigen::Vector3d::Zero();  ///< common part of the rotations: radians, camera axes
  std::vector<std::string> warnings = {};
};

/// The refined poses of all views, with their refinements.
struct Cameras {
  std::vector<SE3> camera_from_world;        ///< one per view
  std::vector<ViewAlignment> views;          ///< one per view
  std::vector<SequenceAlignment> sequences;  ///< one per sequence

  Cameras() = default;
  explicit Cameras(const Views& given);  ///< poses as given, without refinement
};

/// Refines the poses of all views, one sequence at a time, by the colors of map points that several views show (section 3.1 of
/// the paper; docs/algorithms/align.md). An update is kept only if held-out points agree better after it. Calls `tick`
/// count_align_ticks() times.
Cameras align(const Views& views, const map::VisibleMap& map, const AlignOptions& options, const Tick& tick = [] {});

/// Returns how often align() calls its `tick`.
std::size_t count_align_ticks(const Views& views, const AlignOptions& options);

}  // namespace dvi::align
