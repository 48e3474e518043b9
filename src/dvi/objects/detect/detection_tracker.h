#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dvi/objects/detect/detection.h"

namespace dvi::objects {

/// The detection of a tracked object in one frame.
struct TrackedObject {
  std::size_t frame = 0;  ///< index in the order of add()
  int track = 0;          ///< number of the track, in order of first frames
  Detection object;
  bool is_interpolated = false;  ///< whether the network missed the object, so that it is interpolated between frames
};

/// Tracks detections over consecutive frames. A detection continues the track of its class that overlaps it most after the
/// track is moved by its velocity. Gaps of up to half a second, in which the network missed an object, are filled by
/// interpolation.
class DetectionTracker {
 public:
  /// Adds the detections of the next frame.
  void add(std::int64_t time_ns, Detections detections);

  /// Returns the objects since the last call: those of the added frames, and those interpolated in earlier frames.
  std::vector<TrackedObject> take();

 private:
  struct Track {
    int id = 0;
    std::size_t frame = 0;  // frame of `last`
    Detection last;
    cv::Point2d velocity;  // motion of the center of the box, pixels per second
  };

  std::vector<std::int64_t> times_;
  std::vector<Track> active_;
  std::vector<TrackedObject> objects_;
  int tracks_ = 0;

  void continue_track(Track& track, Detection detection);
};

/// Returns the intersection over union of two masks. The first one is moved by `shift` pixels.
double compute_overlap(const Detection& a, cv::Point shift, const Detection& b);

/// Interpolates an object between two detections; `share` is 0 at the first and 1 at the second one. The box is interpolated,
/// and the mask is the union of both masks, scaled to that box.
Detection interpolate(const Detection& before, const Detection& after, double share);

}  // namespace dvi::objects
