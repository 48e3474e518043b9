#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dvi/core/named.h"
#include "dvi/drive/drive.h"
#include "dvi/ground/scan_ground.h"
#include "dvi/objects/detect/detector.h"
#include "dvi/objects/label_masks.h"

namespace dvi::objects {

using dvi::to_string;  // of the enums below, beside the overloads of this namespace

/// Which objects are removed. moving: of the labeled ones, those that move; labeled: what masks or labels cover; all: what both
/// cover.
enum class Remove { moving, labeled, all };
constexpr auto names_of(Remove) {
  return std::array{std::pair{Remove::moving, "moving"}, std::pair{Remove::labeled, "labeled"}, std::pair{Remove::all, "all"}};
}

/// What the user wants to be removed, and how its masks are drawn.
struct RemovalOptions {
  Remove remove = Remove::labeled;
  MaskOptions masks;
  double pose_error_m = 0.05;  ///< map.pose_error_m: between poses of scans that are near in time
};

/// All that shows which objects one camera of a drive recorded. It refers to the drive and its poses, which must outlive it.
struct CameraEvidence {
  const Drive& drive;                                  ///< with its labels and mask files
  const Trajectory& world_from_lidar;                  ///< empty without poses
  std::string name;                                    ///< of the drive, or of the drive and the camera, for messages
  std::optional<MaskSource> source;                    ///< none: nothing is removed but what the ego mask covers
  std::shared_ptr<const Detector> detector = nullptr;  ///< for MaskSource::detected
  cv::Mat1b ego_mask{};                                ///< removed from all frames, 255; empty: none
  std::optional<std::size_t> rig_of{};                 ///< of another camera of a drive: index of the drive's own camera
  bool labeled_in_part = false;                        ///< the labels cover the view of the drive's own camera only
  std::vector<bool> untrusted_scans{};                 ///< as the drive's scans: their poses are known to be wrong
};

/// The evidence of all cameras of all drives, the target first, each drive's own camera before its others.
class Evidence {
 public:
  explicit Evidence(std::vector<CameraEvidence> cameras) : cameras_(std::move(cameras)) {}

  std::size_t size() const { return cameras_.size(); }
  const CameraEvidence& operator[](std::size_t camera) const { return cameras_[camera]; }

  /// The index of the own camera of the drive that a camera belongs to.
  std::size_t own_camera(std::size_t camera) const { return cameras_[camera].rig_of.value_or(camera); }

  /// The ground of a camera's drive, which its cameras share: made when it is first asked for. None without poses or scans.
  std::shared_ptr<const ground::ScanGround> ground(std::size_t camera) const;

 private:
  std::vector<CameraEvidence> cameras_;
  mutable std::map<std::size_t, std::shared_ptr<const ground::ScanGround>> grounds_;  // by own camera
};

}  // namespace dvi::objects
