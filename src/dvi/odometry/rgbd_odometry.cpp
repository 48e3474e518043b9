#include "dvi/odometry/rgbd_odometry.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "dvi/odometry/alignment_criteria.h"
#include "dvi/odometry/key_frames.h"
#include "dvi/odometry/motion_prior.h"
#include "dvi/odometry/rgbd_result.h"

namespace dvi::odometry {
namespace {

/// Parameters of tracking.
struct RgbdTrackingParams {
  double min_step_s = 1e-3;     // between two images, for constant velocity
  double max_step_s = 0.2;      // likewise
  double full_overlap = 0.7;    // with the key frame; below, another key frame is chosen ...
  double min_overlap = 0.45;    // ... even if the image is blurred
  double known_overlap = 0.75;  // with an earlier key frame that is chosen again
  double loop_overlap = 0.6;    // with an earlier key frame, for a loop
  std::size_t max_loops_per_key_frame = 3;
  std::size_t roll_candidates = 12;     // key frames whose thumbnails are compared with rolls
  std::size_t recovery_candidates = 4;  // key frames that an image is aligned to
  double min_similarity = 0.5;          // correlation of thumbnails
  std::size_t new_map_after = 10;       // lost images
  double max_roll_deg = 8;              // between two images
  double max_recovery_roll_deg = 24;    // between an image and any key frame
  double min_known_share = 0.05;        // fraction of pixels with depth in an aligned image
  double fast_rad_s = 1.5;              // rotation at which a rolling shutter distorts a key frame noticeably
  double blurred = 0.7;                 // gradient over the average gradient
  double max_delay_error_px = 0.7;      // displacement of the depth by a wrong prediction of the motion
};
constexpr RgbdTrackingParams kTracking;

double sum_gradients(const RgbdImage& image) {
  const RgbdLevel& level = image.levels.front();
  if (level.gray.empty()) return 0;
  double sum = 0;
  for (int y = 0; y < level.gray.rows; y += 2)
    for (int x = 0; x + 1 < level.gray.cols; x += 2) sum += std::abs(level.gray(y, x + 1) - level.gray(y, x));
  return sum;
}

class RgbdTracker {
 public:
  RgbdTracker(const Drive& drive, const OdometryOptions& options, const Trajectory& given)
      : drive_(drive),
        options_(options),
        prior_(given),
        moments_(pair_depth_with_color(drive)),
        track_(moments_.size()),
        keys_(moments_.size(), [this](std::size_t i) { return ReferenceView(read(i, track_[i].depth_twist)); }) {
    if (drive.camera.width > 0) focal_px_ = get_finest_camera(drive.camera).fx;
  }

  RgbdTrack run(const Tick& tick) {
    for (std::size_t i = 0; i < moments_.size(); ++i) {
      follow(i);
      tick();
    }
    refine_delays();
    RgbdTrack out{std::move(moments_), std::move(track_), {}, {}, std::move(edges_)};
    for (std::size_t k = 0; k < keys_.size(); ++k) {
      out.world_from_key.push_back(keys_[k].world_from_camera);
      out.map_of_key.push_back(keys_[k].map);
    }
    return out;
  }

 private:
  RgbdImage read(std::size_t i, const Vector6d& twist) const { return read_rgbd_image(drive_, moments_[i], twist); }
  SE3 world_from_camera(std::size_t i) const { return keys_[*track_[i].key].world_from_camera * track_[i].key_from_camera; }

  void follow(std::size_t i) {
    const bool tracked =
        i > 0 && track_[i - 1].key && to_seconds(moments_[i].time_ns - moments_[i - 1].time_ns) < kTracking.max_step_s;
    track_[i].twist = tracked ? track_[i - 1].twist : Vector6d(Vector6d::Zero());
    track_[i].depth_twist = track_[i].twist;
    RgbdImage image = read(i, track_[i].depth_twist);
    if (!has_depth(image)) {
      handle_lost(i, image);
      return;
    }
    if (keys_.size() == 0) {
      begin_map(i, image);
    } else if (!(tracked && follow_track(i, image)) && !recover(i, image)) {
      handle_lost(i, image);
    } else {
      lost_for_ = 0;
      update_motion(i, image);
      choose_key(i, image);
    }
    if (track_[i].key) last_thumbnail_ = make_thumbnail(image);
  }

  static bool has_depth(const RgbdImage& image) {
    const cv::Mat3f& points = image.levels.back().points;
    std::size_t known = 0;
    for (const cv::Vec3f& p : points) known += p[2] > 0 ? 1 : 0;
    return static_cast<double>(known) > kTracking.min_known_share * static_cast<double>(points.total());
  }

  void begin_map(std::size_t i, RgbdImage& image) {
    track_[i].twist = track_[i].depth_twist = estimate_first_twist(i);
    if (!track_[i].twist.isZero()) image = read(i, track_[i].twist);
    track_[i].key = keys_.add(i, image, SE3(), next_map_++);
    track_[i].key_from_camera = SE3();
    track_[i].overlap = 1;
    average_gradient_ = sum_gradients(image);
    lost_for_ = 0;
  }

  /// Estimates the velocity at the beginning of a map from the next image, if the depth has a delay that it must correct.
  Vector6d estimate_first_twist(std::size_t i) const {
    constexpr int kRounds = 3;
    const Vector6d unknown = Vector6d::Zero();
    if (std::abs(moments_[i].depth_delay_s) < kMinDelayS || i + 1 >= moments_.size()) return unknown;
    const double dt = to_seconds(moments_[i + 1].time_ns - moments_[i].time_ns);
    if (dt < kTracking.min_step_s || dt > kTracking.max_step_s) return unknown;
    Vector6d twist = unknown;
    for (int round = 0; round < kRounds; ++round) {
      const Alignment next = align(ReferenceView(read(i, twist)), read(i + 1, twist), se3_exp(twist * dt));
      if (!kReliable.accept(next)) return unknown;
      twist = se3_log(next.reference_from_current) / dt;
    }
    return twist;
  }

  void handle_lost(std::size_t i, RgbdImage& image) {
    track_[i].key.reset();
    if (++lost_for_ > kTracking.new_map_after && has_depth(image)) begin_map(i, image);
  }

  /// Aligns the image to key frame `k` from the guess that fits best on the coarse levels; if the result is poor, from all.
  Alignment align_from(std::size_t k, const RgbdImage& image, const std::vector<SE3>& starts) const {
    const std::shared_ptr<const ReferenceView> view = keys_.view(k);
    std::vector<Alignment> coarse;
    for (const SE3& start : starts) coarse.push_back(align(*view, image, start, {3, 2}));
    std::stable_sort(coarse.begin(), coarse.end(), [](const Alignment& a, const Alignment& b) { return a.cost < b.cost; });
    Alignment best = align(*view, image, coarse.front().reference_from_current, {1, 0});
    for (std::size_t n = 1; n < coarse.size() && !kGood.accept(best); ++n)
      if (const Alignment other = align(*view, image, coarse[n].reference_from_current, {1, 0}); other.cost < best.cost)
        best = other;
    return best;
  }

  void accept(std::size_t i, std::size_t k, const Alignment& alignment) {
    RgbdPose& pose = track_[i];
    pose.key = k;
    pose.key_from_camera = alignment.reference_from_current;
    pose.overlap = alignment.overlap();
    pose.points = alignment.compared;
    pose.inliers = alignment.inliers;
    pose.residual_m = alignment.residual_m;
    pose.information = compute_information_in_current(alignment, std::max(turn_rad_s(i), turn_rad_s(keys_[k].moment)));
  }

  double get_step_s(std::size_t i) const {
    return std::max(kTracking.min_step_s, to_seconds(moments_[i].time_ns - moments_[i - 1].time_ns));
  }

  bool follow_track(std::size_t i, RgbdImage& image) {
    const double dt = get_step_s(i);
    std::vector<SE3> steps{se3_exp(track_[i - 1].twist * dt), SE3()};
    if (const ThumbnailMatch turn = match(last_thumbnail_, make_thumbnail(image), kTracking.max_roll_deg);
        turn.correlation > kTracking.min_similarity)
      steps.push_back({turn.a_from_b, Eigen::Vector3d::Zero()});
    if (const auto motion = prior_.motion(moments_[i - 1].time_ns, moments_[i].time_ns))
      steps.push_back(drive_.camera_from_lidar * *motion * drive_.camera_from_lidar.inverse());
    const auto attempt = [&](std::size_t k, const SE3& key_from_last) {
      std::vector<SE3> starts;
      for (const SE3& step : steps) starts.push_back(key_from_last * step);
      Alignment found = align_from(k, image, starts);
      correct_delay(i, k, found, image);
      if (!kReliable.accept(found)) return false;
      accept(i, k, found);
      return true;
    };
    const std::size_t key = *track_[i - 1].key;
    if (attempt(key, track_[i - 1].key_from_camera)) return true;
    if (keys_[key].moment == i - 1) return false;
    // The image before is more similar than its key frame.
    track_[i - 1].depth_twist = track_[i - 1].twist;
    const std::size_t last = keys_.add(i - 1, read(i - 1, track_[i - 1].depth_twist), world_from_camera(i - 1), keys_[key].map);
    edges_.push_back({key, last, track_[i - 1].key_from_camera, track_[i - 1].information, false});
    track_[i - 1].key = last;
    track_[i - 1].key_from_camera = SE3();
    return attempt(last, SE3());
  }

  /// Reads the image again if the depth was moved to the time of the color image by a motion that was predicted wrongly.
  void correct_delay(std::size_t i, std::size_t k, Alignment& found, RgbdImage& image) {
    const SE3 step =
        track_[i - 1].key_from_camera.inverse() * key_from_key(*track_[i - 1].key, k) * found.reference_from_current;
    const Vector6d twist = se3_log(step) / get_step_s(i);
    if (compute_delay_error_px(i, twist) < kTracking.max_delay_error_px || !kReliable.accept(found)) return;
    track_[i].depth_twist = twist;
    image = read(i, twist);
    found = align(*keys_.view(k), image, found.reference_from_current, {1, 0});
  }

  /// Aligns images again whose depth was moved by a motion that is wrong according to the poses of the images after them.
  void refine_delays() {
    const std::vector<RgbdPose> found = track_;
    const auto pose = [&](std::size_t i) { return keys_[*found[i].key].world_from_camera * found[i].key_from_camera; };
    for (std::size_t i = 1; i + 1 < moments_.size(); ++i) {
      const double dt = to_seconds(moments_[i + 1].time_ns - moments_[i - 1].time_ns);
      if (!found[i - 1].key || !found[i].key || !found[i + 1].key || dt < kTracking.min_step_s || dt > 2 * kTracking.max_step_s)
        continue;
      const std::size_t k = *found[i].key;
      if (keys_[k].moment == i || keys_[*found[i - 1].key].map != keys_[*found[i + 1].key].map) continue;
      const Vector6d twist = se3_log(pose(i - 1).inverse() * pose(i + 1)) / dt;
      if (compute_delay_error_px(i, twist) < kTracking.max_delay_error_px) continue;
      const Alignment again = align(*keys_.view(k), read(i, twist), found[i].key_from_camera, {1, 0});
      if (!kReliable.accept(again)) continue;
      accept(i, k, again);
      track_[i].twist = track_[i].depth_twist = twist;
    }
  }

  /// The displacement of the depth, in pixels, if the true velocity is `twist`.
  double compute_delay_error_px(std::size_t i, const Vector6d& twist) const {
    return (twist - track_[i].depth_twist).norm() * std::abs(moments_[i].depth_delay_s) * focal_px_;
  }

  SE3 key_from_key(std::size_t a, std::size_t b) const {
    return keys_[a].world_from_camera.inverse() * keys_[b].world_from_camera;
  }

  void update_motion(std::size_t i, const RgbdImage& image) {
    average_gradient_ = 0.9 * average_gradient_ + 0.1 * sum_gradients(image);
    if (i == 0 || !track_[i - 1].key) return;
    const double dt = to_seconds(moments_[i].time_ns - moments_[i - 1].time_ns);
    if (dt > kTracking.min_step_s && dt < kTracking.max_step_s && keys_[*track_[i].key].map == keys_[*track_[i - 1].key].map)
      track_[i].twist = se3_log(world_from_camera(i - 1).inverse() * world_from_camera(i)) / dt;
  }

  /// Recovers a lost track: tries the key frames that are most similar to the image.
  bool recover(std::size_t i, const RgbdImage& image) {
    std::optional<std::size_t> best_key;
    Alignment best;
    for (const auto& [k, start] :
         find_similar_keys(make_thumbnail(image), kTracking.recovery_candidates, [](std::size_t) { return true; })) {
      const Alignment found = align_from(k, image, {start, SE3()});
      if (kCertain.accept(found) && (!best_key || found.cost < best.cost)) best_key = k, best = found;
    }
    if (!best_key) return false;
    accept(i, *best_key, best);
    return true;
  }

  /// Returns the key frames whose thumbnails are most similar, with the rotations of the best match.
  template <class Wanted>
  std::vector<std::pair<std::size_t, SE3>> find_similar_keys(const Thumbnail& thumbnail, std::size_t count,
                                                             Wanted wanted) const {
    std::vector<std::pair<ThumbnailMatch, std::size_t>> all;
    const auto sort = [&] {
      std::stable_sort(all.begin(), all.end(),
                       [](const auto& a, const auto& b) { return a.first.correlation > b.first.correlation; });
    };
    for (std::size_t k = 0; k < keys_.size(); ++k)
      if (wanted(k)) all.emplace_back(match(keys_[k].thumbnail, thumbnail, 0), k);
    sort();
    all.resize(std::min(all.size(), kTracking.roll_candidates));
    for (auto& [turn, k] : all) turn = match(keys_[k].thumbnail, thumbnail, kTracking.max_recovery_roll_deg);
    sort();
    std::vector<std::pair<std::size_t, SE3>> out;
    for (const auto& [turn, k] : all)
      if (out.size() < count && turn.correlation > kTracking.min_similarity)
        out.emplace_back(k, SE3{turn.a_from_b, Eigen::Vector3d::Zero()});
    return out;
  }

  /// Returns the key frames of the map with at least this overlap with the image, the best first.
  std::vector<std::size_t> find_overlapping_keys(const SE3& pose, std::size_t map, double min_overlap,
                                                 const RgbdImage& image) const {
    std::vector<std::pair<double, std::size_t>> all;
    for (std::size_t k = 0; k < keys_.size(); ++k)
      if (keys_[k].map == map) {
        const double overlap = keys_.predict_overlap(k, pose, image.levels[0].camera, image.levels[0].points.size());
        if (overlap >= min_overlap) all.emplace_back(overlap, k);
      }
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<std::size_t> out;
    for (const auto& [overlap, k] : all) out.push_back(k);
    return out;
  }

  /// Chooses an earlier key frame, or the image itself, if the overlap with the current key frame is too small.
  void choose_key(std::size_t i, const RgbdImage& image) {
    const RgbdPose pose = track_[i];
    const double turn = turn_rad_s(i), key_turn = turn_rad_s(keys_[*pose.key].moment);
    const bool key_is_fast = key_turn > kTracking.fast_rad_s && turn < 0.5 * key_turn;  // a rolling shutter distorts it
    if (pose.overlap >= kTracking.full_overlap && !key_is_fast) return;
    const SE3 here = world_from_camera(i);
    const std::size_t map = keys_[*pose.key].map;
    for (const std::size_t k : find_overlapping_keys(here, map, kTracking.known_overlap, image)) {
      if (k == *pose.key || turn_rad_s(keys_[k].moment) > std::max(turn, kTracking.fast_rad_s)) continue;
      const Alignment found = align_from(k, image, {keys_[k].world_from_camera.inverse() * here});
      if (!kCertain.accept(found) || found.overlap() < kTracking.full_overlap) break;
      add_edge(*pose.key, k, i, found);
      accept(i, k, found);
      return;
    }
    const bool distorted =
        sum_gradients(image) < kTracking.blurred * average_gradient_ || turn > std::max(kTracking.fast_rad_s, key_turn);
    if (distorted && pose.overlap >= kTracking.min_overlap) return;
    const std::size_t key = keys_.add(i, image, here, map);
    edges_.push_back({*pose.key, key, pose.key_from_camera, pose.information, false});
    track_[i].key = key;
    track_[i].key_from_camera = SE3();
    track_[i].overlap = 1;
    track_[i].depth_twist = track_[i].twist;
    if (options_.loops) find_loops(key, image);
  }

  /// Adds the motion between two key frames that two alignments of image i give.
  void add_edge(std::size_t a, std::size_t b, std::size_t i, const Alignment& b_from_camera) {
    if (!options_.loops) return;
    const double turn = std::max({turn_rad_s(i), turn_rad_s(keys_[a].moment), turn_rad_s(keys_[b].moment)});
    edges_.push_back({a, b, track_[i].key_from_camera * b_from_camera.reference_from_current.inverse(),
                      compute_information_in_reference(b_from_camera, turn), true});
  }

  /// The rotation speed of the camera at a moment in radians per second.
  double turn_rad_s(std::size_t i) const { return track_[i].twist.tail<3>().norm(); }

  void find_loops(std::size_t key, const RgbdImage& image) {
    const SE3 here = keys_[key].world_from_camera;
    std::size_t tried = 0;
    for (const std::size_t k : find_overlapping_keys(here, keys_[key].map, kTracking.loop_overlap, image))
      if (k + 1 < key && tried++ < kTracking.max_loops_per_key_frame)
        close_loop(k, key, align_from(k, image, {keys_[k].world_from_camera.inverse() * here}));
    const auto is_in_other_map = [&](std::size_t k) { return keys_[k].map != keys_[key].map; };
    for (const auto& [k, start] : find_similar_keys(keys_[key].thumbnail, kTracking.recovery_candidates, is_in_other_map))
      if (is_in_other_map(k)) close_loop(k, key, align_from(k, image, {start, SE3()}));
  }

  /// Connects a new key frame with an earlier one; if they are in different maps, joins the maps.
  void close_loop(std::size_t earlier, std::size_t key, const Alignment& alignment) {
    if (!kCertain.accept(alignment)) return;
    const bool joins = keys_[earlier].map != keys_[key].map;
    if (joins) {
      const SE3 world_from_key = keys_[earlier].world_from_camera * alignment.reference_from_current;
      keys_.join(keys_[key].map, keys_[earlier].map, world_from_key * keys_[key].world_from_camera.inverse());
    }
    edges_.push_back(
        {earlier, key, alignment.reference_from_current,
         compute_information_in_current(alignment, std::max(turn_rad_s(keys_[earlier].moment), turn_rad_s(keys_[key].moment))),
         !joins});
  }

  const Drive& drive_;
  const OdometryOptions& options_;
  const MotionPrior prior_;
  std::vector<RgbdMoment> moments_;
  std::vector<RgbdPose> track_;
  KeyFrames keys_;
  std::vector<scan_match::PoseEdge> edges_;
  Thumbnail last_thumbnail_;
  double focal_px_ = 0, average_gradient_ = 0;
  std::size_t lost_for_ = 0, next_map_ = 0;
};

}  // namespace

bool has_color_and_depth(const Drive& drive) {
  return drive.sensor == Sensor::depth_camera && !drive.frames.empty() && !drive.images.empty() && drive.camera.width > 0;
}

Odometry rgbd_odometry(const Drive& drive, const OdometryOptions& options, const Trajectory& given, const BeginPart& begin) {
  RgbdTracker tracker(drive, options, given);
  RgbdTrack track = tracker.run(begin("odometry", drive.scan_headers.size()));
  const Tick tick = begin("loops", 1);
  Odometry out = to_odometry(drive, std::move(track));
  tick();
  return out;
}

}  // namespace dvi::odometry
