#include <cmath>

#include <fmt/format.h>

#include "dvi/datasets/reader.h"
#include "dvi/testing/image_folder.h"

namespace dvi::datasets {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// Three scans of a straight drive at 10 m/s, with poses in LOAM's axes: back, up, left.
class Apolloscape : public testing::Test {
 protected:
  Apolloscape() {
    std::string global, relative;
    for (int i = 0; i < 3; ++i) {
      const std::string end = fmt::format("100.{}00000", i + 2), image = fmt::format("100.{}00000", i + 1);
      folder.write_image("image/" + image + ".jpg", cv::Mat3b(720, 1280, cv::Vec3b(5, 5, 5)));
      // One point ahead and one behind, in the axes x left, y back.
      folder.write(
          "lidar_bg/bg_" + end + ".pcd.ply",
          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float "
          "intensity\nend_header\n0 -7 1 3\n0 9 1 3\n0.01 -7 1 3\n");
      global += fmt::format("lidar_bg/bg_{}.pcd.ply 0 0 0 {} 0 0\n", end, -i - 1);
      relative += fmt::format("lidar_bg/bg_{}.pcd.ply 0 0 0 1 0 0\n", end);
    }
    folder.write("100-101/global_poses.txt", global);
    folder.write("100-101/rel_poses.txt", relative);
    folder.write_image("100-101_mask/100.200000.png", cv::Mat1b(720, 1280, uchar{3}));
  }
  std::string error() const {
    return input_error([&] { read_drive(folder.path); });
  }
  TestFolder folder;
};

TEST_F(Apolloscape, ConvertsScansToTheAxesOfDvi) {
  const Drive drive = read_drive(folder.path);
  EXPECT_EQ(drive.format, "apolloscape");
  ASSERT_EQ(drive.frames.size(), 3U);
  EXPECT_EQ(drive.frames[1].number, 1);
  EXPECT_EQ(drive.scan_headers[1].start_ns, drive.frames[1].time_ns);
  EXPECT_TRUE(drive.warnings.empty());
  const auto scan = drive.scans[0];
  EXPECT_TRUE(scan->points[0].isApprox(Eigen::Vector3f(7, 0, 1)));
  EXPECT_NEAR(scan->time[0], -0.05F, 1e-6);
  EXPECT_NEAR(scan->time[1], 0, 1e-4);
  EXPECT_EQ((*drive.masks[1])(3, 3), 255);
  EXPECT_TRUE(drive.mask_files[0].empty());
  // The point ahead is in the middle of the image, up to the camera's tilt.
  const Eigen::Vector2d ahead = drive.camera.project(drive.camera_from_lidar * Eigen::Vector3d(50, 0, 0));
  EXPECT_NEAR(ahead.x(), 602, 40);
  EXPECT_NEAR(ahead.y(), 342, 60);
}

TEST_F(Apolloscape, StatesThePlacesOfReturnsInTheFile) {
  folder.write("lidar_bg/bg_100.200000.pcd.ply",
               "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float "
               "intensity\nend_header\n0 -7 1 3\n0 0 0 0\n0.01 -7 1 3\n");
  const auto scan = read_drive(folder.path).scans[0];
  EXPECT_EQ(scan->points.size(), 2U);
  EXPECT_EQ(scan->file_points, 3U);
  EXPECT_THAT(scan->file_index, testing::ElementsAre(0, 2));
}

TEST_F(Apolloscape, HasPosesAtTheStartOfTheFirstScanAndTheEndOfEach) {
  const Drive drive = read_drive(folder.path);
  ASSERT_EQ(drive.poses.poses().size(), 4U);
  EXPECT_EQ(drive.poses.poses()[0].time_ns, drive.frames[0].time_ns);
  EXPECT_NEAR(drive.poses.poses()[0].world_from_body.t.x(), 0, 1e-9);
  EXPECT_NEAR(drive.poses.at(drive.scan_headers[2].end_ns)->t.x(), 3, 1e-9);
}

TEST_F(Apolloscape, RefusesInvalidFiles) {
  folder.write("100-101/global_poses.txt", "lidar_bg/bg_100.200000.pcd.ply 0 0 zero 1 2 3\n");
  EXPECT_THAT(error(), HasSubstr("global_poses.txt:1: 'zero' is not a number"));
  folder.write("100-101/global_poses.txt", "lidar_bg/bg_100.200000.pcd.ply 0 0 0 1 2 3\n\n");
  EXPECT_THAT(error(), HasSubstr("global_poses.txt:2: the line is empty"));
  folder.write_image("100-101_mask/7.png", cv::Mat1b(720, 1280, uchar{3}));
  fs::remove(folder.path / "100-101_mask/100.200000.png");
  EXPECT_THAT(error(), HasSubstr("7.png: is not a mask of an image"));
  folder.write_image("image/front.jpg", cv::Mat3b(720, 1280, cv::Vec3b(5, 5, 5)));
  EXPECT_THAT(error(), HasSubstr("front.jpg: is not named by its time"));
}

TEST_F(Apolloscape, ReportsFramesWithoutAScan) {
  fs::remove(folder.path / "lidar_bg/bg_100.300000.pcd.ply");
  EXPECT_THAT(read_drive(folder.path).warnings, testing::ElementsAre("no scan for frames 1"));
}

}  // namespace
}  // namespace dvi::datasets
