#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/objects/evidence.h"
#include "dvi/objects/moving_returns.h"

namespace dvi::objects {

/// The evidence of the masks of the images taken during a scan for one of its returns. object: it belongs to a removed
/// object. disputed: it does in one image, but another one shows it outside its masks; an image without any mask does not
/// dispute. background: an image shows it outside the masks. unclear: it is masked but may lie behind the object, or it is at
/// the boundary of a mask. unseen: it is in no image.
enum class MaskVote : std::uint8_t { unseen, unclear, background, disputed, object };

/// The masks of one camera as evidence of objects.
struct CameraMaskEvidence {
  const CameraEvidence& camera;
  Lazy<cv::Mat1b> removed;  ///< per frame of the camera: all that is removed
  Lazy<cv::Mat1b> masks;    ///< per frame: the masks of objects without 3D boxes
  SharedLabels labels;      ///< per frame: the removed labels, whose 3D boxes show which returns belong to objects
};

/// A camera of a drive at the time of one of its frames, with the mask of the frame.
struct MaskedFrame {
  const std::vector<Label>* labels = nullptr;
  const Camera* camera = nullptr;
  SE3 lidar_from_world;
  SE3 camera_from_world;
  std::shared_ptr<const cv::Mat1b> removed, mask;  ///< `removed` and `masks` of CameraMaskEvidence
  std::size_t index = 0;                           ///< of the frame in its drive

  /// Projects a point in world axes. Returns nothing if it is outside the image.
  std::optional<cv::Point> project(const Eigen::Vector3d& world) const;
};

/// Finds the frame of a camera nearest to a time. Returns nothing if it has no pose or is farther than kMaxFrameToScanNs from
/// that time.
std::optional<MaskedFrame> find_masked_frame(const CameraMaskEvidence& evidence, std::int64_t time_ns);

/// The nearest surfaces in the regions of a mask. A region is a connected part of the mask or, if bounding boxes form the part,
/// one of the boxes, which may overlap.
class MaskedSurfaces {
 public:
  /// `returns` are those of the scan taken with the frame, world axes.
  MaskedSurfaces(MaskedFrame frame, const std::vector<Eigen::Vector3d>& returns);

  const MaskedFrame& frame() const { return frame_; }
  /// Returns whether the mask shows a pixel.
  bool is_masked(cv::Point pixel) const { return parts_(pixel) > 0; }
  /// Returns the numbers of the regions at a pixel; none outside the mask.
  std::vector<int> regions_at(cv::Point pixel) const;
  /// Returns the bounding box that is a region; nothing if the region has another shape.
  std::optional<cv::Rect> box_of(int region) const;
  /// Returns whether a point in world axes, which is a return, lies behind other ones in all regions at its pixel, at the same
  /// column of the image. `pixel` is its projection into the mask.
  bool is_behind(const Eigen::Vector3d& world, cv::Point pixel) const;
  /// Does the same for one region.
  bool is_behind(const Eigen::Vector3d& world, cv::Point pixel, int region) const;
  /// Returns whether the mask shows a point in world axes; nothing if it is outside the image, or masked but behind another
  /// return (is_behind()).
  std::optional<bool> shows_masked(const Eigen::Vector3d& world) const;

 private:
  double depth_m(const Eigen::Vector3d& world) const { return frame_.camera->depth(frame_.camera_from_world * world); }

  MaskedFrame frame_;
  cv::Mat1i parts_;
  std::vector<std::vector<std::pair<int, cv::Rect>>> boxes_;  // per part: the regions and their boxes; none: another shape
  std::map<int, cv::Rect> box_of_;                            // by region
  std::map<std::pair<int, int>, double> nearest_m_;           // depth by region and strip
};

/// Determines which returns of a scan belong to removed objects: those in their 3D boxes, and those in masks. Returns are
/// grouped to things by their distances, seen from above. A thing that is masked almost completely is an object, unless another
/// thing hides it in the image: a LiDAR on the roof observes returns above cars. If a mask covers a part of a thing, as a loose
/// mask covers a part of the hedge beside a car, then this part belongs to the object if it is the nearest thing in the mask,
/// most of its returns, and not a small part of the thing. In a bounding box, only the nearest thing that extends over half of
/// the box is an object, because boxes also cover the surroundings of their objects. `time_ns` is the time of the scan.
/// Returns one vote per return.
std::vector<MaskVote> vote_by_masks(const std::vector<CameraMaskEvidence>& cameras, const ObstacleReturns& returns,
                                    std::int64_t time_ns);

}  // namespace dvi::objects
