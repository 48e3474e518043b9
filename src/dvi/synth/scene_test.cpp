#include "dvi/synth/scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/core/threads.h"
#include "dvi/image/interpolate.h"
#include "dvi/synth/models.h"
#include "dvi/synth/street.h"

namespace dvi::synth {
namespace {

SynthOptions small() {
  SynthOptions options;
  options.frames = 10;
  options.width = 320;
  options.height = 180;
  options.beams = 16;
  options.columns = 900;
  options.image_noise = 0;
  return options;
}

// The scene is built once for most tests.
const std::shared_ptr<const Scene>& small_scene() {
  static const auto scene = std::make_shared<const Scene>(small());
  return scene;
}

double mean_difference(const cv::Mat3b& a, const cv::Mat3b& b) {
  return cv::norm(a, b, cv::NORM_L1) / (3.0 * static_cast<double>(a.total()));
}

TEST(Street, LocateInvertsPointOnStraightsAndArc) {
  for (const double turn : {0.0, 0.9, -1.2}) {
    const Street street(12, 40, turn);
    for (double s = -30; s < 120; s += 3.7)
      for (const double d : {-12.0, -2.0, 0.0, 5.0, 9.0})
        EXPECT_LT((street.locate(street.point(s, d)) - Eigen::Vector2d(s, d)).norm(), 1e-9) << turn << " " << s << " " << d;
  }
}

TEST(Scene, IsIndependentOfTheThreads) {
  SynthFrame frames[2];
  SynthScan scans[2];
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    const Scene scene(small());
    frames[threads - 1] = scene.render(3);
    scans[threads - 1] = scene.scan(3);
  }
  EXPECT_EQ(cv::norm(frames[0].image, frames[1].image, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(frames[0].depth, frames[1].depth, cv::NORM_INF), 0);
  EXPECT_EQ(scans[0].scan.points, scans[1].scan.points);
  EXPECT_EQ(scans[0].scan.intensity, scans[1].scan.intensity);
}

struct CameraFrame {
  int frame;
  std::size_t camera = 0;
};

// Expects that static pixels of a frame are found by depth and poses in another one that observes the same points.
void expect_reprojects(const Scene& scene, const CameraFrame& from, const CameraFrame& to, int at_least = 25000) {
  const SynthFrame a = scene.render(from.frame, from.camera), b = scene.render(to.frame, to.camera);
  const SE3 b_from_a =
      scene.camera_from_world(to.frame, to.camera) * scene.camera_from_world(from.frame, from.camera).inverse();
  const double gain = scene.gain(from.frame, from.camera) / scene.gain(to.frame, to.camera);
  double error = 0, shifted = 0;
  int count = 0;
  for (int y = 0; y < a.depth.rows; ++y)
    for (int x = 0; x < a.depth.cols; ++x) {
      if (a.depth(y, x) == 0) continue;
      const Eigen::Vector3d p = b_from_a * (scene.camera().ray({x, y}) * a.depth(y, x));
      const Eigen::Vector2d q = scene.camera().project(p);
      if (p.z() < 1 || !scene.camera().contains(q + Eigen::Vector2d(2, 0)) || !scene.camera().contains(q)) continue;
      const cv::Point at(static_cast<int>(std::lround(q.x())), static_cast<int>(std::lround(q.y())));
      if (std::abs(b.depth(at) - p.z()) > 0.02 * p.z()) continue;  // hidden
      const auto difference = [&](double off) {
        const cv::Vec3f there = bilinear(b.clean, {static_cast<float>(q.x() + off), static_cast<float>(q.y())});
        return std::abs(there[1] * gain - a.clean(y, x)[1]);
      };
      error += difference(0);
      shifted += difference(2);
      ++count;
    }
  ASSERT_GT(count, at_least);
  EXPECT_LT(error / count, 7);
  EXPECT_GT(shifted / count, 1.6 * error / count);
}

TEST(Scene, ReprojectsColorsByDepthAndPoses) { expect_reprojects(*small_scene(), {1}, {3}); }

TEST(Scene, ReprojectsColorsInATurnWithJitterAndDrift) {
  SynthOptions options = small();
  options.turn_deg = 25;
  options.jitter_deg = 0.5;
  options.exposure_drift = 0.12;
  expect_reprojects(Scene(options), {4}, {6});
}

TEST(Scene, ShowsTheSameStreetInSideCameras) {
  SynthOptions options = small();
  options.side_cameras = true;
  options.jitter_deg = 0.5;
  const Scene scene(options);
  ASSERT_EQ(scene.cameras().size(), 3U);
  const auto looks = [&](std::size_t camera) { return Eigen::Vector3d(scene.cameras()[camera].camera_from_lidar.R.row(2)); };
  EXPECT_GT(looks(1).y(), 0.8) << "to the left";
  EXPECT_LT(looks(2).y(), -0.8) << "to the right";
  // A side camera observes the surfaces that the front camera observed some frames before.
  expect_reprojects(scene, {0}, {8, 1}, 800);
  expect_reprojects(scene, {0}, {8, 2}, 800);
  expect_reprojects(scene, {4, 1}, {5, 1});
}

TEST(Scene, KeepsTheRestForWetRoadsAndChanges) {
  const cv::Mat3b dry = small_scene()->render(0).clean;
  const cv::Rect road(0, 130, 320, 50), sky(130, 0, 60, 40);
  SynthOptions options = small();
  options.wet = true;
  const cv::Mat3b wet = Scene(options).render(0).clean;
  EXPECT_LT(cv::mean(wet(road))[1], 0.75 * cv::mean(dry(road))[1]);
  EXPECT_EQ(mean_difference(wet(sky), dry(sky)), 0);
  options.wet = false;
  options.changes = true;
  const cv::Mat3b changed = Scene(options).render(0).clean;
  EXPECT_GT(mean_difference(changed, dry), 2);
  EXPECT_LT(mean_difference(changed(road), dry(road)), 1) << "except for the building site";
}

TEST(Scene, HasWalkersOnTheGroundWithMovingLegs) {
  const std::vector<Model> gait = make_walker(Random(1), Noise(1));
  ASSERT_EQ(gait.size(), static_cast<std::size_t>(kGaitPhases));
  double longest = 0, shortest = 9;
  for (const Model& model : gait) {
    EXPECT_NEAR(model.solid.low().z(), 0, 0.02);
    EXPECT_LE(model.solid.high().z(), model.size.z() + 0.02);
    EXPECT_LE(std::max(model.solid.high().x(), -model.solid.low().x()), 0.5 * model.size.x() + 0.02);
    const double step = model.solid.high().x() - model.solid.low().x();
    longest = std::max(longest, step);
    shortest = std::min(shortest, step);
  }
  EXPECT_GT(longest, 0.6);
  EXPECT_LT(shortest, 0.5);
}

TEST(Scene, HasWalkersWithShadows) {
  SynthOptions options = small();
  options.walker = true;
  const Scene scene(options);
  const SynthFrame frame = scene.render(9);
  const std::vector<Label> labels = scene.boxes(9);
  // The shadow falls on the ground beside the box, where pixels change without a person.
  int beside = 0;
  for (int y = 0; y < frame.dynamic.rows; ++y)
    for (int x = 0; x < frame.dynamic.cols; ++x) {
      if (frame.dynamic(y, x) == 0 || frame.seen(y, x) != frame.depth(y, x) || frame.depth(y, x) == 0) continue;
      const Eigen::Vector3d ground = scene.cameras()[0].camera_from_lidar.inverse() *
                                     (scene.camera().ray({x, y}) * static_cast<double>(frame.depth(y, x)));
      for (const Label& label : labels) {
        const Eigen::Vector3d in_box = label.box->frame_from_box.inverse() * ground;
        const double outside = (in_box.head<2>().cwiseAbs() - 0.5 * label.box->size.head<2>()).maxCoeff();
        if (label.type == "pedestrian" && outside > 0.45 && in_box.head<2>().norm() < 2) ++beside;
      }
    }
  EXPECT_GT(beside, 5);
}

SynthOptions small_room() {
  SynthOptions options = small();
  options.room = true;
  return options;
}

TEST(Scene, HasAClosedRoomThatReprojects) {
  const Scene scene(small_room());
  EXPECT_EQ(scene.cameras().front().name, "color");
  EXPECT_EQ(cv::countNonZero(scene.render(3).depth == 0), 0);
  expect_reprojects(scene, {1}, {8});
}

TEST(Scene, HasADepthCameraThatMeasuresVisibleSurfaces) {
  SynthOptions options = small_room();
  const Scene noisy(options);
  options.range_noise = 0;
  const Scene exact(options);
  const SynthFrame frame = exact.render(5);
  EXPECT_GT(cv::countNonZero(frame.seen < frame.depth), 500) << "the person";
  const cv::Mat1w depth = exact.depth_image(5, frame), measured = noisy.depth_image(5, frame);
  double squares = 0, expected = 0;
  int missing = 0;
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x) {
      ASSERT_NEAR(depth(y, x), 1000 * frame.seen(y, x), 0.51);
      if (measured(y, x) == 0) {
        ++missing;
        continue;
      }
      squares += std::pow(0.001 * measured(y, x) - frame.seen(y, x), 2);
      expected += std::pow(0.02 * std::pow(frame.seen(y, x) / 5, 2), 2);
    }
  EXPECT_GT(missing, 500) << "beside jumps";
  EXPECT_LT(missing, depth.size().area() / 10);
  EXPECT_NEAR(squares / expected, 1, 0.05);
}

TEST(Scene, HasNoStreetInARoom) {
  SynthOptions options = small_room();
  options.truck = true;
  EXPECT_THROW(Scene{options}, UsageError);
}

TEST(Scene, HasScansOnTheDepthSurface) {
  SynthOptions options = small();
  options.speed_mps = 0;
  options.range_noise = 0;
  const Scene scene(options);
  const cv::Mat1f depth = scene.render(2).depth;
  const SynthScan scan = scene.scan(2);
  std::vector<double> errors;
  for (std::size_t i = 0; i < scan.scan.size(); ++i) {
    // The pose is that of the firing, since the car sways.
    const SE3 world_from_lidar = scene.world_from_lidar(scene.time_ns(2) + std::llround(1e9 * scan.scan.time[i]));
    const Eigen::Vector3d p = scene.camera_from_world(2) * (world_from_lidar * scan.scan.points[i].cast<double>());
    if (scan.dynamic[i] || p.z() < 1 || !scene.camera().contains(scene.camera().project(p))) continue;
    const Eigen::Vector2d q = scene.camera().project(p);
    const cv::Point at(static_cast<int>(std::lround(q.x())), static_cast<int>(std::lround(q.y())));
    errors.push_back(std::abs(depth(at) - p.z()) / p.z());
  }
  ASSERT_GT(errors.size(), 1000U);
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.005);
  EXPECT_LT(errors[errors.size() * 9 / 10], 0.05);
}

TEST(Scene, HasFiringsClockwiseFromBehindWithinThePeriod) {
  const SynthScan scan = small_scene()->scan(0);
  ASSERT_GT(scan.scan.size(), 10000U);
  for (std::size_t i = 0; i < scan.scan.size(); i += 97) {
    const double azimuth = std::atan2(scan.scan.points[i].y(), scan.scan.points[i].x());
    const double share = (std::numbers::pi - azimuth) / (2 * std::numbers::pi);
    const double off = scan.scan.time[i] - (share - 0.5) * 0.1;
    EXPECT_NEAR(off - 0.1 * std::round(off / 0.1), 0, 1e-6);
    EXPECT_LE(scan.range[i], 120);
  }
}

TEST(Scene, HasMasksThatCoverThePixelsChangedByTraffic) {
  const Scene& scene = *small_scene();
  for (const int frame : {0, 9}) {
    const SynthFrame rendered = scene.render(frame);
    const cv::Mat1b mask = scene.mask(rendered);
    int changed = 0;
    for (int y = 0; y < mask.rows; ++y)
      for (int x = 0; x < mask.cols; ++x)
        if (rendered.image(y, x) != rendered.clean(y, x)) {
          ++changed;
          ASSERT_EQ(mask(y, x), 255);
        }
    EXPECT_GT(changed, 500);
    EXPECT_LT(cv::countNonZero(mask), static_cast<int>(mask.total()) / 4);
  }
}

TEST(Scene, HasBoxesAroundTheDynamicPoints) {
  const Scene& scene = *small_scene();
  const SynthScan scan = scene.scan(4);
  const std::vector<Label> labels = scene.boxes(4);
  std::vector<std::string> types;
  for (const Label& label : labels) types.push_back(label.type);
  EXPECT_GT(std::count(types.begin(), types.end(), "car"), 1);
  EXPECT_EQ(std::count(types.begin(), types.end(), "pedestrian"), 1);
  int dynamic = 0;
  for (std::size_t i = 0; i < scan.scan.size(); ++i) {
    // Points ahead are measured near the time of the image. They are compensated for the vehicle's motion, but not for that of
    // the traffic.
    const std::int64_t time = scene.time_ns(4);
    const Eigen::Vector3d world =
        scene.world_from_lidar(time + std::llround(1e9 * scan.scan.time[i])) * scan.scan.points[i].cast<double>();
    const Eigen::Vector3d now = scene.world_from_lidar(time).inverse() * world;
    const bool inside = std::any_of(labels.begin(), labels.end(), [&](const Label& l) { return l.box->contains(now, 0.6); });
    if (scan.dynamic[i]) {
      ++dynamic;
      EXPECT_TRUE(inside);
    }
  }
  EXPECT_GT(dynamic, 50);
}

TEST(Scene, HasTheDriftAndJitterOfTheOptions) {
  SynthOptions options = small();
  options.exposure_drift = 0.12;
  options.jitter_deg = 0.4;
  const Scene scene(options);
  EXPECT_NEAR(scene.gain(0), 0.88, 1e-12);
  EXPECT_NEAR(scene.gain(9), 1.12, 1e-12);
  double largest = 0;
  for (int i = 0; i < 10; ++i) {
    const SE3 nominal = scene.cameras().front().camera_from_lidar * scene.world_from_lidar(scene.time_ns(i)).inverse();
    const SE3 jitter = scene.camera_from_world(i) * nominal.inverse();
    const Eigen::Vector3d turn = so3_log(jitter.R) * 180 / std::numbers::pi;
    EXPECT_LT(jitter.t.norm(), 1e-9);
    EXPECT_LT(turn.head<2>().cwiseAbs().maxCoeff(), 0.401);
    EXPECT_NEAR(turn.z(), 0, 0.01);
    largest = std::max(largest, turn.norm());
  }
  EXPECT_GT(largest, 0.1);
}

TEST(Scene, HasATruckAheadAndTheSameStreetOnTheSecondDay) {
  SynthOptions options = small();
  options.truck = true;
  const Scene scene(options);
  for (const int frame : {0, 9}) {
    const std::vector<Label> labels = scene.boxes(frame);
    const auto truck = std::find_if(labels.begin(), labels.end(), [](const Label& l) { return l.type == "truck"; });
    ASSERT_NE(truck, labels.end());
    EXPECT_NEAR(truck->box->frame_from_box.t.x(), 13.5, 0.2);
  }
  SynthOptions second = small();
  second.day = 2;
  const Scene other(second);
  const Scene& first = *small_scene();
  const double apart = (other.world_from_lidar(other.time_ns(0)).t - first.world_from_lidar(first.time_ns(0)).t).norm();
  EXPECT_GT(apart, 3);
  EXPECT_LT(apart, 4.5);
  EXPECT_GT(mean_difference(other.render(0).clean, first.render(0).clean), 10);
}

// Both drives share one world: a point observed by both has the same position.
TEST(Scene, ReturnsAlongTheSameStreetInReverse) {
  for (const double turn : {0.0, 40.0}) {
    SynthOptions options = small();
    options.frames = 30;
    options.turn_deg = turn;
    const Scene forth(options);
    options.reverse = true;
    const Scene back(options);
    const auto ahead = [](const Scene& scene, int frame) {
      return Eigen::Vector3d(scene.world_from_lidar(scene.time_ns(frame)).R.col(0));
    };
    EXPECT_LT(ahead(forth, 29).dot(ahead(back, 0)), -0.97) << turn;
    // Roofs and walls far from traffic that one drive scanned lie on surfaces that the other one scanned.
    const auto points = [](const Scene& scene, int frame) {
      const SynthScan scan = scene.scan(frame);
      std::vector<Eigen::Vector3d> out;
      for (std::size_t i = 0; i < scan.scan.size(); ++i)
        if (scan.dynamic[i] == 0)
          out.push_back(scene.world_from_lidar(scene.time_ns(frame) + std::llround(1e9 * scan.scan.time[i])) *
                        scan.scan.points[i].cast<double>());
      return out;
    };
    const std::vector<Eigen::Vector3d> a = points(forth, 29), b = points(back, 12);
    std::vector<double> nearest;
    for (std::size_t i = 0; i < a.size(); i += 37) {
      if (a[i].z() < 1.5 || a[i].z() > 3 || (a[i] - forth.world_from_lidar(forth.time_ns(29)).t).norm() > 15) continue;
      double best = 1e9;
      for (const Eigen::Vector3d& p : b) best = std::min(best, (p - a[i]).norm());
      nearest.push_back(best);
    }
    ASSERT_GT(nearest.size(), 20U);
    std::nth_element(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2), nearest.end());
    EXPECT_LT(nearest[nearest.size() / 2], 0.35) << turn;
  }
}

TEST(Scene, HasDifferentParkedCarsOnEachDay) {
  SynthOptions options = small();
  options.truck = true;
  std::vector<cv::Mat3b> days;
  for (int day = 1; day <= 5; ++day) {
    options.day = day;
    days.push_back(Scene(options).render(0).clean);
    for (std::size_t i = 0; i + 1 < days.size(); ++i)
      EXPECT_GT(mean_difference(days.back(), days[i]), 5) << i + 1 << " " << day;
  }
}

TEST(Scene, HasACompleteAndConsistentDriveInMemory) {
  const auto& scene = small_scene();
  const Drive drive = drive_of(scene);
  const Views views = views_of(scene);
  ASSERT_EQ(drive.frames.size(), 10U);
  ASSERT_EQ(views.size(), 10U);
  EXPECT_EQ(drive.images.size(), drive.masks.size());
  EXPECT_EQ(drive.scans[1]->size(), scene->scan(1).scan.size());
  EXPECT_EQ(cv::norm(*drive.images[2], scene->render(2).image, cv::NORM_INF), 0);
  EXPECT_LT((drive.poses.at(drive.frames[5].time_ns)->t - scene->world_from_lidar(scene->time_ns(5)).t).norm(), 1e-9);
}

}  // namespace
}  // namespace dvi::synth
