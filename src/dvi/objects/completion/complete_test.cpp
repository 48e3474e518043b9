#include "dvi/objects/completion/complete.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <numeric>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/image/region.h"
#include "dvi/objects/completion/test_masked_drive.h"
#include "dvi/objects/draw_masks.h"
#include "dvi/objects/find_objects.h"
#include "dvi/objects/test_moving_cuboids.h"
#include "dvi/synth/scene.h"

namespace dvi::objects {
namespace {

using FrameMasks = std::vector<cv::Mat1b>;
using Frames = std::vector<std::size_t>;

// A synthetic street and the masks of its traffic, per frame.
struct MaskedStreet {
  Drive drive;         // without labels
  FrameMasks traffic;  // true, without shadows
  FrameMasks given;    // as mask files show it: with shadows, and enlarged

  explicit MaskedStreet(int frames) {
    synth::SynthOptions options;
    options.frames = frames;
    options.columns = 450;
    options.width = 160;
    options.height = 90;
    const auto scene = std::make_shared<const synth::Scene>(options);
    drive = synth::drive_of(scene);
    for (Frame& frame : drive.frames) frame.labels.clear();
    for (int i = 0; i < frames; ++i) {
      const synth::SynthFrame frame = scene->render(i);
      const auto& [image, clean, depth, depth_with_traffic, dynamic] = frame;
      traffic.emplace_back(depth_with_traffic != depth);
      given.push_back(scene->mask(frame));
    }
  }
};

FrameMasks draw_objects(const Situation& situation, const std::function<std::vector<Cuboid>(int)>& objects) {
  FrameMasks out;
  for (int i = 0; i < situation.scans; ++i) out.push_back(situation.draw_mask(i, objects(i)));
  return out;
}

// Clears the masks of some frames.
FrameMasks drop(const FrameMasks& masks, const Frames& frames) {
  FrameMasks out = masks;
  for (const std::size_t i : frames) out[i] = cv::Mat1b(masks[i].size(), uchar{0});
  return out;
}

// Returns the share of the true pixels of some frames that are drawn.
double compute_coverage(const FrameMasks& drawn, const FrameMasks& truth, const Frames& frames) {
  double covered = 0, all = 0;
  for (const std::size_t i : frames) {
    covered += cv::countNonZero(drawn[i] & truth[i]);
    all += cv::countNonZero(truth[i]);
  }
  return covered / all;
}

int count_pixels(const FrameMasks& masks) {
  return std::accumulate(masks.begin(), masks.end(), 0,
                         [](int sum, const cv::Mat1b& mask) { return sum + cv::countNonZero(mask); });
}

// Two cars that move in opposite directions, and the parked car. The sensor moves as well.
Situation make_two_cars() {
  return {.scans = 16,
          .sensor_x = [](int scan) { return 0.4 * scan; },
          .movers = [](int scan) { return std::vector<Cuboid>{car_at(16 + 0.8 * scan, -1.5), car_at(40 - 0.6 * scan, 2.5)}; }};
}

TEST(Completion, CoversTheTrafficInFramesWithoutMasks) {
  const MaskedStreet street(10);
  const Frames dropped{3, 6};
  const FrameMasks drawn = MaskedDrive(street.drive, drop(street.given, dropped)).complete();
  EXPECT_GE(compute_coverage(drawn, street.traffic, dropped), 0.97);
  for (const std::size_t i : dropped)
    EXPECT_LT(cv::countNonZero(drawn[i] & ~grown(street.given[i], 3)), cv::countNonZero(street.given[i]) / 10) << "frame " << i;
}

TEST(Completion, KeepsCorrectMasks) {
  const MaskedStreet street(10);
  EXPECT_EQ(count_pixels(MaskedDrive(street.drive, street.given).complete()), 0);
}

TEST(Completion, AddsLittleToMasksWithoutAMargin) {
  const Situation situation = make_two_cars();
  const FrameMasks truth = draw_objects(situation, situation.movers);
  EXPECT_LT(count_pixels(MaskedDrive(situation.drive(), truth).complete()), count_pixels(truth) / 25);
}

TEST(Completion, RemovesLittleIfTheMasksAreThoseOfOtherFrames) {
  constexpr std::ptrdiff_t kShift = 10;
  const MaskedStreet street(20);
  FrameMasks masks(20);
  std::copy(street.given.begin() + kShift, street.given.end(), masks.begin());
  const FrameMasks drawn = MaskedDrive(street.drive, masks).complete();
  // The masks cover 5 % of each image. Most static surfaces in them are visible outside of the masks in more frames.
  for (std::size_t i = 0; i < 20; ++i)
    EXPECT_LT(cv::countNonZero(drawn[i] & ~grown(street.given[i], 3)), 0.012 * static_cast<double>(drawn[i].total()))
        << "frame " << i;
}

TEST(Completion, CoversAMovingObjectBehindAMaskedOne) {
  // The car hides most of the van, whose roof the LiDAR observes above it. Both are in one part of the mask.
  const Situation situation{.scans = 20, .movers = [](int scan) {
                              const double x = 10 + 0.5 * scan;
                              return std::vector<Cuboid>{
                                  car_at(x, -1), {Eigen::Vector3d(x + 9, -2.4, 0.3), Eigen::Vector3d(x + 13, -0.2, 2.4)}};
                            }};
  const FrameMasks truth = draw_objects(situation, situation.movers);
  const FrameMasks drawn = MaskedDrive(situation.drive(), drop(truth, {8, 9})).complete();
  EXPECT_GE(compute_coverage(drawn, truth, {8, 9}), 0.97);
}

TEST(Completion, NeverDrawsObjectsThatNoMaskShows) {
  const Situation situation = make_two_cars();
  const FrameMasks truth = draw_objects(situation, [&](int scan) { return std::vector<Cuboid>{situation.movers(scan)[0]}; });
  const FrameMasks others =
      draw_objects(situation, [&](int scan) { return std::vector<Cuboid>{situation.movers(scan)[1], Situation::parked()}; });
  const Frames dropped{3, 4, 11, 12};
  const FrameMasks drawn = MaskedDrive(situation.drive(), drop(truth, dropped)).complete();
  EXPECT_GE(compute_coverage(drawn, truth, dropped), 0.97);
  for (std::size_t i = 0; i < drawn.size(); ++i)
    EXPECT_EQ(cv::countNonZero(drawn[i] & others[i] & ~grown(truth[i], 6)), 0) << "frame " << i;
}

TEST(Completion, CoversAParkedCarThatSomeMasksShow) {
  const Situation situation{
      .scans = 20, .sensor_x = [](int scan) { return 0.4 * scan; }, .movers = [](int) { return std::vector<Cuboid>(); }};
  const FrameMasks truth = draw_objects(situation, [](int) { return std::vector<Cuboid>{Situation::parked()}; });
  const Frames dropped{0, 1, 2, 3, 4, 5, 9, 14, 15, 16, 17, 18, 19};
  const FrameMasks drawn = MaskedDrive(situation.drive(), drop(truth, dropped)).complete();
  EXPECT_GE(compute_coverage(drawn, truth, dropped), 0.97);
  for (const std::size_t i : dropped)
    EXPECT_LT(cv::countNonZero(drawn[i] & ~grown(truth[i], 2)), cv::countNonZero(truth[i])) << "frame " << i;
}

TEST(Completion, AddsNothingInOtherFramesIfOneMaskCoversTheImage) {
  const Situation situation = make_two_cars();
  const FrameMasks truth = draw_objects(situation, situation.movers);
  FrameMasks masks = truth, alone(truth.size());
  masks[8] = alone[8] = cv::Mat1b(truth[8].size(), uchar{255});
  EXPECT_EQ(count_pixels(MaskedDrive(situation.drive(), alone).complete()), 0);
  EXPECT_LT(count_pixels(MaskedDrive(situation.drive(), masks).complete()), count_pixels(truth) / 25);
}

TEST(Completion, AddsNothingIfFewOfManyFramesMaskAWall) {
  const Situation situation{
      .scans = 20, .sensor_x = [](int scan) { return 0.3 * scan; }, .movers = [](int) { return std::vector<Cuboid>(); }};
  FrameMasks masks(20);
  for (const int i : {8, 9})
    masks[static_cast<std::size_t>(i)] = situation.draw_mask(i, {Situation::houses()[8], Situation::houses()[10]});
  ASSERT_GT(cv::countNonZero(masks[8]), 5000);
  EXPECT_EQ(count_pixels(MaskedDrive(situation.drive(), masks).complete()), 0);
}

TEST(Completion, AddsLittleToManySmallParts) {
  const Situation situation = make_two_cars();
  FrameMasks masks = draw_objects(situation, situation.movers);
  int parts = 0;
  for (int y = 1; y < masks[6].rows; y += 5)
    for (int x = 1; x < masks[6].cols; x += 5, ++parts) masks[6](y, x) = 255;
  ASSERT_GT(parts, 2000);
  EXPECT_LT(count_pixels(MaskedDrive(situation.drive(), masks).complete()), 500);
}

// Draws what find_objects() adds to the masks of one camera.
FrameMasks draw_completed(const Evidence& evidence, const RemovalOptions& options, std::size_t camera) {
  Progress progress(ProgressStyle::quiet);
  const Camera& lens = evidence[camera].drive.camera;
  const Objects objects = find_objects(evidence, options, progress);
  FrameMasks out;
  for (const std::vector<Label>& frame : *objects[camera].completed)
    out.push_back(draw_instances(frame, {lens.width, lens.height}));
  return out;
}

Lazy<cv::Mat1b> to_sequence(const FrameMasks& masks) {
  return {masks.size(), masks.size(), [masks](std::size_t i) { return masks[i]; }};
}

TEST(Completion, IsAnOptionAndNeedsPoses) {
  const Situation situation = make_two_cars();
  const FrameMasks truth = draw_objects(situation, situation.movers);
  Drive drive = situation.drive();
  drive.masks = to_sequence(drop(truth, {6, 7}));
  const Evidence evidence({{drive, drive.poses, "drive", {MaskSource::files}}});
  RemovalOptions options;
  EXPECT_GE(compute_coverage(draw_completed(evidence, options, 0), truth, {6, 7}), 0.97);
  const Trajectory none;
  EXPECT_EQ(count_pixels(draw_completed(Evidence({{drive, none, "drive", {MaskSource::files}}}), options, 0)), 0);
  options.objects.complete = false;
  EXPECT_EQ(count_pixels(draw_completed(evidence, options, 0)), 0);
}

TEST(Completion, CoversObjectsInASecondCameraWithoutMasks) {
  const Situation situation = make_two_cars();
  const FrameMasks truth = draw_objects(situation, situation.movers);
  Drive drive = situation.drive(), second = drive;
  drive.masks = to_sequence(truth);
  second.camera = {160, 96, 120, 120, 79.5, 40, {}};  // the same view at half the resolution
  second.masks = to_sequence(FrameMasks(truth.size(), cv::Mat1b(96, 160, uchar{0})));
  const Evidence evidence(
      {{drive, drive.poses, "drive", {MaskSource::files}},
       {.drive = second, .world_from_lidar = drive.poses, .name = "second", .sources = {MaskSource::files}, .rig_of = 0}});
  FrameMasks truth_in_second(truth.size());
  Frames all;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    cv::resize(truth[i], truth_in_second[i], {160, 96}, 0, 0, cv::INTER_AREA);
    truth_in_second[i] = truth_in_second[i] > 127;
    all.push_back(i);
  }
  EXPECT_GE(compute_coverage(draw_completed(evidence, {}, 1), truth_in_second, all), 0.97);
}

// Labels a cuboid that does not move in the frames of a drive from `first` on.
void add_boxes(const Cuboid& cuboid, std::size_t first, Drive& drive) {
  for (std::size_t i = first; i < drive.frames.size(); ++i) {
    Label label;
    label.track = 4;
    const SE3 world_from_box{Eigen::Matrix3d::Identity(), cuboid.center()};
    label.box = Box{drive.poses.at(drive.frames[i].time_ns)->inverse() * world_from_box, cuboid.sizes()};
    drive.frames[i].labels = {label};
  }
  drive.labeled = true;
}

TEST(Completion, KeepsATrunkInFrontOfALabeledCar) {
  const Cuboid trunk(Eigen::Vector3d(9, -3.2, 0), Eigen::Vector3d(9.6, -2.6, 5));
  const Situation situation{
      .scans = 20, .sensor_x = [](int scan) { return 0.05 * scan; }, .movers = [&](int) { return std::vector<Cuboid>{trunk}; }};
  Drive drive = situation.drive();
  add_boxes(Situation::parked(), 0, drive);
  const FrameMasks trunks = draw_objects(situation, [&](int) { return std::vector<Cuboid>{trunk}; }),
                   cars = draw_objects(situation, [](int) { return std::vector<Cuboid>{Situation::parked()}; });
  Progress progress(ProgressStyle::quiet);
  const Evidence evidence({{drive, drive.poses, "drive", {MaskSource::labels}}});
  const Masks masks = find_and_draw(evidence, {}, progress);
  for (const std::size_t i : {std::size_t{4}, std::size_t{10}, std::size_t{16}}) {
    const auto mask = masks.front().images[i];
    const cv::Mat1b inside = grown_far(trunks[i], -4);
    ASSERT_GT(cv::countNonZero(inside & grown(cars[i], 10)), 50);
    EXPECT_LT(cv::countNonZero(*mask & inside), 60) << "the lowest 0.2 m and a margin, frame " << i;
    EXPECT_EQ(cv::countNonZero(cars[i] & ~*mask & ~grown(trunks[i], 2)), 0) << "frame " << i;
  }
}

TEST(Completion, CoversALabeledParkedCarBeforeItsFirstLabelUnlessItIsHidden) {
  constexpr std::size_t kPasses = 3, kFirstLabel = 12;
  const Situation situation{.scans = 20, .movers = [](int scan) {
                              const Cuboid truck(Eigen::Vector3d(6, -4, 0), Eigen::Vector3d(9, -1, 3));
                              return static_cast<std::size_t>(scan) < kPasses ? std::vector<Cuboid>{truck}
                                                                              : std::vector<Cuboid>();
                            }};
  const FrameMasks truth = draw_objects(situation, [](int) { return std::vector<Cuboid>{Situation::parked()}; });
  Drive drive = situation.drive();
  add_boxes(Situation::parked(), kFirstLabel, drive);
  const FrameMasks drawn = draw_completed(Evidence({{drive, drive.poses, "drive", {MaskSource::labels}}}), {}, 0);
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    if (i < kPasses || i >= kFirstLabel)
      EXPECT_EQ(cv::countNonZero(drawn[i]), 0) << "frame " << i;
    else
      EXPECT_EQ(cv::countNonZero(truth[i] & ~drawn[i]), 0) << "frame " << i;
  }
}

}  // namespace
}  // namespace dvi::objects
