#include "dvi/datasets/pose_file.h"

#include <cmath>

#include <fmt/format.h>

#include "dvi/geometry/rigid.h"
#include "dvi/testing/image_folder.h"

namespace dvi::datasets {
namespace {

using testing::HasSubstr;

Drive two_scans() {
  Drive drive;
  drive.frames = {{0, "a", 100, {}, {}}, {1, "b", 200, {}, {}}};
  drive.scan_headers = {{"a", 110, 60, 160, {}}, {"b", 210, 160, 260, {}}};
  drive.camera_from_lidar.t = {0, 0, -1};
  return drive;
}

TEST(Poses, AreReadInThreeForms) {
  const TestFolder folder;
  const Trajectory scans = read_poses(
      folder.write("a", "a 1 0 0 5 0 1 0 6 0 0 1 7\nb 0 -1 0 8 1 0 0 9 0 0 1 10\nc 1 0 0 0 0 1 0 0 0 0 1 0\n"), two_scans());
  ASSERT_EQ(scans.poses().size(), 2U);
  EXPECT_EQ(scans.poses()[1].time_ns, 210);
  EXPECT_EQ(scans.poses()[1].world_from_body.t, Eigen::Vector3d(8, 9, 10));
  EXPECT_NEAR(scans.poses()[1].world_from_body.R(0, 1), -1, 1e-12);

  const Trajectory tum =
      read_poses(folder.write("b", "# t x y z q\n0.000000110 1 2 3 0 0 0.70710678 0.70710678\n"), two_scans());
  EXPECT_EQ(tum.poses().at(0).time_ns, 110);
  EXPECT_NEAR(tum.poses().at(0).world_from_body.R(1, 0), 1, 1e-7);

  const Trajectory frames = read_poses(folder.write("c", "1 0 0 0 0 1 0 0 0 0 1 1\n1 0 0 0 0 1 0 0 0 0 1 3\n"), two_scans());
  EXPECT_EQ(frames.poses().at(1).time_ns, 200);
  EXPECT_NEAR(frames.poses().at(1).world_from_body.t.z(), 2, 1e-12);
}

// evo and pandas write commas and column names; numpy.savetxt puts the names after '#'.
TEST(Poses, OfTumMayHaveCommasAndColumnNames) {
  const TestFolder folder;
  const double turn = std::sqrt(0.5);
  const std::string numbers = fmt::format("{0},{0}", turn);
  for (const std::string& text :
       {"timestamp,tx,ty,tz,qx,qy,qz,qw\n0.000000110,1,2,3,0,0," + numbers + "\n",
        "timestamp tx ty tz qw qx qy qz\n0.000000110 1 2 3 " + fmt::format("{0} 0 0 {0}", turn) + "\n",
        "# timestamp tx ty tz qw qx qy qz\n0.000000110 1 2 3 " + fmt::format("{0} 0 0 {0}", turn) + "\n"}) {
    const Trajectory poses = read_poses(folder.write("tum", text), two_scans());
    ASSERT_EQ(poses.poses().size(), 1U) << text;
    EXPECT_NEAR(poses.poses()[0].world_from_body.R(1, 0), 1, 1e-7) << text;
  }
}

TEST(Poses, MayRepeatATimeWithoutContradiction) {
  const TestFolder folder;
  const std::string a = "0.000000110 1 2 3 0 0 0 1\n", b = "0.000000210 1 2 4 0 0 0 1\n";
  EXPECT_EQ(read_poses(folder.write("reversed", b + a + a), two_scans()).poses().front().time_ns, 110);
  EXPECT_THAT(input_error([&] { read_poses(folder.write("tum.txt", a + b + "0.000000110 5 2 3 0 0 0 1\n"), two_scans()); }),
              HasSubstr("tum.txt:3: gives another pose for '0.000000110', 4.00 m from the first"));
  EXPECT_THAT(input_error([&] {
                read_poses(folder.write("scans.txt", "a 1 0 0 5 0 1 0 6 0 0 1 7\na 1 0 0 9 0 1 0 6 0 0 1 7\n"), two_scans());
              }),
              HasSubstr("scans.txt:2: gives another pose for 'a'"));
}

TEST(Poses, AreWrittenRowByRow) {
  const SE3 pose{so3_exp({0.3, -1.2, 0.7}), {5, -6, 7.5}};
  const std::array<double, 12> rows = to_row_major(pose);
  EXPECT_EQ(rows[1], pose.R(0, 1));
  EXPECT_EQ(rows[4], pose.R(1, 0));
  EXPECT_EQ(rows[7], -6);
  const std::optional<SE3> back = to_rigid(rows);
  ASSERT_TRUE(back);
  EXPECT_LT((back->R - pose.R).norm(), 1e-12);
  EXPECT_EQ(back->t, pose.t);
}

TEST(Poses, AreRefusedWithFileAndLine) {
  const TestFolder folder;
  const auto error = [&](const std::string& text) {
    return input_error([&] { read_poses(folder.write("poses.txt", text), two_scans()); });
  };
  const std::string good = "a 1 0 0 5 0 1 0 6 0 0 1 7\n";
  EXPECT_THAT(error(""), HasSubstr("poses.txt: holds no poses"));
  EXPECT_THAT(error(good + "\n"), HasSubstr("poses.txt:2: the line is empty"));
  EXPECT_THAT(error(good + "b 1 0 0 x 0 1 0 6 0 0 1 7\n"), HasSubstr("poses.txt:2: 'x' is not a number"));
  EXPECT_THAT(error(good + "b 1 0 0 nan 0 1 0 6 0 0 1 7\n"), HasSubstr("poses.txt:2: 'nan' is not a number"));
  EXPECT_THAT(error("a 2 0 0 5 0 1 0 6 0 0 1 7\n"), HasSubstr("poses.txt:1: does not hold a rotation"));
  EXPECT_THAT(error("0.1 1 2 3 0 0 1 1\n"), HasSubstr("quaternion of length 1"));
  EXPECT_THAT(error("1 2 3\n"), HasSubstr("poses.txt:1: has 3 entries"));
  EXPECT_THAT(error("z 1 0 0 5 0 1 0 6 0 0 1 7\n"), HasSubstr("none of its names is that of a scan"));
  EXPECT_THAT(error("1 0 0 0 0 1 0 0 0 0 1 1\n"), HasSubstr("has 1 poses for 2 frames"));
}

}  // namespace
}  // namespace dvi::datasets
