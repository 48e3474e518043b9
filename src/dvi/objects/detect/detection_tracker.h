#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dvi/objects/detect/detection.h"

namespace dvi::objects {

/// An object in one frame, as one of a track.
struct TrackedObject {
  std::size_t frame = 0;  ///< as they were added
  int track = 0;          ///< in order of their first frames
  Detection object;
  bool filled = false;  ///< the network missed it: outlined between the frames before and after
};

/// Ties detections of following frames together and closes the gaps of up to half a second in which an object was missed, from
/// both sides. A detection continues the track of its class that overlaps it most once moved by the track's velocity.
class DetectionTracker {
 public:
  /// The detections of the next frame.
  void add(std::int64_t time_ns, Detections detections);

  /// The objects since the last call: those of the frames added, and what was filled in earlier ones.
  std::vector<TrackedObject> take();

 private:
  struct Track {
    int id = 0;
    std::size_t frame = 0;  // of `last`
    Detection last;
    cv::Point2d velocity;  // of the box's center, pixels a second
  };

  std::vector<std::int64_t> times_;
  std::vector<Track> active_;
  std::vector<TrackedObject> objects_;
  int tracks_ = 0;

  void continue_track(Track& track, Detection detection);
};

/// The share of the union of two outlines that both cover, the first one moved by whole pixels.
double overlap(const Detection& a, cv::Point moved, const Detection& b);

/// The object between two of its outlines, at share 0..1 of the way: its box lies between theirs; its outline covers both,
/// each brought to that box.
Detection between(const Detection& before, const Detection& after, double share);

}  // namespace dvi::objects
