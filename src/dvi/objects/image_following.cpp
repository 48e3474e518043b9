#include "dvi/objects/image_following.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "dvi/core/median.h"
#include "dvi/core/threads.h"
#include "dvi/drive/outline.h"
#include "dvi/image/gray.h"
#include "dvi/image/optical_flow.h"
#include "dvi/image/region.h"
#include "dvi/objects/seconds.h"
#include "dvi/objects/track_outlines.h"

namespace dvi::objects {
namespace {

constexpr int kLeastHeight = 8;       // pixels: of less, neither flow nor comparison tells anything
constexpr double kFlowAround = 0.5;   // of an outline's longer side, each way: how far flow looks
constexpr double kLeastWithin = 0.5;  // of an outline, within the image
constexpr double kLeastKnown = 0.5;   // of an outline, that others saw
constexpr double kShown = 0.5;  // of that, which looks as others show it: before leaves, not even a car differs everywhere
constexpr double kOwn = 0.25;   // of an outline that differs, from which the rest is taken for background
constexpr std::size_t kFewestFlows = 50;
constexpr double kDrift = 0.5;       // pixels a frame: flow is no better on something small
constexpr double kScaleStep = 0.15;  // change of size from frame to frame beyond which flow is wrong
constexpr double kHiddenFor = 4;     // seconds: what is followed so long is compared with the other side of its way
constexpr double kComfortable = 3;   // meters a second squared: what the motion may be off by
constexpr double kPlaceError = 1;    // meters: likewise, at the end of what was seen

using Hull = std::vector<cv::Point2f>;  // convex, in the image

// x' = to + scale (x - from).
struct Similarity {
  cv::Point2d from, to;
  double scale = 1;

  cv::Point2d operator()(const cv::Point2d& x) const { return to + scale * (x - from); }
};

Hull hull_of(const Instance& outline) {
  cv::Mat1b mask(outline.size, uchar{0});
  draw(outline, mask);
  std::vector<cv::Point> pixels;
  cv::findNonZero(mask, pixels);
  std::vector<cv::Point> corners;
  if (!pixels.empty()) cv::convexHull(pixels, corners);
  return {corners.begin(), corners.end()};
}

Hull moved(const Hull& hull, const Similarity& by) {
  Hull out;
  for (const cv::Point2f& x : hull) out.emplace_back(by(x));
  return out;
}

cv::Mat1b drawn(const Hull& hull, cv::Size size) {
  cv::Mat1b mask(size, uchar{0});
  std::vector<cv::Point> corners;
  for (const cv::Point2f& x : hull) corners.push_back(to_drawing_pixel(x.x, x.y));
  cv::fillConvexPoly(mask, corners, 255);
  return mask;
}

cv::Point2d center_of(const Hull& hull) {
  const cv::Rect2f box = cv::boundingRect(hull);
  return {box.x + 0.5 * box.width, box.y + 0.5 * box.height};
}

double share(const cv::Mat1b& part, const cv::Mat1b& whole) {
  return cv::countNonZero(cv::Mat1b(part & whole)) / std::max(1.0, static_cast<double>(cv::countNonZero(whole)));
}

cv::Mat1b half_of(const cv::Mat1b& mask) {
  cv::Mat1b half;
  cv::resize(mask, half, {mask.cols / kScale, mask.rows / kScale}, 0, 0, cv::INTER_AREA);
  return cv::Mat1b(half > 127);
}

// Median difference of a patch from the same seen later, both without their median: light changes from frame to frame.
double unlike(const cv::Mat1b& from, const cv::Mat1b& to, const cv::Mat1b& where) {
  std::vector<float> off;
  for (int y = 0; y < where.rows; ++y)
    for (int x = 0; x < where.cols; ++x)
      if (where(y, x) != 0) off.push_back(static_cast<float>(to(y, x)) - static_cast<float>(from(y, x)));
  if (off.empty()) return 255;
  const float light = median(off);
  for (float& value : off) value = std::abs(value - light);
  return static_cast<double>(median(off));
}

// What an image shows of a patch of another one, as the similarity has it.
cv::Mat1b seen_in(const cv::Mat1b& image, const cv::Rect& patch, const Similarity& by) {
  const cv::Point2d corner = by(cv::Point2d(patch.tl()));
  const cv::Matx23d there(by.scale, 0, corner.x, 0, by.scale, corner.y);
  cv::Mat1b out;
  cv::warpAffine(image, out, there, patch.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  return out;
}

// The similarity that a flow is within an object, of which pixels are at their places in `patch`.
std::optional<Similarity> similarity_of(const cv::Mat2f& flow, const cv::Mat1b& where, const cv::Rect& patch) {
  std::vector<cv::Point> at;
  cv::findNonZero(where, at);
  if (at.size() < kFewestFlows) return std::nullopt;
  std::vector<double> dx, dy, scale;
  cv::Point2d center;
  for (const cv::Point& x : at) {
    dx.push_back(flow(x)[0]);
    dy.push_back(flow(x)[1]);
    center += cv::Point2d(x) / static_cast<double>(at.size());
  }
  const cv::Point2d shift(median(dx), median(dy));
  const cv::Rect box = cv::boundingRect(where);
  const double far = 0.25 * std::max(box.width, box.height);
  for (const cv::Point& x : at) {
    const cv::Point2d off = cv::Point2d(x) - center, change = cv::Point2d(flow(x)[0], flow(x)[1]) - shift;
    if (off.dot(off) > far * far) scale.push_back(1 + off.dot(change) / off.dot(off));
  }
  center += cv::Point2d(patch.tl());
  return Similarity{center, center + shift, scale.empty() ? 1 : median(scale)};
}

// The object's middle as its motion goes on, world axes.
Eigen::Vector3d place_of(const Track& track, const ground::ScanGround& ground, std::int64_t time_ns) {
  const std::size_t nearest = track.nearest(time_ns);
  const Track::State state = track.state(nearest);
  const Cluster& cluster = track.observations[nearest];
  const Eigen::Vector2d at = state.place + state.velocity * seconds_from(cluster.mean_time_ns, time_ns);
  const double height = ground.height(at).value_or(median(cluster.ground));
  return {at.x(), at.y(), height + 0.5 * track.height_m};
}

Box box_of(const Track& track, const ground::ScanGround& ground, std::int64_t time_ns) {
  const Eigen::Vector2d velocity = track.velocity(track.nearest(time_ns));
  const double heading = std::atan2(velocity.y(), velocity.x());
  return {{Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()).toRotationMatrix(), place_of(track, ground, time_ns)},
          {track.size_m.x(), track.size_m.y(), track.height_m}};
}

// Follows one track from view to view.
class Follower {
 public:
  Follower(const Track& track, int number, const Comparison& comparison, const Trajectory& world_from_lidar)
      : track_(track), number_(number), comparison_(comparison), world_from_lidar_(world_from_lidar) {}

  /// From a view that shows the object so, up to another one that is left out; adds to the labels, which are as the frames.
  void operator()(const Label& seen, std::size_t from, std::size_t end, FrameLabels& labels) const {
    const int way = end == kNoView || end < from ? -1 : 1;
    if (from + way == end) return;
    Hull hull = hull_of(*seen.instance);
    if (hull.empty()) return;
    cv::Mat1b object = own_pixels(from, hull);
    double drift = 0;
    std::int64_t last_told = view(from).time_ns;
    const std::int64_t start = last_told;
    for (std::size_t at = from, next = from + way; next != end; at = next, next += way) {
      const auto predicted = motion(at, next);
      if (!predicted) return;
      Similarity step = corrected(at, next, hull, object, *predicted);
      const Hull there = moved(hull, step);
      if (strays(there, next, start)) step = *predicted;
      hull = moved(hull, step);
      const cv::Mat1b mask = drawn(hull, image_size(next));
      const cv::Rect2f box = cv::boundingRect(hull);
      if (box.height < kLeastHeight || cv::countNonZero(mask) < kLeastWithin * cv::contourArea(hull)) return;
      const ImageDifference evidence = comparison_.compare(next, half_of(mask));
      const cv::Mat1b half = half_of(mask), told(half & ~evidence.untold);
      const bool known = share(told, half) > kLeastKnown;
      if (known && share(evidence.shown, told) > kShown) return;
      if (known) last_told = view(next).time_ns;
      if (std::abs(seconds_from(last_told, view(next).time_ns)) > kGoesOn) return;
      object = own_pixels(mask, evidence);
      drift += kDrift;
      labels[view(next).frame].push_back(label(seen, next, grown(mask, static_cast<int>(std::ceil(drift)))));
    }
  }

  static constexpr std::size_t kNoView = static_cast<std::size_t>(-1);

 private:
  const View& view(std::size_t i) const { return comparison_.views()[i]; }
  cv::Size image_size(std::size_t i) const { return {view(i).camera.width, view(i).camera.height}; }

  std::optional<Similarity> motion(std::size_t from, std::size_t to) const {
    const Eigen::Vector3d a = view(from).camera_from_world * place_of(track_, comparison_.ground(), view(from).time_ns);
    const Eigen::Vector3d b = view(to).camera_from_world * place_of(track_, comparison_.ground(), view(to).time_ns);
    if (!view(from).camera.in_front(a) || !view(to).camera.in_front(b)) return std::nullopt;
    const Eigen::Vector2d p = view(from).camera.project(a), q = view(to).camera.project(b);
    return Similarity{{p.x(), p.y()}, {q.x(), q.y()}, a.z() / b.z()};
  }
  // Whether a hull is farther beside where the motion goes on than an object can be.
  bool strays(const Hull& hull, std::size_t at, std::int64_t start) const {
    const Eigen::Vector3d x = view(at).camera_from_world * place_of(track_, comparison_.ground(), view(at).time_ns);
    if (!view(at).camera.in_front(x)) return true;
    const double t = seconds_from(start, view(at).time_ns);
    const double off = std::abs(center_of(hull).x - view(at).camera.project(x).x()) * x.z() / view(at).camera.fx;
    return off > kPlaceError + 0.5 * track_.size_m.maxCoeff() + 0.5 * kComfortable * t * t;
  }

  // The pixels of an outline that are the object's as far as others tell, or all.
  static cv::Mat1b own_pixels(const cv::Mat1b& mask, const ImageDifference& evidence) {
    cv::Mat1b differs;
    cv::resize(evidence.differs, differs, mask.size(), 0, 0, cv::INTER_NEAREST);
    const cv::Mat1b own(differs & mask);
    return cv::countNonZero(own) > kOwn * cv::countNonZero(mask) ? own : mask;
  }
  cv::Mat1b own_pixels(std::size_t at, const Hull& hull) const {
    const cv::Mat1b mask = drawn(hull, image_size(at));
    return own_pixels(mask, comparison_.compare(at, half_of(mask)));
  }

  // The predicted step, corrected by flow if the object then looks more alike.
  Similarity corrected(std::size_t from, std::size_t to, const Hull& hull, const cv::Mat1b& object,
                       const Similarity& predicted) const {
    const cv::Rect box = cv::boundingRect(hull) & cv::Rect({}, object.size());
    const int around = std::max(kMinFlowSidePx / 2, cvRound(kFlowAround * std::max(box.width, box.height)));
    const cv::Rect patch =
        cv::Rect(box.x - around, box.y - around, box.width + 2 * around, box.height + 2 * around) & cv::Rect({}, object.size());
    if (patch.width < kMinFlowSidePx || patch.height < kMinFlowSidePx) return predicted;
    const auto& images = comparison_.views().images;
    const cv::Mat1b here = gray_8bit(*images[from])(patch).clone(), image = gray_8bit(*images[to]), where = object(patch);
    const cv::Mat1b there = seen_in(image, patch, predicted);
    const auto change = similarity_of(compute_optical_flow(here, there), where, patch);
    if (!change || std::abs(change->scale - 1) > kScaleStep) return predicted;
    const Similarity step{change->from, predicted(change->to), predicted.scale * change->scale};
    return unlike(here, seen_in(image, patch, step), where) < unlike(here, there, where) ? step : predicted;
  }

  Label label(const Label& seen, std::size_t at, const cv::Mat1b& mask) const {
    Label out;
    out.track = number_;
    out.type = seen.type;
    out.instance = to_outline(mask);
    if (const auto pose = world_from_lidar_.at(view(at).time_ns)) {
      out.box = box_of(track_, comparison_.ground(), view(at).time_ns);
      out.box->frame_from_box = pose->inverse() * out.box->frame_from_box;
    }
    return out;
  }

  const Track& track_;
  int number_;
  const Comparison& comparison_;
  const Trajectory& world_from_lidar_;
};

// Of one track, as the frames.
FrameLabels followed(const FrameLabels& labels, const Track& track, int number, const Comparison& comparison,
                     const Trajectory& world_from_lidar) {
  const std::vector<View>& views = comparison.views().views;
  FrameLabels out(labels.size());
  std::vector<std::size_t> seen;                             // views
  std::vector<std::pair<std::size_t, const Label*>> poorly;  // frames
  for (std::size_t i = 0; i < views.size(); ++i)
    for (const Label& label : labels[views[i].frame]) {
      const ScanEvidence shown = label.track == number ? shown_by_scans(track, views[i].time_ns) : ScanEvidence::no;
      if (shown == ScanEvidence::poorly) poorly.emplace_back(views[i].frame, &label);
      if (shown != ScanEvidence::well) continue;
      seen.push_back(i);
      out[views[i].frame].push_back(label);
    }
  const auto from = [&](std::size_t view) { return out[views[view].frame].front(); };
  const Follower follow(track, number, comparison, world_from_lidar);
  if (!seen.empty()) follow(from(seen.front()), seen.front(), Follower::kNoView, out);
  for (std::size_t k = 0; k < seen.size(); ++k)
    follow(from(seen[k]), seen[k], k + 1 < seen.size() ? seen[k + 1] : views.size(), out);
  for (const auto& [frame, label] : poorly)
    if (out[frame].empty()) out[frame].push_back(*label);
  return out;
}

}  // namespace

Lazy<cv::Mat1b> whereabouts(const Views& views, const std::vector<Track>& tracks,
                            const std::shared_ptr<const ground::ScanGround>& ground) {
  return {views.size(), [=](std::size_t i) {
            cv::Mat1b mask = views.masks[i]->clone();
            const View& view = views[i];
            for (const Track& track : tracks) {
              if (track.observations.empty() || shown_by_scans(track, view.time_ns) == ScanEvidence::well) continue;
              const Cluster& nearest = track.observations[track.nearest(view.time_ns)];
              if (std::abs(seconds_from(nearest.mean_time_ns, view.time_ns)) > kHiddenFor) continue;
              Box box = box_of(track, *ground, view.time_ns);
              box.size *= 2;
              std::vector<Eigen::Vector3d> corners;
              for (const Eigen::Vector3d& x : box.corners()) corners.push_back(view.camera_from_world * x);
              draw_hull(corners, view.camera, mask);
            }
            return mask;
          }};
}

FrameLabels followed_in_images(const FrameLabels& labels, const std::vector<Track>& tracks, const Comparison& comparison,
                               const Trajectory& world_from_lidar) {
  std::vector<FrameLabels> of_tracks(tracks.size());
  parallel_for(tracks.size(), [&](std::size_t k) {
    of_tracks[k] = followed(labels, tracks[k], static_cast<int>(k), comparison, world_from_lidar);
  });
  FrameLabels out(labels.size());
  for (FrameLabels& of_track : of_tracks)
    for (std::size_t i = 0; i < out.size(); ++i) std::move(of_track[i].begin(), of_track[i].end(), std::back_inserter(out[i]));
  return out;
}

}  // namespace dvi::objects
