#include "dvi/inputs/collect_evidence.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace dvi::inputs {
namespace {

// For each scan, whether its pose is known to be wrong.
std::vector<bool> find_wrong_scans(const Drive& drive, const PoseChoice& choice) {
  std::vector<bool> untrusted(drive.scan_headers.size(), choice.misread && choice.from == PoseOrigin::given);
  if (choice.from == PoseOrigin::loam && choice.odometry)
    for (std::size_t i = 0; i < std::min(untrusted.size(), choice.odometry->scans.size()); ++i)
      untrusted[i] = choice.odometry->scans[i].state == odometry::ScanFit::State::lost;
  return untrusted;
}

}  // namespace

objects::CameraEvidence evidence_of(const Recording& open, const Trajectory& world_from_lidar) {
  return {.drive = open.drive,
          .world_from_lidar = world_from_lidar,
          .name = name_of(open),
          .sources = open.masks_from,
          .detector = open.detector,
          .ego_mask = open.ego_mask,
          .rig_of = open.rig_of,
          .labeled_in_part = open.labeled_in_part,
          .is_cleaned = open.is_cleaned};
}

objects::Evidence collect_evidence(const Recordings& drives, const Poses& poses) {
  std::vector<objects::CameraEvidence> cameras;
  for (std::size_t i = 0; i < drives.size(); ++i) {
    cameras.push_back(evidence_of(drives[i], poses[i].world_from_lidar));
    cameras.back().untrusted_scans = find_wrong_scans(drives[i].drive, poses[i].choice);
  }
  return objects::Evidence(std::move(cameras));
}

objects::Masks find_masks(const Recordings& drives, const Poses& poses, const job::Job& job, Progress& progress) {
  return objects::find_and_draw(collect_evidence(drives, poses), job.removal(), progress);
}

}  // namespace dvi::inputs
