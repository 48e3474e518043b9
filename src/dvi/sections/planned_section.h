#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "dvi/align/align.h"
#include "dvi/exposure/exposure.h"
#include "dvi/inputs/poses.h"
#include "dvi/inputs/recordings.h"
#include "dvi/objects/camera_objects.h"
#include "dvi/sections/section.h"

namespace dvi::sections {

/// The results of the stages of one section, in the world of its first LiDAR pose.
struct PlannedSection {
  Section section;
  inputs::Recordings drives;
  inputs::Poses poses;
  objects::CameraObjects objects;  ///< removed objects of the target
  Views views;                     ///< refined
  exposure::Gains gains;
  align::Cameras cameras;

  const Drive& target() const { return drives.front().drive; }
  const Trajectory& world_from_lidar() const { return poses.front().world_from_lidar; }
};

/// Returns the index of the recording of the same drive and camera; none if there is no such recording.
std::optional<std::size_t> find_recording(const inputs::Recordings& drives, const inputs::Recording& wanted);

}  // namespace dvi::sections
