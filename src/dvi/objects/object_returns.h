#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dvi/drive/point_labels.h"
#include "dvi/objects/completion/complete.h"
#include "dvi/objects/completion/masked_returns.h"
#include "dvi/objects/completion/object_columns.h"
#include "dvi/objects/moving_returns.h"

namespace dvi::objects {

/// A camera of the drive, and the objects that its images show.
struct ObjectCamera {
  CameraMaskEvidence evidence;
  std::vector<SharedLabels> objects;  ///< per frame: the outlines of objects, by number
};

/// The removed objects of one drive where its scans show them. Refers to the evidence of the search.
struct ScannedObjects {
  const Drive& drive;
  const Trajectory& world_from_lidar;
  MaskOptions options;                                    ///< of the masks of labels
  std::shared_ptr<const ground::ScanGround> ground = {};  ///< null without poses or scans: objects have no position then
  std::shared_ptr<const MovingReturns> returns = {};      ///< null without ground
  std::vector<ObjectCamera> cameras = {};
  std::map<int, CompletedObject> objects = {};  ///< by number, also those that no image shows
  std::map<int, std::string> types = {};        ///< classes of objects, by number; unknown ones are missing
  std::map<int, MotionState> motions = {};      ///< by number; unknown ones are missing
  bool all_moving = false;                      ///< whether everything that moves is removed
};

/// The instance of a return that belongs to an object without a number, such as one that a single mask shows.
inline constexpr std::uint32_t kUnnumberedInstance = 0xFFFF;

/// Labels the returns of removed objects. A return belongs to an object if it lies in a column that the object fills in this
/// scan: a square of 25 cm seen from above, from just above the ground to the highest return of the object there. Columns are
/// filled by the observations of moving objects, the space that completed objects occupied, the returns in labeled 3D boxes,
/// and those that masks show as objects (vote_by_masks()). If everything that moves is removed, moving returns close to an
/// object and returns in its outline belong to it, too. Labels of points that the drive has are kept.
class ObjectReturns {
 public:
  explicit ObjectReturns(ScannedObjects objects);

  /// Labels the returns of a scan: the class of their object, which depends on whether it ever moves, and its number as
  /// instance; 0 for all others. All are 0 in scans without a pose.
  PointLabels label(std::size_t scan) const;

 private:
  class ScanColumns;

  std::optional<int> find_object(const Eigen::Vector3d& world, const ScanColumns& columns) const;
  ScanColumns fill_columns(std::size_t scan) const;
  void add_boxed(std::size_t scan, ScanColumns& columns) const;
  void add_moving(std::size_t scan, const ObstacleReturns& obstacles, ScanColumns& columns) const;
  void add_outlined(const ObjectCamera& camera, std::size_t scan, const ObstacleReturns& obstacles, ScanColumns& columns) const;
  void add_masked(const ObjectCamera& camera, std::size_t scan, ScanColumns& columns) const;
  std::optional<Eigen::Vector2d> find_heading(int number, std::size_t scan) const;
  std::vector<std::pair<int, ObjectColumns>> predict_columns(std::size_t scan) const;
  std::uint32_t class_of(int number) const;

  ScannedObjects all_;
};

}  // namespace dvi::objects
