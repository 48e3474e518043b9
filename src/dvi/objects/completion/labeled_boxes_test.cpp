#include "dvi/objects/completion/labeled_boxes.h"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "dvi/objects/test_moving_cuboids.h"

namespace dvi::objects {
namespace {

Box to_box(const Cuboid& cuboid) { return {{Eigen::Matrix3d::Identity(), cuboid.center()}, cuboid.sizes()}; }

// A drive at 10 m/s with 40 frames, and labels at positions in the world.
struct LabeledDrive {
  Drive drive;
  FrameLabels labels{40};

  LabeledDrive() {
    std::vector<StampedPose> poses;
    for (int i = 0; i < 40; ++i) {
      poses.push_back({i * PlainDrive::kScanPeriodNs, {Eigen::Matrix3d::Identity(), {1.0 * i, 0, 1.7}}});
      drive.frames.push_back({i, "", i * PlainDrive::kScanPeriodNs, {}, {}});
    }
    drive.poses = Trajectory(poses);
  }

  void add(int frame, int track, double x, double y) {
    Label label;
    label.track = track;
    label.type = "car";
    const Box world = to_box(car_at(x, y));
    label.box = Box{drive.poses.at(frame * PlainDrive::kScanPeriodNs)->inverse() * world.frame_from_box, world.size};
    labels[static_cast<std::size_t>(frame)].push_back(label);
  }

  std::vector<LabeledBoxes> collect() const { return LabeledBoxes::collect(drive, labels, drive.poses); }
};

// Returns the x coordinate of the rear of a car in the world; nothing if it has no box at that time.
std::optional<double> find_rear_m(const LabeledBoxes& object, double frame) {
  const std::optional<Box> box = object.at(std::llround(frame * static_cast<double>(PlainDrive::kScanPeriodNs)));
  if (!box) return std::nullopt;
  return box->frame_from_box.t.x() - 0.5 * box->size.x();
}

TEST(LabeledBoxes, OfStationaryObjectsAreKnownForTheWholeDrive) {
  LabeledDrive labeled;
  for (int i = 20; i < 26; ++i) labeled.add(i, 3, 30, 4);
  const std::vector<LabeledBoxes> objects = labeled.collect();
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_EQ(objects[0].track(), 3);
  EXPECT_EQ(objects[0].type(), "car");
  for (const double frame : {-1.0, 0.0, 19.0, 20.0, 22.5, 39.0}) {
    ASSERT_TRUE(find_rear_m(objects[0], frame)) << frame;
    EXPECT_NEAR(*find_rear_m(objects[0], frame), 30, 1e-9) << frame;
  }
}

TEST(LabeledBoxes, OfStationaryObjectsAreThoseNearestInTime) {
  LabeledDrive labeled;
  for (int i = 10; i < 20; ++i) labeled.add(i, 3, i < 15 ? 30 : 30.1, 4);
  labeled.labels[13].clear();
  labeled.labels[14].clear();
  labeled.labels[15].clear();
  const std::vector<LabeledBoxes> objects = labeled.collect();
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_NEAR(*find_rear_m(objects[0], 13), 30, 1e-9);
  EXPECT_NEAR(*find_rear_m(objects[0], 15), 30.1, 1e-9);
}

TEST(LabeledBoxes, OfMovingObjectsAreInterpolatedWithinASecond) {
  LabeledDrive labeled;
  for (const int i : {2, 3, 4, 14, 15, 26, 27}) labeled.add(i, 8, 20 + i, -1);
  const std::vector<LabeledBoxes> objects = labeled.collect();
  ASSERT_EQ(objects.size(), 1U);
  for (const double frame : {2.0, 3.5, 4.0, 6.3, 9.0, 14.5, 26.5, 27.0}) {
    ASSERT_TRUE(find_rear_m(objects[0], frame)) << frame;
    EXPECT_NEAR(*find_rear_m(objects[0], frame), 20 + frame, 1e-6) << frame;
  }
  for (const double frame : {0.0, 1.9, 16.0, 20.0, 25.9, 27.1, 39.0}) EXPECT_FALSE(find_rear_m(objects[0], frame)) << frame;
}

TEST(LabeledBoxes, NeedTwoFramesWithABoxATrackAndAPose) {
  LabeledDrive labeled;
  labeled.add(5, 1, 30, 4);
  for (int i = 5; i < 9; ++i) labeled.add(i, -1, 40, 4);
  for (int i = 5; i < 9; ++i) {
    labeled.add(i, 2, 50, 4);
    labeled.labels[static_cast<std::size_t>(i)].back().box.reset();
  }
  EXPECT_TRUE(labeled.collect().empty());
  labeled.add(6, 1, 30, 4);
  EXPECT_EQ(labeled.collect().size(), 1U);
  EXPECT_TRUE(LabeledBoxes::collect(labeled.drive, labeled.labels, Trajectory()).empty());
}

// Measures the street with movers from the origin.
FreeSpace measure_free_space(const std::vector<Cuboid>& movers) {
  const Situation situation{.scans = 2, .movers = [&](int) { return movers; }};
  const Drive drive = situation.drive();
  return {*drive.scans[0], drive.scan_headers[0], drive.poses, 0.05};
}

TEST(BoxesInScans, AreAbsentWhereRaysPass) {
  const FreeSpace scan = measure_free_space({car_at(20, 1)});
  EXPECT_TRUE(is_absent_or_hidden(to_box(car_at(20, -2.5)), scan));
  EXPECT_TRUE(is_absent_or_hidden(to_box(car_at(35, -3)), scan));
  EXPECT_FALSE(is_absent_or_hidden(to_box(car_at(20, 1)), scan));
  EXPECT_FALSE(is_absent_or_hidden(to_box(Situation::parked()), scan));
}

TEST(BoxesInScans, ToleratesErrorsOfBoxes) {
  const FreeSpace scan = measure_free_space({car_at(20, 1)});
  for (const Eigen::Vector2d& error : {Eigen::Vector2d(0.3, 0), Eigen::Vector2d(-0.3, 0), Eigen::Vector2d(0, 0.3)})
    EXPECT_FALSE(is_absent_or_hidden(to_box(car_at(20 + error.x(), 1 + error.y())), scan)) << error.transpose();
}

TEST(BoxesInScans, AreHiddenBehindSurfaces) {
  const Cuboid truck(Eigen::Vector3d(10, -2, 0.2), Eigen::Vector3d(16, 2, 4));
  const FreeSpace scan = measure_free_space({truck, car_at(25, -0.9)});
  EXPECT_TRUE(is_absent_or_hidden(to_box(car_at(25, -0.9)), scan)) << "behind the truck";
  EXPECT_TRUE(is_absent_or_hidden(to_box(car_at(22, 16)), scan)) << "behind a house";
  EXPECT_FALSE(is_absent_or_hidden(to_box(truck), scan));
}

TEST(BoxesInScans, AreUnknownOutsideTheRangeOrWithoutAScan) {
  EXPECT_FALSE(is_absent_or_hidden(to_box(car_at(120, 0)), measure_free_space({})));
  EXPECT_FALSE(is_absent_or_hidden(to_box(car_at(20, 0)), FreeSpace()));
}

TEST(BoxesInScans, ExcludeThePathBetweenObjectsOfOneTrackNumber) {
  LabeledDrive labeled;
  for (int i = 0; i < 5; ++i) labeled.add(i, 1, 14, -5.5);  // the parked car
  for (int i = 12; i < 17; ++i) labeled.add(i, 1, 40, 2);   // another object with the same number
  const std::vector<LabeledBoxes> objects = labeled.collect();
  ASSERT_EQ(objects.size(), 1U);
  const FreeSpace scan = measure_free_space({car_at(40, 2)});
  for (const int frame : {6, 8, 10}) {
    const std::optional<Box> box = objects[0].at(frame * PlainDrive::kScanPeriodNs);
    ASSERT_TRUE(box) << frame;
    EXPECT_TRUE(is_absent_or_hidden(*box, scan)) << frame;
  }
}

TEST(LabeledBoxes, OfObjectsThatStayInPlaceHaveAMedian) {
  LabeledDrive labeled;
  for (int i = 10; i < 15; ++i) {
    labeled.add(i, 1, i == 12 ? 30.3 : 30 + 0.01 * i, 4);
    labeled.add(i, 2, 30 + i, -4);
    if (i < 13) labeled.add(i, 3, 50, 4);
  }
  const std::vector<LabeledBoxes> objects = labeled.collect();
  ASSERT_EQ(objects.size(), 3U);
  const std::optional<Box> box = objects[0].find_stationary_box();
  ASSERT_TRUE(box);
  EXPECT_NEAR(box->frame_from_box.t.x() - 0.5 * box->size.x(), 30.13, 1e-9);
  EXPECT_FALSE(objects[1].find_stationary_box()) << "moves";
  EXPECT_FALSE(objects[2].find_stationary_box()) << "three boxes";
}

TEST(LabeledBoxes, LeaveOutTracksThatOccurTwiceInAFrame) {
  LabeledDrive labeled;
  for (int i = 10; i < 15; ++i) {
    labeled.add(i, 1, 30, 4);
    labeled.add(i, 2, 40, 4);
  }
  labeled.add(12, 1, 50, 4);
  labeled.add(14, 1, 50, 4);
  const std::vector<LabeledBoxes> objects = labeled.collect();
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_EQ(objects[0].track(), 2);
  EXPECT_EQ(find_repeated_tracks(labeled.labels), (std::map<int, std::size_t>{{1, 12}}));
}

}  // namespace
}  // namespace dvi::objects
