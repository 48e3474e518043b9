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
#include "dvi/drive/mask_source.h"
#include "dvi/ground/scan_ground.h"
#include "dvi/objects/detect/detector.h"
#include "dvi/objects/label_masks.h"

namespace dvi::objects {

using dvi::to_string;  // for the enums below, beside the overloads of this namespace

/// The selection of removed objects. labeled: all objects of the mask sources. moving: the labeled objects that move. all: as
/// labeled, and the labels of a drive are a source beside its mask files.
enum class Remove { moving, labeled, all };
constexpr auto names_of(Remove) {
  return std::array{std::pair{Remove::moving, "moving"}, std::pair{Remove::labeled, "labeled"}, std::pair{Remove::all, "all"}};
}

/// Options of objects.
struct ObjectOptions {
  bool complete = true;  ///< whether objects are completed in frames and cameras whose masks lack them
  bool refine = true;    ///< whether surroundings that bounding boxes cover are not removed

  void describe(OptionTable& table) {
    table.section("objects");
    table.add("complete", complete,
              "Remove an object also from frames and cameras in which its masks, labels, or detections are missing.");
    table.developer();
    table.add("refine", refine, "Keep the background that bounding boxes cover, and things in front of labeled boxes.");
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
  MaskSources sources;                                 ///< empty: only the ego mask is removed
  std::shared_ptr<const Detector> detector = nullptr;  ///< for MaskSource::detected
  cv::Mat1b ego_mask{};                                ///< removed from all frames, 255; empty if there is none
  std::optional<std::size_t> rig_of{};                 ///< for further cameras of a drive: index of the drive's own camera
  bool labeled_in_part = false;                        ///< whether labels cover the view of the drive's own camera only
  bool is_cleaned = false;                             ///< its frames are filled, not only copied from
  std::vector<bool> untrusted_scans{};                 ///< per scan of the drive, whether its pose is known to be wrong

  bool has(MaskSource source) const { return sources.contains(source); }
  /// Returns whether mask files or labels define objects.
  bool is_given() const { return has(MaskSource::files) || has(MaskSource::labels); }
  /// Returns whether masks, labels, or detections show objects in the images.
  bool shows_objects() const { return is_given() || has(MaskSource::detected); }
  /// Returns the evidence of those of its sources that are in `kept`.
  CameraEvidence restricted_to(const MaskSources& kept) const {
    CameraEvidence out = *this;
    std::erase_if(out.sources, [&](MaskSource source) { return !kept.contains(source); });
    return out;
  }
};

/// The ground by camera; null for further cameras of a drive, and without poses or scans.
using Grounds = std::vector<std::shared_ptr<const ground::ScanGround>>;

/// The evidence of all cameras of all drives: the target drive first, and the own camera of each drive before its further
/// cameras.
class Evidence {
 public:
  explicit Evidence(std::vector<CameraEvidence> cameras) : cameras_(std::move(cameras)), grounds_(cameras_.size()) {}

  std::size_t size() const { return cameras_.size(); }
  const CameraEvidence& operator[](std::size_t camera) const { return cameras_[camera]; }

  /// Returns the index of the own camera of a camera's drive.
  std::size_t own_camera(std::size_t camera) const { return cameras_[camera].rig_of.value_or(camera); }

  /// Returns the ground of a camera's drive, which its cameras share, or null without poses or scans. It is computed at the
  /// first call, from all scans.
  std::shared_ptr<const ground::ScanGround> ground(std::size_t camera) const;

  /// Return and set the ground of each camera's drive, so that it need not be computed again.
  Grounds grounds() const;
  void set_grounds(const Grounds& grounds);

 private:
  std::vector<CameraEvidence> cameras_;
  mutable Grounds grounds_;  // null: not computed so far
};

}  // namespace dvi::objects
