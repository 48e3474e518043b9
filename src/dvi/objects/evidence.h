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

using dvi::to_string;  // for the enums below, beside the overloads of this namespace

/// The selection of removed objects. labeled: all that labels or mask files cover. moving: the labeled objects that move. all:
/// what labels and mask files cover together.
enum class Remove { moving, labeled, all };
constexpr auto names_of(Remove) {
  return std::array{std::pair{Remove::moving, "moving"}, std::pair{Remove::labeled, "labeled"}, std::pair{Remove::all, "all"}};
}

/// Options of objects.
struct ObjectOptions {
  bool complete = true;  ///< whether objects are completed in frames and cameras whose masks lack them
  bool refine = true;    ///< whether background that bounding boxes cover is not removed

  void describe(OptionTable& table) {
    table.section("objects");
    table.add("complete", complete,
              "Remove an object also from frames and cameras in which its masks, labels, or detections are missing.");
    table.developer();
    table.add("refine", refine, "Keep the background that bounding boxes cover.");
  }
};

/// Which objects are removed, and how their masks are drawn.
struct RemovalOptions {
  Remove remove = Remove::labeled;
  MaskOptions masks;
  ObjectOptions objects;
  double pose_error_m = 0.05;  ///< map.pose_error_m: position error between scans at similar times
};

/// The evidence of one camera for the objects that it recorded. It refers to the drive and its poses, which must outlive it.
struct CameraEvidence {
  const Drive& drive;                                  ///< with its labels and mask files
  const Trajectory& world_from_lidar;                  ///< empty without poses
  std::string name;                                    ///< name for messages: of the drive, or of the drive and the camera
  std::optional<MaskSource> source;                    ///< empty: only the ego mask is removed
  std::shared_ptr<const Detector> detector = nullptr;  ///< for MaskSource::detected
  cv::Mat1b ego_mask{};                                ///< removed from all frames, 255; empty if there is none
  std::optional<std::size_t> rig_of{};                 ///< for further cameras of a drive: index of the drive's own camera
  bool labeled_in_part = false;                        ///< whether labels cover the view of the drive's own camera only
  std::vector<bool> untrusted_scans{};                 ///< per scan of the drive, whether its pose is known to be wrong

  /// Whether mask files or labels define the objects, so that nothing has to be found.
  bool is_given() const { return source == MaskSource::files || source == MaskSource::labels; }
};

/// The evidence of all cameras of all drives: the target drive first, and the own camera of each drive before its further
/// cameras.
class Evidence {
 public:
  explicit Evidence(std::vector<CameraEvidence> cameras) : cameras_(std::move(cameras)) {}

  std::size_t size() const { return cameras_.size(); }
  const CameraEvidence& operator[](std::size_t camera) const { return cameras_[camera]; }

  /// Returns the index of the own camera of a camera's drive.
  std::size_t own_camera(std::size_t camera) const { return cameras_[camera].rig_of.value_or(camera); }

  /// Returns the ground of a camera's drive, which its cameras share, or null without poses or scans. It is computed at the
  /// first call.
  std::shared_ptr<const ground::ScanGround> ground(std::size_t camera) const;

 private:
  std::vector<CameraEvidence> cameras_;
  mutable std::map<std::size_t, std::shared_ptr<const ground::ScanGround>> grounds_;  // by own camera
};

}  // namespace dvi::objects
