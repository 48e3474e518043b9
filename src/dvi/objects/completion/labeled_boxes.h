#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dvi/drive/drive.h"
#include "dvi/drive/free_space.h"

namespace dvi::objects {

/// Finds the track numbers that several 3D boxes in one frame have, and the index of the first such frame. Labels are wrong
/// there: these boxes are not those of one object.
std::map<int, std::size_t> find_repeated_tracks(const FrameLabels& labels);

/// A labeled object with 3D boxes in several frames, from which its box in other frames follows.
class LabeledBoxes {
 public:
  /// Collects the boxes of all tracks that have boxes in at least two frames with a pose, in order of track numbers. Leaves out
  /// those of find_repeated_tracks().
  static std::vector<LabeledBoxes> collect(const Drive& drive, const FrameLabels& labels, const Trajectory& world_from_lidar);

  int track() const { return track_; }
  const std::string& type() const { return type_; }
  bool moves() const { return moves_; }

  /// Returns the box in world axes at a time: of a stationary object, the one nearest in time; of a moving one, the
  /// interpolation of the boxes before and after if they are at most a second apart, else nothing.
  std::optional<Box> at(std::int64_t time_ns) const;

  /// Returns the box in world axes of an object that stays in place, with the median of its positions and sizes. Returns
  /// nothing if the object moves, if it has fewer than four boxes, or if their positions spread over more than 1.5 m.
  std::optional<Box> find_stationary_box() const;

 private:
  struct StampedBox {
    std::int64_t time_ns;
    Box world;
  };

  int track_ = -1;
  std::string type_;
  bool moves_ = false;
  std::vector<StampedBox> boxes_;  // in order of time
};

/// Returns whether a scan contradicts that an object is in a box (world axes) and visible: rays pass through the box, or
/// surfaces in front of it hide it. Returns false where the scan shows nothing.
bool is_absent_or_hidden(const Box& world, const FreeSpace& scan);

}  // namespace dvi::objects
