#include "dvi/objects/image_tracking.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "dvi/core/median.h"
#include "dvi/core/threads.h"
#include "dvi/drive/outline.h"
#include "dvi/image/enlarge.h"
#include "dvi/image/gray.h"
#include "dvi/image/optical_flow.h"
#include "dvi/image/region.h"
#include "dvi/objects/seconds.h"
#include "dvi/objects/track_outlines.h"

namespace dvi::objects {
namespace {

struct ImageTrackingParams {
  int min_height_px = 8;            ///< smaller outlines have too few pixels for flow and comparison
  double flow_margin = 0.5;         ///< margin of the flow around an outline, relative to its longer side
  double min_visible_share = 0.5;   ///< share of an outline within the image
  double min_observed_share = 0.5;  ///< share of an outline whose background is observed
  /// Share of these pixels that may show the background: before leaves, not even a car differs everywhere.
  double max_matching_share = 0.5;
  double min_differing_share = 0.25;  ///< share of an outline that differs, from which the rest is excluded from the flow
  std::size_t min_flow_px = 50;       ///< pixels of an object that an estimate from flow needs
  double drift_px = 0.5;              ///< error of the flow of a small object, per frame
  double max_scale_change = 0.15;     ///< change of scale from frame to frame beyond which flow is wrong
  double max_hidden_s = 4;            ///< time for which the possible positions of a track are masked
  double max_acceleration_mps2 = 3;   ///< deviation from constant velocity
  double max_position_error_m = 1;    ///< error of the position at the last observation
};
constexpr ImageTrackingParams kImageTracking{};

using Hull = std::vector<cv::Point2f>;  // convex, image coordinates

// The transformation x' = to + scale (x - from).
struct Similarity {
  cv::Point2d from, to;
  double scale = 1;

  cv::Point2d apply(const cv::Point2d& x) const { return to + scale * (x - from); }
};

Hull find_hull(const Instance& outline) {
  cv::Mat1b mask(outline.size, uchar{0});
  draw(outline, mask);
  std::vector<cv::Point> pixels;
  cv::findNonZero(mask, pixels);
  std::vector<cv::Point> corners;
  if (!pixels.empty()) cv::convexHull(pixels, corners);
  return {corners.begin(), corners.end()};
}

Hull transform(const Hull& hull, const Similarity& motion) {
  Hull out;
  for (const cv::Point2f& x : hull) out.emplace_back(motion.apply(x));
  return out;
}

cv::Mat1b draw_mask(const Hull& hull, cv::Size size) {
  cv::Mat1b mask(size, uchar{0});
  std::vector<cv::Point> corners;
  for (const cv::Point2f& x : hull) corners.push_back(to_drawing_pixel(x.x, x.y));
  cv::fillConvexPoly(mask, corners, 255);
  return mask;
}

cv::Point2d find_center(const Hull& hull) {
  const cv::Rect2f box = cv::boundingRect(hull);
  return {box.x + 0.5 * box.width, box.y + 0.5 * box.height};
}

double compute_share(const cv::Mat1b& part, const cv::Mat1b& whole) {
  return cv::countNonZero(cv::Mat1b(part & whole)) / std::max(1.0, static_cast<double>(cv::countNonZero(whole)));
}

cv::Mat1b halve(const cv::Mat1b& mask) {
  cv::Mat1b half;
  cv::resize(mask, half, {mask.cols / kHalfSizeFactor, mask.rows / kHalfSizeFactor}, 0, 0, cv::INTER_AREA);
  return cv::Mat1b(half > 127);
}

// Returns the median absolute difference of two patches, without the median difference, because the exposure changes between
// frames.
double compare_patches(const cv::Mat1b& from, const cv::Mat1b& to, const cv::Mat1b& where) {
  std::vector<float> differences;
  for (int y = 0; y < where.rows; ++y)
    for (int x = 0; x < where.cols; ++x)
      if (where(y, x) != 0) differences.push_back(static_cast<float>(to(y, x)) - static_cast<float>(from(y, x)));
  if (differences.empty()) return 255;
  const float exposure = median(differences);
  for (float& value : differences) value = std::abs(value - exposure);
  return static_cast<double>(median(differences));
}

// Resamples an image to a patch of another image, which the motion transforms to the image.
cv::Mat1b resample(const cv::Mat1b& image, const cv::Rect& patch, const Similarity& motion) {
  const cv::Point2d corner = motion.apply(cv::Point2d(patch.tl()));
  const cv::Matx23d image_from_patch(motion.scale, 0, corner.x, 0, motion.scale, corner.y);
  cv::Mat1b out;
  cv::warpAffine(image, out, image_from_patch, patch.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  return out;
}

// Fits a similarity to the flow of the pixels `where` of a patch.
std::optional<Similarity> fit_similarity(const cv::Mat2f& flow, const cv::Mat1b& where, const cv::Rect& patch) {
  std::vector<cv::Point> at;
  cv::findNonZero(where, at);
  if (at.size() < kImageTracking.min_flow_px) return std::nullopt;
  std::vector<double> dx, dy, scale;
  cv::Point2d center;
  for (const cv::Point& x : at) {
    dx.push_back(flow(x)[0]);
    dy.push_back(flow(x)[1]);
    center += cv::Point2d(x) / static_cast<double>(at.size());
  }
  const cv::Point2d shift(median(dx), median(dy));
  const cv::Rect box = cv::boundingRect(where);
  const double min_radius = 0.25 * std::max(box.width, box.height);
  for (const cv::Point& x : at) {
    const cv::Point2d offset = cv::Point2d(x) - center, change = cv::Point2d(flow(x)[0], flow(x)[1]) - shift;
    if (offset.dot(offset) > min_radius * min_radius) scale.push_back(1 + offset.dot(change) / offset.dot(offset));
  }
  center += cv::Point2d(patch.tl());
  return Similarity{center, center + shift, scale.empty() ? 1 : median(scale)};
}

// Predicts the center of an object, world axes.
Eigen::Vector3d predict_center(const Track& track, const ground::ScanGround& ground, std::int64_t time_ns) {
  const std::size_t nearest = track.nearest(time_ns);
  const Track::State state = track.state(nearest);
  const Cluster& cluster = track.observations[nearest];
  const Eigen::Vector2d at = state.position + state.velocity * seconds_between(cluster.mean_time_ns, time_ns);
  const double height = ground.height(at).value_or(cluster.returns.median_ground());
  return {at.x(), at.y(), height + 0.5 * track.height_m};
}

Box predict_box(const Track& track, const ground::ScanGround& ground, std::int64_t time_ns) {
  const Eigen::Vector2d velocity = track.velocity(track.nearest(time_ns));
  const double heading = std::atan2(velocity.y(), velocity.x());
  return {{Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()).toRotationMatrix(), predict_center(track, ground, time_ns)},
          {track.size_m.x(), track.size_m.y(), track.height_m}};
}

// The end of tracking backward.
constexpr std::size_t kNoView = static_cast<std::size_t>(-1);

// Tracks one object from view to view.
class ImageTracker {
 public:
  ImageTracker(const Track& track, int number, const BackgroundComparison& comparison, const Trajectory& world_from_lidar)
      : track_(track), number_(number), comparison_(comparison), world_from_lidar_(world_from_lidar) {}

  // Tracks a labeled object from view `from` up to, but without, view `end`, which is kNoView for tracking backward to the
  // first view. Adds to the labels, which are per frame.
  void track(const Label& label, std::size_t from, std::size_t end, FrameLabels& labels) const {
    const int step = end == kNoView || end < from ? -1 : 1;
    if (from + step == end) return;
    Hull hull = find_hull(*label.instance);
    if (hull.empty()) return;
    cv::Mat1b object = find_object_pixels(from, hull);
    double drift_px = 0;
    std::int64_t last_observed_ns = view(from).time_ns;
    const std::int64_t start_ns = last_observed_ns;
    for (std::size_t at = from, next = from + step; next != end; at = next, next += step) {
      const auto predicted = predict_motion(at, next);
      if (!predicted) return;
      Similarity motion = correct_motion({at, next}, hull, object, *predicted);
      if (is_implausible(transform(hull, motion), next, start_ns)) motion = *predicted;
      hull = transform(hull, motion);
      const cv::Mat1b mask = draw_mask(hull, image_size(next));
      const cv::Rect2f box = cv::boundingRect(hull);
      if (box.height < kImageTracking.min_height_px ||
          cv::countNonZero(mask) < kImageTracking.min_visible_share * cv::contourArea(hull))
        return;
      const cv::Mat1b half = halve(mask);
      const ImageDifference difference = comparison_.compare(next, half);
      const cv::Mat1b observed(half & ~difference.undecided);
      const bool is_observed = compute_share(observed, half) > kImageTracking.min_observed_share;
      if (is_observed && compute_share(difference.matches, observed) > kImageTracking.max_matching_share) return;
      if (is_observed) last_observed_ns = view(next).time_ns;
      if (std::abs(seconds_between(last_observed_ns, view(next).time_ns)) > kMaxExtrapolationS) return;
      object = find_object_pixels(mask, difference);
      drift_px += kImageTracking.drift_px;
      labels[view(next).frame].push_back(make_label(label, next, grown(mask, static_cast<int>(std::ceil(drift_px)))));
    }
  }

  const std::vector<View>& views() const { return comparison_.views().views; }

 private:
  struct Step {
    std::size_t from, to;  // views
  };

  const View& view(std::size_t i) const { return comparison_.views()[i]; }
  cv::Size image_size(std::size_t i) const { return {view(i).camera.width, view(i).camera.height}; }
  Eigen::Vector3d center_in_camera(std::size_t i) const {
    return view(i).camera_from_world * predict_center(track_, comparison_.ground(), view(i).time_ns);
  }

  std::optional<Similarity> predict_motion(std::size_t from, std::size_t to) const {
    const Eigen::Vector3d a = center_in_camera(from), b = center_in_camera(to);
    if (!view(from).camera.in_front(a) || !view(to).camera.in_front(b)) return std::nullopt;
    const Eigen::Vector2d p = view(from).camera.project(a), q = view(to).camera.project(b);
    return Similarity{{p.x(), p.y()}, {q.x(), q.y()}, view(from).camera.depth(a) / view(to).camera.depth(b)};
  }

  // Returns whether a hull is farther beside the predicted position than the motion of an object allows.
  bool is_implausible(const Hull& hull, std::size_t at, std::int64_t start_ns) const {
    const Eigen::Vector3d x = center_in_camera(at);
    if (!view(at).camera.in_front(x)) return true;
    const double t = seconds_between(start_ns, view(at).time_ns);
    const Camera& camera = view(at).camera;
    const double offset_m = std::abs(find_center(hull).x - camera.project(x).x()) * camera.depth(x) / camera.fx;
    return offset_m > kImageTracking.max_position_error_m + 0.5 * track_.size_m.maxCoeff() +
                          0.5 * kImageTracking.max_acceleration_mps2 * t * t;
  }

  // Returns the pixels of an outline that differ from the background, or all if these are few.
  static cv::Mat1b find_object_pixels(const cv::Mat1b& mask, const ImageDifference& difference) {
    cv::Mat1b differs;
    cv::resize(difference.differs, differs, mask.size(), 0, 0, cv::INTER_NEAREST);
    const cv::Mat1b object(differs & mask);
    return cv::countNonZero(object) > kImageTracking.min_differing_share * cv::countNonZero(mask) ? object : mask;
  }
  cv::Mat1b find_object_pixels(std::size_t at, const Hull& hull) const {
    const cv::Mat1b mask = draw_mask(hull, image_size(at));
    return find_object_pixels(mask, comparison_.compare(at, halve(mask)));
  }

  // Returns the predicted motion, corrected by optical flow if this increases the similarity of the object in both images.
  Similarity correct_motion(const Step& step, const Hull& hull, const cv::Mat1b& object, const Similarity& predicted) const {
    const cv::Rect box = cv::boundingRect(hull) & cv::Rect({}, object.size());
    const int margin = std::max(kMinFlowSidePx / 2, cvRound(kImageTracking.flow_margin * std::max(box.width, box.height)));
    const cv::Rect patch = enlarge(box, margin, object.size());
    if (patch.width < kMinFlowSidePx || patch.height < kMinFlowSidePx) return predicted;
    const auto& images = comparison_.views().images;
    const cv::Mat1b here = gray_8bit(*images[step.from])(patch).clone(), image = gray_8bit(*images[step.to]);
    const cv::Mat1b there = resample(image, patch, predicted), where = object(patch);
    const auto change = fit_similarity(compute_optical_flow(here, there), where, patch);
    if (!change || std::abs(change->scale - 1) > kImageTracking.max_scale_change) return predicted;
    const Similarity corrected{change->from, predicted.apply(change->to), predicted.scale * change->scale};
    const bool better = compare_patches(here, resample(image, patch, corrected), where) < compare_patches(here, there, where);
    return better ? corrected : predicted;
  }

  Label make_label(const Label& label, std::size_t at, const cv::Mat1b& mask) const {
    Label out;
    out.track = number_;
    out.type = label.type;
    out.instance = to_outline(mask);
    if (const auto pose = world_from_lidar_.at(view(at).time_ns)) {
      out.box = predict_box(track_, comparison_.ground(), view(at).time_ns);
      out.box->frame_from_box = pose->inverse() * out.box->frame_from_box;
    }
    return out;
  }

  const Track& track_;
  int number_;
  const BackgroundComparison& comparison_;
  const Trajectory& world_from_lidar_;
};

// Returns the labels of one track, per frame.
FrameLabels track_object(const FrameLabels& labels, const Track& track, int number, const ImageTracker& tracker) {
  const std::vector<View>& views = tracker.views();
  FrameLabels out(labels.size());
  std::vector<std::size_t> strong;                         // views
  std::vector<std::pair<std::size_t, const Label*>> weak;  // frames and their labels
  for (std::size_t i = 0; i < views.size(); ++i)
    for (const Label& label : labels[views[i].frame]) {
      if (label.track != number) continue;
      const ScanEvidence evidence = rate_scan_evidence(track, views[i].time_ns);
      if (evidence == ScanEvidence::weak) weak.emplace_back(views[i].frame, &label);
      if (evidence != ScanEvidence::strong) continue;
      strong.push_back(i);
      out[views[i].frame].push_back(label);
    }
  const auto label_in = [&](std::size_t view) { return out[views[view].frame].front(); };
  if (!strong.empty()) tracker.track(label_in(strong.front()), strong.front(), kNoView, out);
  for (std::size_t k = 0; k < strong.size(); ++k)
    tracker.track(label_in(strong[k]), strong[k], k + 1 < strong.size() ? strong[k + 1] : views.size(), out);
  for (const auto& [frame, label] : weak)
    if (out[frame].empty()) out[frame].push_back(*label);
  return out;
}

}  // namespace

Lazy<cv::Mat1b> mask_possible_positions(const Views& views, std::span<const Track> tracks,
                                        const std::shared_ptr<const ground::ScanGround>& ground) {
  return {views.size(), [=](std::size_t i) {
            cv::Mat1b mask = views.masks[i]->clone();
            const View& view = views[i];
            for (const Track& track : tracks) {
              if (track.observations.empty() || rate_scan_evidence(track, view.time_ns) == ScanEvidence::strong) continue;
              const Cluster& nearest = track.observations[track.nearest(view.time_ns)];
              if (std::abs(seconds_between(nearest.mean_time_ns, view.time_ns)) > kImageTracking.max_hidden_s) continue;
              Box box = predict_box(track, *ground, view.time_ns);
              box.size *= 2;
              std::vector<Eigen::Vector3d> corners;
              for (const Eigen::Vector3d& x : box.corners()) corners.push_back(view.camera_from_world * x);
              draw_hull(corners, view.camera, mask);
            }
            return mask;
          }};
}

FrameLabels track_in_images(const FrameLabels& labels, std::span<const Track> tracks, const BackgroundComparison& comparison,
                            const Trajectory& world_from_lidar) {
  std::vector<FrameLabels> of_tracks(tracks.size());
  parallel_for(tracks.size(), [&](std::size_t k) {
    const int number = static_cast<int>(k);
    of_tracks[k] = track_object(labels, tracks[k], number, ImageTracker(tracks[k], number, comparison, world_from_lidar));
  });
  FrameLabels out(labels.size());
  for (FrameLabels& of_track : of_tracks)
    for (std::size_t i = 0; i < out.size(); ++i) std::move(of_track[i].begin(), of_track[i].end(), std::back_inserter(out[i]));
  return out;
}

}  // namespace dvi::objects
