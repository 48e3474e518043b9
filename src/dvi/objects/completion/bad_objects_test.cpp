// Objects as wrong or unusual labels and masks describe them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "dvi/image/region.h"
#include "dvi/objects/completion/test_masked_drive.h"
#include "dvi/objects/find_objects.h"
#include "dvi/objects/test_moving_cuboids.h"

namespace dvi::objects {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Two parked cars, one behind the other, and a sensor that approaches them.
struct ParkedCars {
  static constexpr int kFrames = 16;
  Situation situation{.scans = kFrames,
                      .sensor_x = [](int scan) { return 0.3 * scan; },
                      .movers = [](int) { return std::vector<Cuboid>{second()}; }};
  Drive drive = situation.drive();

  static Cuboid first() { return Situation::parked(); }
  static Cuboid second() { return car_at(22, 3); }

  Label label(const Cuboid& world, int track, std::size_t frame) const {
    Label out;
    out.track = track;
    out.type = "car";
    const SE3 world_from_box{Eigen::Matrix3d::Identity(), world.center()};
    out.box = Box{drive.poses.at(drive.frames[frame].time_ns)->inverse() * world_from_box, world.sizes()};
    return out;
  }
  cv::Mat1b draw(const Cuboid& car, std::size_t frame) const { return situation.draw_mask(static_cast<int>(frame), {car}); }
};

struct Completed {
  std::vector<cv::Mat1b> masks;       // what completion adds, per frame
  std::vector<std::set<int>> tracks;  // and the numbers of its objects
  std::vector<std::set<int>> shown;   // and those of objects that the masks show
  std::vector<std::string> warnings;
};

Completed complete(Drive& drive, const FrameLabels& labels, const RemovalOptions& options = {}) {
  for (std::size_t i = 0; i < labels.size(); ++i) drive.frames[i].labels = labels[i];
  drive.labeled = true;
  Progress progress(ProgressStyle::quiet);
  const Objects objects = find_objects(Evidence({{drive, drive.poses, "drive", {MaskSource::labels}}}), options, progress);
  Completed out;
  for (const std::vector<Label>& frame : *objects[0].completed) {
    out.masks.push_back(draw_instances(frame, {drive.camera.width, drive.camera.height}));
    out.tracks.emplace_back();
    for (const Label& label : frame) EXPECT_TRUE(out.tracks.back().insert(label.track).second) << "drawn twice";
  }
  for (const std::vector<Label>& frame : *objects[0].shown) {
    out.shown.emplace_back();
    for (const Label& label : frame) out.shown.back().insert(label.track);
  }
  out.warnings = progress.warnings();
  return out;
}

double covered_share(const cv::Mat1b& drawn, const cv::Mat1b& truth) {
  return static_cast<double>(cv::countNonZero(drawn & truth)) / cv::countNonZero(truth);
}

TEST(BadObjects, OfOneFrameRemainInThatFrame) {
  ParkedCars cars;
  FrameLabels labels(ParkedCars::kFrames);
  labels[4] = {cars.label(ParkedCars::first(), 1, 4)};
  labels[9] = {cars.label(ParkedCars::second(), 2, 9)};
  const Completed completed = complete(cars.drive, labels);
  for (const cv::Mat1b& mask : completed.masks) EXPECT_EQ(cv::countNonZero(mask), 0);
  EXPECT_THAT(completed.warnings, IsEmpty());
}

TEST(BadObjects, WithSwappedTracksAreCompleted) {
  ParkedCars cars;
  FrameLabels labels(ParkedCars::kFrames);
  for (std::size_t i = 2; i < 14; ++i)
    if (i != 7)
      labels[i] = {cars.label(ParkedCars::first(), i % 2 == 0 ? 1 : 2, i),
                   cars.label(ParkedCars::second(), i % 2 == 0 ? 2 : 1, i)};
  const Completed completed = complete(cars.drive, labels);
  for (const std::size_t i : {0U, 7U, 15U})
    for (const Cuboid& car : {ParkedCars::first(), ParkedCars::second()})
      EXPECT_GE(covered_share(completed.masks[i], cars.draw(car, i)), 0.9) << "frame " << i;
}

TEST(BadObjects, WithOneTrackInCommonAreCompletedAndReported) {
  ParkedCars cars;
  FrameLabels labels(ParkedCars::kFrames);
  for (std::size_t i = 2; i < 14; ++i)
    if (i != 7) labels[i] = {cars.label(ParkedCars::first(), 5, i), cars.label(ParkedCars::second(), 5, i)};
  const Completed completed = complete(cars.drive, labels);
  for (const std::size_t i : {0U, 7U, 15U}) {
    cv::Mat1b truth(cars.draw(ParkedCars::first(), i) | cars.draw(ParkedCars::second(), i));
    EXPECT_GE(covered_share(completed.masks[i], truth), 0.9) << "frame " << i;
    EXPECT_EQ(cv::countNonZero(completed.masks[i] & ~grown(truth, 20)), 0) << "frame " << i;
  }
  EXPECT_THAT(completed.warnings, ElementsAre(AllOf(HasSubstr("track 5 in frame 2"), HasSubstr("several 3D boxes"))));
}

TEST(BadObjects, InThousandsOfTracksAreBounded) {
  constexpr int kTracks = 10'000;
  ParkedCars cars;
  FrameLabels labels(ParkedCars::kFrames);
  Random random(1);
  for (int k = 0; k < kTracks; ++k) {  // in the air, in the ground, behind houses; each in two frames
    const double x = random.uniform(-60, 60), y = random.uniform(-60, 60), z = random.uniform(-3, 12);
    const Eigen::Vector3d low(x, y, z);
    const Cuboid cuboid(low, low + Eigen::Vector3d::Constant(random.uniform(0.2, 2)));
    for (const std::size_t i : {std::size_t{5}, std::size_t{11}})
      if (k % 2 == 0 || i == 5) labels[i].push_back(cars.label(cuboid, k, i));
  }
  for (std::size_t i = 2; i < 14; ++i) labels[i].push_back(cars.label(ParkedCars::first(), kTracks, i));
  const Completed completed = complete(cars.drive, labels);
  for (const std::size_t i : {0U, 15U})
    EXPECT_TRUE(completed.tracks[i].contains(kTracks) || completed.shown[i].contains(kTracks)) << "frame " << i;
  for (const std::set<int>& tracks : completed.tracks) EXPECT_LE(tracks.size(), 1U + kTracks);
  EXPECT_THAT(completed.warnings, IsEmpty());
}

TEST(BadObjects, InOneTrackForThousandsOfLabelsAreReported) {
  ParkedCars cars;
  FrameLabels labels(ParkedCars::kFrames);
  Random random(2);
  for (std::size_t i = 0; i < labels.size(); ++i)
    for (int k = 0; k < 600; ++k)
      labels[i].push_back(cars.label(car_at(random.uniform(-60, 60), random.uniform(-60, 60)), 0, i));
  const Completed completed = complete(cars.drive, labels);
  for (const std::set<int>& tracks : completed.tracks) EXPECT_LE(tracks.size(), 600U);
  EXPECT_THAT(completed.warnings, ElementsAre(HasSubstr("1 of the labeled tracks have several 3D boxes in one frame")));
}

TEST(BadObjects, AreNotCompletedWithoutPosesOrScansWithAWarning) {
  ParkedCars cars;
  FrameLabels labels(ParkedCars::kFrames);
  for (std::size_t i = 2; i < 14; ++i) labels[i] = {cars.label(ParkedCars::first(), 1, i)};
  Drive unposed = cars.drive, unscanned = cars.drive, unlabeled = cars.drive;
  unposed.poses = {};
  EXPECT_THAT(complete(unposed, labels).warnings,
              ElementsAre(AllOf(HasSubstr("drive: without poses, an object is not removed"), HasSubstr("give --poses FILE"))));
  unscanned.scan_headers.clear();
  unscanned.scans = {};
  EXPECT_THAT(complete(unscanned, labels).warnings, ElementsAre(HasSubstr("without scans, an object is not removed")));
  RemovalOptions as_given;
  as_given.objects.complete = false;
  EXPECT_THAT(complete(unscanned, labels, as_given).warnings, IsEmpty());
  unlabeled.poses = {};
  for (const std::string& warning : complete(unlabeled, FrameLabels(ParkedCars::kFrames)).warnings)
    EXPECT_THAT(warning, testing::Not(HasSubstr("without poses")));
}

}  // namespace
}  // namespace dvi::objects
