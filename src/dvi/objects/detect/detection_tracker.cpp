#include "dvi/objects/detect/detection_tracker.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "dvi/objects/assign_tracks.h"

namespace dvi::objects {
namespace {

struct DetectionTrackingParams {
  std::int64_t max_gap_ns = 500'000'000;  ///< after a longer gap, a detection may be another object
  double min_overlap = 0.2;               ///< outlines of one object change with its distance and with occlusion
};
constexpr DetectionTrackingParams kDetectionTracking{};

cv::Point2d find_center(const cv::Rect& box) { return {box.x + 0.5 * box.width, box.y + 0.5 * box.height}; }

cv::Mat1b scale(const cv::Mat1b& mask, cv::Size size) {
  if (mask.size() == size) return mask;
  cv::Mat1b out;
  cv::resize(mask, out, size, 0, 0, cv::INTER_NEAREST);
  return out;
}

}  // namespace

double compute_overlap(const Detection& a, cv::Point shift, const Detection& b) {
  const cv::Rect at = a.box + shift, common = at & b.box;
  if (common.empty()) return 0;
  const int both = cv::countNonZero(cv::Mat1b(a.mask(common - at.tl()) & b.mask(common - b.box.tl())));
  return static_cast<double>(both) / (cv::countNonZero(a.mask) + cv::countNonZero(b.mask) - both);
}

Detection interpolate(const Detection& before, const Detection& after, double share) {
  const auto mix = [&](int a, int b) { return (1 - share) * a + share * b; };
  // The box is extended to whole pixels, but not by rounding errors.
  constexpr double kRounding = 1e-9;
  const cv::Point first(static_cast<int>(std::floor(mix(before.box.x, after.box.x) + kRounding)),
                        static_cast<int>(std::floor(mix(before.box.y, after.box.y) + kRounding)));
  const cv::Point end(static_cast<int>(std::ceil(mix(before.box.br().x, after.box.br().x) - kRounding)),
                      static_cast<int>(std::ceil(mix(before.box.br().y, after.box.br().y) - kRounding)));
  const cv::Rect box(first, end);
  return {before.type, std::min(before.score, after.score), box,
          cv::Mat1b(scale(before.mask, box.size()) | scale(after.mask, box.size()))};
}

void DetectionTracker::continue_track(Track& track, Detection detection) {
  const std::size_t now = times_.size() - 1;
  const auto since = static_cast<double>(times_[now] - times_[track.frame]);
  for (std::size_t frame = track.frame + 1; frame < now; ++frame) {
    const double share = static_cast<double>(times_[frame] - times_[track.frame]) / since;
    objects_.push_back({frame, track.id, interpolate(track.last, detection, share), true});
  }
  if (since > 0) track.velocity = (find_center(detection.box) - find_center(track.last.box)) * (1e9 / since);
  track.frame = now;
  track.last = std::move(detection);
}

void DetectionTracker::add(std::int64_t time_ns, Detections detections) {
  times_.push_back(time_ns);
  std::erase_if(active_, [&](const Track& track) { return time_ns - times_[track.frame] > kDetectionTracking.max_gap_ns; });

  std::vector<TrackCandidate> candidates;
  for (std::size_t t = 0; t < active_.size(); ++t) {
    const cv::Point2d motion = active_[t].velocity * (1e-9 * static_cast<double>(time_ns - times_[active_[t].frame]));
    const cv::Point shift(cvRound(motion.x), cvRound(motion.y));
    for (std::size_t d = 0; d < detections.size(); ++d)
      if (detections[d].type == active_[t].last.type)
        if (const double overlap = compute_overlap(active_[t].last, shift, detections[d]);
            overlap >= kDetectionTracking.min_overlap)
          candidates.push_back({-overlap, t, d});
  }
  std::vector<std::optional<std::size_t>> track_of = assign_tracks(std::move(candidates), detections.size());
  for (std::size_t d = 0; d < detections.size(); ++d) {
    if (track_of[d]) {
      continue_track(active_[*track_of[d]], detections[d]);
    } else {
      track_of[d] = active_.size();
      active_.push_back({tracks_++, times_.size() - 1, detections[d], {}});
    }
    objects_.push_back({times_.size() - 1, active_[*track_of[d]].id, std::move(detections[d]), false});
  }
}

std::vector<TrackedObject> DetectionTracker::take() { return std::exchange(objects_, {}); }

}  // namespace dvi::objects
