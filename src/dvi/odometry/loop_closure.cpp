#include "dvi/odometry/loop_closure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "dvi/scan_match/pose_graph.h"
#include "dvi/scan_match/scan_features.h"

namespace dvi::odometry {

using namespace scan_match;

namespace {

/// Distances in meters at which loops are looked for; angles in radians.
struct Lengths {
  double moved = 0.5;        ///< steps by which the way is measured: a car that stands does not get on by noise
  double long_way = 30;      ///< between two passes
  double every = 5;          ///< one candidate
  double least_error = 5;    ///< how far off poses may be: more the longer the way between ...
  double drift = 0.03;       ///< ... by this share of it
  double most_error = 15;    ///< ... up to here
  double place = 15;         ///< the map of a place: so far both ways ...
  double place_step = 2.5;   ///< ... a scan each
  double check = 3;          ///< before the later scan: one that must agree
  double grid = 1;           ///< starts ...
  bool level = true;         ///< ... on level ground, held the same way: where a car passes twice, the road does that
  double most_turn = 4;      ///< from one view to the other: any for a sensor that looks all round
  double least_share = 0.7;  ///< of features that stand, of those of a scan of the place itself
};

/// A depth camera reaches a tenth as far as a LiDAR does. A hand tilts it. It looks one way only: views must overlap. Much of
/// what it sees, the walls, other rooms have too.
Lengths lengths_for(const Drive& drive) {
  if (drive.sensor != Sensor::depth_camera) return {};
  return {.moved = 0.05,
          .long_way = 3,
          .every = 0.5,
          .least_error = 0.3,
          .most_error = 0.75,
          .place = 0.6,
          .place_step = 0.12,
          .check = 0.3,
          .grid = 0.15,
          .level = false,
          .most_turn = 0.4,
          .least_share = 0.8};
}

constexpr double kTurn = 0.035, kLargestTurn = 0.12;  // starts, in radians
constexpr std::size_t kBestStarts = 3, kEveryFeature = 4;
constexpr double kMostResidual = 1.3;   // of that of a scan of the place itself ...
constexpr double kLeastOwnShare = 0.1;  // ... which must see something that stands
constexpr double kNear = 0.6;           // of a voxel: a feature that far off counts half
// Of MatchOptions::noise_m, which grows with the sensor's other errors; and in radians.
constexpr double kOn = 5;                                // features that lie on a surface
constexpr double kLoopAgree = 5, kLoopAgreeTurn = 0.01;  // the two scans with odometry between them
constexpr double kLoop = 2.0 / 3, kLoopTurn = 0.001;     // standard deviations: of a loop,
constexpr double kStep = 1.0 / 6, kStepTurn = 0.0003;    // of odometry's steps,
constexpr double kLostStep = 100.0 / 3,
                 kLostStepTurn = 0.05;  // and of those to scans that it lost; on top of registration's own

/// The scans that odometry gave poses to, by their place in the trajectory.
struct Course {
  std::vector<std::size_t> scan_index;
  std::vector<SE3> pose;
  std::vector<Vector6d> twist;  // per second
  std::vector<double> way_m;    // since the first

  std::size_t size() const { return pose.size(); }
};

Course course_of(const Odometry& odometry, const Lengths& lengths) {
  Course out;
  for (std::size_t i = 0; i < odometry.scans.size(); ++i) {
    const ScanFit::State state = odometry.scans[i].state;
    if (state != ScanFit::State::no_points && state != ScanFit::State::duplicate) out.scan_index.push_back(i);
  }
  const std::vector<StampedPose>& poses = odometry.world_from_lidar.poses();
  if (poses.size() != out.scan_index.size()) return {};  // a lone scan's second pose
  std::size_t last = 0;
  double way = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    out.pose.push_back(poses[i].world_from_body);
    const StampedPose &a = poses[i > 0 ? i - 1 : 0], &b = poses[std::min(i + 1, poses.size() - 1)];
    const double seconds = 1e-9 * static_cast<double>(b.time_ns - a.time_ns);
    out.twist.push_back(seconds > 0 ? Vector6d(se3_log(a.world_from_body.inverse() * b.world_from_body) / seconds)
                                    : Vector6d(Vector6d::Zero()));
    const double moved = (out.pose[i].t - out.pose[last].t).norm();
    if (moved > lengths.moved) way += moved, last = i;
    out.way_m.push_back(way);
  }
  return out;
}

double pose_error(double way_m, const Lengths& lengths) {
  return std::min(lengths.least_error + lengths.drift * way_m, lengths.most_error);
}

double turn_between(const SE3& a, const SE3& b) { return so3_log(a.R.transpose() * b.R).norm(); }

/// The poses a long way before one that moves along the course, by place.
class EarlierPoses {
 public:
  EarlierPoses(const Course& course, const Lengths& lengths) : course_(course), lengths_(lengths) {}

  /// The one nearest to pose i, if it is within reach and looks the same way. `i` never falls.
  std::optional<std::size_t> nearest_to(std::size_t i) {
    for (; far_before(next_, i); ++next_) cells_[cell_of(next_)].push_back(next_);
    std::optional<std::size_t> out;
    double nearest = lengths_.most_error;
    const auto [x, y] = cell_of(i);
    for (const int column : {x - 1, x, x + 1})
      for (const int row : {y - 1, y, y + 1})
        if (const auto cell = cells_.find({column, row}); cell != cells_.end())
          for (const std::size_t k : cell->second) {
            const double distance = (course_.pose[k].t - course_.pose[i].t).norm();
            if (distance > nearest || distance >= pose_error(course_.way_m[i] - course_.way_m[k], lengths_)) continue;
            if (turn_between(course_.pose[k], course_.pose[i]) > lengths_.most_turn) continue;
            if (distance < nearest || (out && k < *out)) out = k, nearest = distance;
          }
    return out;
  }

 private:
  bool far_before(std::size_t k, std::size_t i) const {
    return k < i && course_.way_m[i] - course_.way_m[k] > lengths_.long_way;
  }
  std::pair<int, int> cell_of(std::size_t i) const {
    const auto of = [&](double meters) { return static_cast<int>(std::floor(meters / lengths_.most_error)); };
    return {of(course_.pose[i].t.x()), of(course_.pose[i].t.y())};
  }

  const Course& course_;
  const Lengths& lengths_;
  std::size_t next_ = 0;
  std::map<std::pair<int, int>, std::vector<std::size_t>> cells_;  // of most_error meters
};

/// Without roll, pitch and height: where a car passes twice, the road holds it the same way.
SE3 leveled(const SE3& pose) {
  const double yaw = std::atan2(pose.R(1, 0), pose.R(0, 0));
  return {so3_exp({0, 0, yaw}), {pose.t.x(), pose.t.y(), 0}};
}

struct Fit {
  scan_match::Registration registration;
  double share = 0;  // compute_scene_share
};

class LoopFinder {
 public:
  LoopFinder(const Drive& drive, const OdometryOptions& options, const Course& course, const Lengths& lengths)
      : drive_(drive), options_(options), course_(course), lengths_(lengths) {}

  std::optional<Loop> operator()(std::size_t earlier, std::size_t later) {
    scan_match::LocalMaps place = map_round(earlier, later);
    const Fit own = fit(features(earlier).sparse, {}, earlier, place, 0);
    if (own.share < kLeastOwnShare) return std::nullopt;
    const SE3 moved = course_.pose[earlier].inverse() * course_.pose[later];
    const SE3 guess = lengths_.level ? leveled(moved) : moved;
    const double radius = pose_error(course_.way_m[later] - course_.way_m[earlier], lengths_);
    const scan_match::Features sparse = features(later).sparse;
    Fit best;
    for (const SE3& start : starts(sparse, later, guess, radius, place)) {
      const Fit found = fit(sparse, start, later, place, 8);
      if (found.share > best.share) best = found;
    }
    const SE3& pose = best.registration.world_from_lidar;
    if (!fits(best, own) || (pose.t - guess.t).norm() > radius || !agrees(pose, own, later, place)) return std::nullopt;
    return Loop{earlier, later, pose, best.registration.information};
  }

 private:
  scan_match::ScanFeatures features(std::size_t i) const {
    const std::shared_ptr<const Scan> scan = drive_.scans[course_.scan_index[i]];
    return scan_match::extract_scan_features(drive_, *scan, scan_match::find_scan_rings(drive_, *scan), options_);
  }

  /// The scene in the axes of pose i, from scans before and after it but from long before pose `later`, without its own.
  scan_match::LocalMaps map_round(std::size_t i, std::size_t later) const {
    scan_match::LocalMaps scene = scan_match::make_empty_scene(options_);
    const auto add = [&](std::size_t k) {
      scene.add(features(k).dense, course_.pose[i].inverse() * course_.pose[k], course_.twist[k]);
    };
    const double at = course_.way_m[i], last = std::min(at + lengths_.place, course_.way_m[later] - 0.5 * lengths_.long_way);
    double next = at - lengths_.place;
    const auto from = std::partition_point(course_.way_m.begin(), course_.way_m.end(), [&](double way) { return way < next; });
    for (auto k = static_cast<std::size_t>(from - course_.way_m.begin()); k < later && course_.way_m[k] <= last; ++k)
      if (k != i && course_.way_m[k] >= next) add(k), next = course_.way_m[k] + lengths_.place_step;
    return scene;
  }

  Fit fit(const scan_match::Features& sparse, const SE3& guess, std::size_t i, scan_match::LocalMaps& place, int coarse) const {
    scan_match::RegisterOptions options = scan_match::to_register_options(options_);
    options.coarse_iterations = coarse;
    options.iterations += coarse;
    options.prior_m = 1;
    Fit out;
    out.registration = scan_match::register_scan(sparse, guess, course_.twist[i], {}, 0, place, options);
    out.share = scan_match::compute_scene_share(sparse, course_.twist[i], out.registration.world_from_lidar, place,
                                                kOn * options_.noise_m);
    return out;
  }

  bool fits(const Fit& fit, const Fit& own) const {
    return fit.registration.degenerate == 0 && fit.share > lengths_.least_share * own.share &&
           fit.registration.residual_m < kMostResidual * own.registration.residual_m;
  }

  /// The starts on a grid round the guess at which most features lie on large planes and lines.
  std::vector<SE3> starts(const scan_match::Features& sparse, std::size_t later, const SE3& guess, double radius,
                          scan_match::LocalMaps& place) const {
    struct Start {
      double score;
      SE3 pose;
    };
    std::vector<Eigen::Vector3d> planes, edges;
    for (std::size_t k = 0; k < sparse.planes.size(); k += kEveryFeature)
      planes.push_back(scan_match::compensate(sparse.planes[k], course_.twist[later]));
    for (const scan_match::Feature& edge : sparse.edges) edges.push_back(scan_match::compensate(edge, course_.twist[later]));
    std::vector<Start> all;
    const int cells = static_cast<int>(radius / lengths_.grid), turns = static_cast<int>(kLargestTurn / kTurn);
    const int rise = lengths_.level ? 0 : cells;
    for (int x = -cells; x <= cells; ++x)
      for (int y = -cells; y <= cells; ++y)
        for (int z = -rise; z <= rise; ++z)
          for (int turn = -turns; turn <= turns && x * x + y * y + z * z <= cells * cells; ++turn) {
            SE3 pose = guess;
            pose.t += lengths_.grid * Eigen::Vector3d(x, y, z);
            pose.R = so3_exp({0, 0, kTurn * turn}) * pose.R;
            all.push_back({score(planes, pose, 1, place.coarse) + score(edges, pose, 2, place.edges), pose});
          }
    std::stable_sort(all.begin(), all.end(), [](const Start& a, const Start& b) { return a.score > b.score; });
    std::vector<SE3> out{guess};
    for (std::size_t k = 0; k < std::min(kBestStarts, all.size()); ++k) out.push_back(all[k].pose);
    return out;
  }

  double score(const std::vector<Eigen::Vector3d>& points, const SE3& pose, int thin, scan_match::LocalMap& map) const {
    const double near = kNear * options_.voxel_m, near2 = near * near;
    double out = 0;
    for (const Eigen::Vector3d& point : points) {
      const Eigen::Vector3d p = pose * point;
      const scan_match::Shape* shape = map.at(p, thin);
      if (shape == nullptr) continue;
      const double off2 = (shape->axes.leftCols(thin).transpose() * (p - shape->mean)).squaredNorm();
      out += near2 / (near2 + off2);
    }
    return out;
  }

  /// Whether a scan a little before the later one is found where odometry puts it from there.
  bool agrees(const SE3& found, const Fit& own, std::size_t later, scan_match::LocalMaps& place) const {
    std::size_t k = later;
    while (k > 0 && course_.way_m[later] - course_.way_m[k] < lengths_.check) --k;
    const SE3 expected = found * (course_.pose[later].inverse() * course_.pose[k]);
    const Fit other = fit(features(k).sparse, expected, k, place, 4);
    const SE3 off = expected.inverse() * other.registration.world_from_lidar;
    return fits(other, own) && off.t.norm() < kLoopAgree * options_.noise_m && so3_log(off.R).norm() < kLoopAgreeTurn;
  }

  const Drive& drive_;
  const OdometryOptions& options_;
  const Course& course_;
  const Lengths& lengths_;
};

std::vector<Loop> find_loops(const Drive& drive, const OdometryOptions& options, const Course& course, const Lengths& lengths,
                             const Tick& tick) {
  LoopFinder find(drive, options, course, lengths);
  std::vector<Loop> loops;
  EarlierPoses earlier_poses(course, lengths);
  double next = lengths.long_way;
  for (std::size_t i = 0; i < course.size(); ++i) {
    tick();
    if (course.way_m[i] < next) continue;
    const std::optional<std::size_t> earlier = earlier_poses.nearest_to(i);
    if (!earlier) continue;
    next = course.way_m[i] + lengths.every;
    if (std::optional<Loop> loop = find(*earlier, i)) loops.push_back(*loop);
  }
  return loops;
}

/// Information that is known no better than to these standard deviations.
Matrix6d no_better_than(const Matrix6d& information, double meters, double radians) {
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(meters * meters), Eigen::Vector3d::Constant(radians * radians);
  return (information.inverse() + variance.asDiagonal().toDenseMatrix()).inverse();
}

}  // namespace

std::vector<Loop> find_loops(const Drive& drive, const OdometryOptions& options, const Odometry& odometry, const Tick& tick) {
  const Lengths lengths = lengths_for(drive);
  return find_loops(drive, options, course_of(odometry, lengths), lengths, tick);
}

void close_loops(const Drive& drive, const OdometryOptions& options, Odometry& odometry, const Tick& tick) {
  const Lengths lengths = lengths_for(drive);
  const Course course = course_of(odometry, lengths);
  const std::vector<Loop> loops = find_loops(drive, options, course, lengths, tick);
  if (loops.empty()) return;
  std::vector<scan_match::PoseEdge> edges;
  for (std::size_t i = 1; i < course.size(); ++i) {
    const ScanFit& fit = odometry.scans[course.scan_index[i]];
    const bool lost = fit.state == ScanFit::State::lost;
    edges.push_back(
        {i - 1, i, course.pose[i - 1].inverse() * course.pose[i],
         no_better_than(fit.information, (lost ? kLostStep : kStep) * options.noise_m, lost ? kLostStepTurn : kStepTurn)});
  }
  for (const Loop& loop : loops)
    edges.push_back({loop.earlier, loop.later, loop.earlier_from_later,
                     no_better_than(loop.information, kLoop * options.noise_m, kLoopTurn), true});
  std::vector<SE3> poses = course.pose;
  const std::vector<double> weights = scan_match::solve_pose_graph(poses, edges);
  odometry.loops = static_cast<std::size_t>(std::count_if(weights.end() - static_cast<std::ptrdiff_t>(loops.size()),
                                                          weights.end(), [](double weight) { return weight > 0.25; }));
  if (odometry.loops == 0) return;
  std::vector<StampedPose> stamped = odometry.world_from_lidar.poses();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    odometry.largest_correction_m = std::max(odometry.largest_correction_m, (poses[i].t - course.pose[i].t).norm());
    stamped[i].world_from_body = poses[i];
  }
  odometry.world_from_lidar = Trajectory(std::move(stamped));
}

}  // namespace dvi::odometry
