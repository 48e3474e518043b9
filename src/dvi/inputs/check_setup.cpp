#include "dvi/inputs/check_setup.h"

#include "dvi/diagnostics/check_camera.h"
#include "dvi/diagnostics/check_labels.h"
#include "dvi/diagnostics/fast_motion.h"
#include "dvi/diagnostics/flow_pairs.h"

namespace dvi::inputs {
namespace {

std::vector<std::string> diagnose(const Recording& open, const DrivePoses& poses, const objects::CameraMasks& masks) {
  const Drive& drive = open.drive;
  const diagnostics::FlowPairs pairs = diagnostics::make_flow_pairs(drive, poses.choice.tracks, masks.images);
  std::vector<std::string> warnings = diagnostics::check_camera(pairs, drive.camera_from_lidar);
  if (open.rig_of) return warnings;
  if (warnings.empty()) warnings = diagnostics::check_labels(drive);
  for (const std::string& fast : diagnostics::check_fast_motion(drive, poses.world_from_lidar)) warnings.push_back(fast);
  return warnings;
}

}  // namespace

std::vector<std::string> check_setup(const Inputs& inputs, Progress& progress) {
  const auto& [drives, poses, masks] = inputs;
  std::vector<std::string> warnings;
  progress.begin("camera and labels", drives.size());
  for (std::size_t i = 0; i < drives.size(); ++i) {
    for (const std::string& warning : diagnose(drives[i], poses[i], masks[i]))
      warnings.push_back(name_of(drives[i]) + ": " + warning);
    progress.advance();
  }
  progress.end();
  for (const std::string& warning : warnings) progress.warn(warning);
  return warnings;
}

}  // namespace dvi::inputs
