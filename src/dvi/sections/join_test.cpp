#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

#include "dvi/core/error.h"
#include "dvi/inputs/make_views.h"
#include "dvi/sections/join_map.h"
#include "dvi/sections/join_objects.h"
#include "dvi/sections/join_poses.h"
#include "dvi/sections/join_views.h"

namespace dvi::sections {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t kStepNs = 100'000'000;

/// The true pose of the LiDAR at a frame: a path in a wide bend.
SE3 true_pose(int frame) {
  const double angle = 0.01 * frame;
  return {so3_exp({0, 0, angle}), {100 * std::sin(angle), 100 * (1 - std::cos(angle)), 0}};
}

Drive make_recording(int first, int last) {
  Drive drive;
  drive.path = "/drive";
  drive.camera_name = "front";
  for (int i = first; i <= last; ++i) {
    Frame frame;
    frame.number = i;
    frame.name = std::to_string(i);
    frame.time_ns = kStepNs * i;
    drive.frames.push_back(frame);
    drive.scan_headers.push_back({frame.name, frame.time_ns, frame.time_ns, frame.time_ns, {}});
  }
  drive.camera.width = 100, drive.camera.height = 50;
  return drive;
}

/// The poses of scans in the world of the first of them, as of a drive that begins there.
Trajectory poses_from(const Drive& drive) {
  std::vector<StampedPose> poses;
  for (const Frame& frame : drive.frames)
    poses.push_back({frame.time_ns, true_pose(drive.frames.front().number).inverse() * true_pose(frame.number)});
  return Trajectory(poses);
}

/// A drive of 40 frames in two sections that overlap by ten frames on each side.
class Join : public testing::Test {
 protected:
  Join() {
    drives.push_back({make_recording(0, 39)});
    for (const Section& section : cut) {
      PlannedSection planned;
      planned.section = section;
      planned.drives.push_back({make_recording(section.read.first, section.read.last)});
      planned.poses.push_back({{}, poses_from(planned.target())});
      sections.push_back(std::move(planned));
    }
    make_views();
    for (PlannedSection& section : sections)
      section.objects = objects::CameraObjects(shared(FrameLabels(section.target().frames.size())));
  }

  void make_views() {
    for (PlannedSection& section : sections) {
      section.views = inputs::make_views({section.drives, section.poses, {}}, silent);
      section.gains = exposure::Gains(section.views.size());
      section.cameras = align::Cameras(section.views);
    }
  }
  inputs::Poses join() { return join_poses(sections, drives, borders, progress); }
  Views joint_views(const inputs::Poses& poses) { return inputs::make_views({drives, poses, {}}, silent); }

  /// Adds a label to a frame of a section.
  void add_label(std::size_t section, int frame, Label label) {
    PlannedSection& to = sections[section];
    FrameLabels labels = *to.objects.labels;
    labels[static_cast<std::size_t>(frame - to.section.read.first)].push_back(std::move(label));
    to.objects.labels = shared(labels);
  }

  const std::vector<Section> cut{{1, 2, {0, 19}, {0, 29}}, {2, 2, {20, 39}, {10, 39}}};
  inputs::Recordings drives;
  std::vector<PlannedSection> sections;
  Progress silent{ProgressStyle::quiet}, progress{ProgressStyle::quiet};
  const std::vector<Border> borders = find_borders(make_recording(0, 39), cut);
};

Label make_label(int track, double x_m) {
  Label label;
  label.track = track;
  label.type = "car";
  label.box = Box{{Eigen::Matrix3d::Identity(), {x_m, 0, 0}}, {4, 2, 1.5}};
  return label;
}

TEST_F(Join, PosesAreThoseOfTheWholeDrive) {
  const inputs::Poses poses = join();
  const std::vector<StampedPose>& joint = poses.front().world_from_lidar.poses();
  ASSERT_EQ(joint.size(), 40U);
  for (int i = 0; i < 40; ++i) {
    const SE3 off = true_pose(i).inverse() * joint[static_cast<std::size_t>(i)].world_from_body;
    EXPECT_LT(off.t.norm(), 1e-9) << i;
    EXPECT_LT(so3_log(off.R).norm(), 1e-9) << i;
  }
  EXPECT_THAT(progress.warnings(), IsEmpty());
}

TEST_F(Join, PosesChangeGraduallyWhereSectionsDisagree) {
  // The second section drifts by 0.3 m to each side of the middle of the overlap.
  std::vector<StampedPose> drifted = sections[1].world_from_lidar().poses();
  for (StampedPose& pose : drifted)
    pose.world_from_body.t.z() += 0.03 * (static_cast<double>(pose.time_ns) / static_cast<double>(kStepNs) - 19.5);
  sections[1].poses.front().world_from_lidar = Trajectory(drifted);
  const inputs::Poses poses = join();
  const std::vector<StampedPose>& joint = poses.front().world_from_lidar.poses();
  double largest_step = 0;
  for (std::size_t i = 1; i < joint.size(); ++i)
    largest_step = std::max(largest_step, std::abs((joint[i].world_from_body.t - joint[i - 1].world_from_body.t).z()));
  EXPECT_LT(largest_step, 0.05) << "the drift is 0.03 m per frame";
  EXPECT_LT(joint[5].world_from_body.t.norm(), 6) << "far from the border, each section keeps its own poses";
  EXPECT_NEAR(joint[5].world_from_body.t.z(), 0, 1e-9);
}

TEST_F(Join, WarnsOfSectionsThatDisagree) {
  std::vector<StampedPose> wrong = sections[1].world_from_lidar().poses();
  for (StampedPose& pose : wrong) pose.world_from_body.t *= 3;
  sections[1].poses.front().world_from_lidar = Trajectory(wrong);
  join();
  EXPECT_THAT(progress.warnings(), ElementsAre(HasSubstr("sections 1 and 2 disagree about their overlap by")));
}

TEST_F(Join, RefusesSectionsWithoutACommonPose) {
  std::vector<StampedPose> late;
  for (const StampedPose& pose : sections[1].world_from_lidar().poses())
    if (pose.time_ns > 35 * kStepNs) late.push_back(pose);
  sections[1].poses.front().world_from_lidar = Trajectory(late);
  EXPECT_THROW(join(), InputError);
}

TEST_F(Join, ObjectsKeepOneNumber) {
  for (int frame = 8; frame < 30; ++frame) add_label(0, frame, make_label(3, 10));
  for (int frame = 10; frame < 35; ++frame) {
    add_label(1, frame, make_label(0, 10.5));  // the same car
    add_label(1, frame, make_label(3, 40));    // another one
  }
  sections[0].objects.motions = {{3, objects::MotionState::stationary}};
  sections[1].objects.motions = {{0, objects::MotionState::moving}};
  const objects::CameraObjects joint = join_objects(sections, drives.front().drive);
  ASSERT_EQ(joint.labels->size(), 40U);
  const auto tracks = [&](std::size_t frame) {
    std::vector<int> out;
    for (const Label& label : (*joint.labels)[frame]) out.push_back(label.track);
    return out;
  };
  EXPECT_THAT(tracks(7), IsEmpty());
  EXPECT_THAT(tracks(19), ElementsAre(3)) << "labels of the section that fills the frame";
  EXPECT_THAT(tracks(20), ElementsAre(3, 4)) << "the number 3 of the other car is in use";
  ASSERT_EQ(joint.motions.size(), 1U);
  EXPECT_EQ(joint.motions.front().object, 3);
  EXPECT_EQ(joint.motions.front().state, objects::MotionState::moving);
}

TEST_F(Join, ObjectsWithoutBoxesAreComparedInTheImage) {
  Label outline;
  outline.track = 5;
  outline.instance = Instance{{100, 50}, {50 * 10 + 5, 20, 30, 20, 4000}};  // columns 10 and 11, rows 5 to 24
  Label rect;
  rect.track = 8;
  rect.rect = cv::Rect2d(10, 5, 2, 18);
  for (int frame = 12; frame < 28; ++frame) {
    add_label(0, frame, outline);
    add_label(1, frame, rect);
  }
  const objects::CameraObjects joint = join_objects(sections, drives.front().drive);
  EXPECT_EQ((*joint.labels)[25].front().track, 5);
}

TEST_F(Join, GainsHaveOneReference) {
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t i = 0; i < sections[k].gains.of_view.size(); ++i) {
      const float own = k == 0 ? 1.0F : 1.5F;  // the sections differ in their mean
      sections[k].gains.of_view[i] =
          cv::Vec3f(2, 3, 4) * own * (1 + 0.01F * static_cast<float>(sections[k].target().frames[i].number));
    }
  const inputs::Poses poses = join();
  const Views views = joint_views(poses);
  const exposure::Gains gains = join_gains({sections, views, drives, borders});
  ASSERT_EQ(gains.of_view.size(), 40U);
  for (int i = 0; i < 40; ++i) EXPECT_NEAR(gains.of_view[static_cast<std::size_t>(i)][1], 3 * (1 + 0.01 * i), 1e-4) << i;
}

TEST_F(Join, CamerasKeepTheirRefinement) {
  const SE3 turn{so3_exp({0, 0.01, 0}), Eigen::Vector3d::Zero()};
  for (PlannedSection& section : sections)
    for (View& view : section.views.views) view.camera_from_world = turn * view.camera_from_world;
  sections[1].cameras.views[10].points = 77;  // frame 20
  const inputs::Poses poses = join();
  const Views views = joint_views(poses);
  const align::Cameras cameras = join_cameras({sections, views, drives, borders}, poses);
  for (int i = 0; i < 40; ++i) {
    const SE3 off = cameras.camera_from_world[static_cast<std::size_t>(i)] * true_pose(i) * turn.inverse();
    EXPECT_LT(off.t.norm() + so3_log(off.R).norm(), 1e-9) << i;
  }
  EXPECT_EQ(cameras.views[20].points, 77);
}

TEST_F(Join, ViewsHaveNumbersOfTheWholeDrive) {
  const Views views = joint_views(join());
  const std::vector<std::size_t> numbers = number_views({sections[1].views, sections[1].drives}, {views, drives});
  ASSERT_EQ(numbers.size(), 30U);
  EXPECT_EQ(numbers.front(), 10U);
  EXPECT_EQ(numbers.back(), 39U);
  const std::vector<ViewSource> sources = find_view_sources({sections, views, drives, borders});
  EXPECT_EQ(sources[19].section, 0U);
  EXPECT_EQ(sources[20].section, 1U);
  EXPECT_EQ(sources[20].view, 10U);
}

TEST_F(Join, MapsHaveEachPointOnce) {
  // One point beside the path per frame, seen from three frames on each side.
  const auto make_map = [&](std::size_t k) {
    map::StaticMap map;
    const PlannedSection& section = sections[k];
    const SE3 section_from_true = true_pose(section.section.read.first).inverse();
    for (int i = section.section.read.first; i <= section.section.read.last; ++i)
      map.scans.push_back({0, kStepNs * i, (section_from_true * true_pose(i).t).cast<float>()});
    map::StaticMap::Tile tile{{}, 0, 0};
    const int last = static_cast<int>(map.scans.size()) - 1;
    for (int i = 0; i <= last; ++i) {
      const int frame = section.section.read.first + i;
      map::MapPoint point;
      point.position = (section_from_true * (true_pose(frame) * Eigen::Vector3d(0, 5, 0))).cast<float>();
      point.normal = (section_from_true.R * true_pose(frame).R * Eigen::Vector3d(0, -1, 0)).cast<float>();
      point.first = static_cast<std::uint32_t>(std::max(0, i - 3));
      point.last = static_cast<std::uint32_t>(std::min(last, i + 3));
      tile.bounds.extend(point.position);
      map.points.push_back(point);
      map.removed.push_back({point.position, map::Cause::moved});
    }
    tile.last = map.points.size();
    map.tiles.push_back(tile);
    map.counts.returns = 100;
    return map;
  };
  const map::StaticMap joint = join_maps(sections, join(), borders, make_map);
  ASSERT_EQ(joint.points.size(), 40U);
  for (std::size_t i = 0; i < 40; ++i) {
    const SE3 pose = true_pose(static_cast<int>(i));
    const map::MapPoint& point = joint.points[i];
    EXPECT_LT((point.position.cast<double>() - pose * Eigen::Vector3d(0, 5, 0)).norm(), 1e-4) << i;
    EXPECT_LT((point.normal.cast<double>() - pose.R * Eigen::Vector3d(0, -1, 0)).norm(), 1e-5) << i;
    EXPECT_LE(joint.scans[point.first].time_ns, kStepNs * static_cast<std::int64_t>(i));
    EXPECT_GE(joint.scans[point.last].time_ns, kStepNs * static_cast<std::int64_t>(i));
  }
  ASSERT_EQ(joint.tiles.size(), 2U);
  EXPECT_EQ(joint.tiles[1].first, 20U);
  EXPECT_TRUE(joint.tiles[1].bounds.contains(joint.points[30].position));
  EXPECT_NEAR(static_cast<double>(joint.removed.size()), 40, 10) << "by the nearest position at steps of 10 m";
  EXPECT_EQ(joint.counts.returns, 200U);
}

}  // namespace
}  // namespace dvi::sections
