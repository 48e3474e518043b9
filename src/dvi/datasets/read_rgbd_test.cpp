#include "dvi/datasets/reader.h"
#include "dvi/testing/image_folder.h"

namespace dvi::datasets {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

const char* const kIdentity = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
const char* const kOneRight = "1 0 0 1\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";

// A wall perpendicular to the optical axis.
cv::Mat1w wall(int width, int height, ushort depth) { return cv::Mat1w(height, width, depth); }

Eigen::Vector3d in_world(const Drive& drive, std::size_t scan, std::size_t point) {
  return *drive.poses.at(drive.scan_headers[scan].time_ns) * drive.scans[scan]->points[point].cast<double>();
}

std::string error_of(const TestFolder& folder) {
  return input_error([&] {
    const Drive drive = read_drive(folder.path);
    for (std::size_t i = 0; i < drive.scans.size(); ++i) drive.scans[i];
  });
}

class SevenScenes : public testing::Test {
 protected:
  SevenScenes() {
    for (const char* name : {"frame-000007", "frame-000008"}) {
      folder.write_image(std::string(name) + ".color.png", cv::Mat3b(480, 640, cv::Vec3b(5, 5, 5)));
      folder.write_image(std::string(name) + ".depth.png", wall(640, 480, 2000));
      folder.write(std::string(name) + ".pose.txt", kIdentity);
    }
    folder.write("frame-000008.pose.txt", kOneRight);
  }
  TestFolder folder;
};

TEST_F(SevenScenes, OrdersFramesByNumberAndHasItsOwnDepthCamera) {
  folder.write_image("masks/frame-000008.png", cv::Mat1b(480, 640, uchar{255}));
  const Drive drive = read_drive(folder.path);
  EXPECT_EQ(drive.format, "7-scenes");
  EXPECT_EQ(drive.sensor, Sensor::depth_camera);
  ASSERT_EQ(drive.frames.size(), 2U);
  EXPECT_EQ(drive.frames[0].name, "frame-000007");
  EXPECT_EQ(drive.frames[0].number, 7);
  EXPECT_EQ(drive.frames[1].time_ns, drive.scan_headers[1].time_ns);
  EXPECT_EQ((*drive.masks[1])(0, 0), 255);
  // The first pixel of the wall, projected by the depth camera, in the axes of the world, which are those of the first camera.
  EXPECT_TRUE(in_world(drive, 0, 0).isApprox(Eigen::Vector3d(-320 * 2 / 585.0, -240 * 2 / 585.0, 2), 1e-5));
  EXPECT_NEAR(in_world(drive, 1, 0).x() - in_world(drive, 0, 0).x(), 1, 1e-5);
  EXPECT_NEAR(drive.scans[0]->points[0].x(), 2, 1e-5) << "scans have their x axis forward";
}

TEST_F(SevenScenes, ReadsTheDepthCameraFromDviToml) {
  folder.write("dvi.toml",
               "[camera.color]\nK = [500, 0, 320, 0, 500, 240, 0, 0, 1]\n"
               "[depth]\nK = [600, 0, 320, 0, 600, 240, 0, 0, 1]\nunits_per_meter = 2000\n"
               "depth_from_color = [1, 0, 0, 0.1,  0, 1, 0, 0,  0, 0, 1, 0]\n");
  const Drive drive = read_drive(folder.path);
  EXPECT_FALSE(drive.registered_depth);
  EXPECT_EQ(drive.camera.fx, 500);
  EXPECT_TRUE(in_world(drive, 0, 0).isApprox(Eigen::Vector3d(-320 / 600.0, -240 / 600.0, 1), 1e-5));
  const Eigen::Vector3d in_color = drive.camera_from_lidar * drive.scans[0]->points[0].cast<double>();
  EXPECT_NEAR(in_color.x(), -320 / 600.0 - 0.1, 1e-5);
}

TEST_F(SevenScenes, IgnoresInvalidDepthAndFlyingPixels) {
  cv::Mat1w depth = wall(640, 480, 3000);
  depth(10, 10) = 0;
  depth(10, 11) = 65535;
  depth(cv::Rect(100, 100, 10, 10)) = 1500;  // a box in front of the wall, and a column between the two
  depth(cv::Rect(110, 100, 1, 10)) = 2200;
  folder.write_image("frame-000007.depth.png", depth);
  const auto scan = read_drive(folder.path).scans[0];
  for (const Eigen::Vector3f& point : scan->points) EXPECT_TRUE(point.x() == 3.0F || point.x() == 1.5F) << point.x();
  // The outermost pixels of the box are removed, and the pixels of the wall beside them.
  const auto near = std::count_if(scan->points.begin(), scan->points.end(), [](const auto& p) { return p.x() < 2; });
  EXPECT_EQ(near, 8 * 8);
  EXPECT_EQ(scan->size(), 640U * 480 - 2 - 11 * 10 + 8 * 8 - 2 * 11 - 2 * 10);
}

TEST_F(SevenScenes, KeepsASlopingFloor) {
  cv::Mat1w depth(480, 640);
  for (int y = 0; y < 480; ++y) depth.row(y) = static_cast<ushort>(1000 * 585 * 1.5 / (y + 200));  // 1.5 m below the camera
  folder.write_image("frame-000007.depth.png", depth);
  EXPECT_EQ(read_drive(folder.path).scans[0]->size(), 640U * 480);
}

TEST_F(SevenScenes, RefusesImplausibleDepth) {
  folder.write_image("frame-000008.depth.png", wall(640, 480, 2));
  EXPECT_THAT(error_of(folder), AllOf(HasSubstr("frame-000008.depth.png"), HasSubstr("0.002 to 0.002 m"),
                                      HasSubstr("seem to be in meters"), HasSubstr("units_per_meter")));
  folder.write_image("frame-000008.depth.png", wall(640, 480, 65535));
  EXPECT_THAT(error_of(folder), HasSubstr("holds no depth"));
  folder.write_image("frame-000008.depth.png", wall(320, 240, 2000));
  EXPECT_THAT(error_of(folder), AllOf(HasSubstr("frame-000008.depth.png"), HasSubstr("not a 16-bit gray image of 640x480")));
}

TEST_F(SevenScenes, RefusesItsNominalCamerasForImagesOfAnotherSize) {
  for (const char* name : {"frame-000007.depth.png", "frame-000008.depth.png"}) folder.write_image(name, wall(480, 360, 2000));
  EXPECT_THAT(error_of(folder), AllOf(HasSubstr("frame-000007.depth.png"), HasSubstr("480x360"), HasSubstr("320, 240"),
                                      HasSubstr("[depth] of dvi.toml")));
  folder.write("dvi.toml", "[depth]\nK = [439, 0, 239.6, 0, 439, 179.6, 0, 0, 1]\n");
  EXPECT_THAT(read_drive(folder.path).warnings, testing::IsEmpty());
  folder.write("dvi.toml", "[depth]\nK = [585, 0, 320, 0, 585, 240, 0, 0, 1]\n");
  EXPECT_THAT(read_drive(folder.path).warnings, testing::Contains(HasSubstr("check K in the table [depth]")));
  folder.write_image("frame-000007.color.png", cv::Mat3b(240, 320));
  EXPECT_THAT(error_of(folder), AllOf(HasSubstr("frame-000007.color.png"), HasSubstr("320x240"), HasSubstr("[camera.color]")));
}

TEST_F(SevenScenes, ReportsMissingDepthAndRefusesInvalidPoses) {
  folder.write("frame-000008.pose.txt", "-1.#INF -1.#INF -1.#INF 0\nnan 0 0 0\n0 0 0 inf\n0 0 0 1\n");
  fs::remove(folder.path / "frame-000008.depth.png");
  EXPECT_EQ(read_drive(folder.path).poses.poses().size(), 1U) << "there is no pose where tracking was lost";
  EXPECT_THAT(read_drive(folder.path).warnings, testing::Contains("no depth image for frames 8"));
  folder.write("frame-000008.pose.txt", "1 0 0\n0 1 0\n0 0 1\n");
  EXPECT_THAT(error_of(folder), AllOf(HasSubstr("frame-000008.pose.txt"), HasSubstr("3 lines instead of 4")));
  folder.write("frame-000008.pose.txt", "2 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  EXPECT_THAT(error_of(folder), HasSubstr("write a 4x4 matrix, camera to world"));
}

class TumRgbd : public testing::Test {
 protected:
  TumRgbd() {
    for (const char* name : {"10.00", "10.04"}) folder.write_image(std::string("rgb/") + name + ".png", cv::Mat3b(48, 64));
    for (const char* name : {"10.01", "10.05"}) folder.write_image(std::string("depth/") + name + ".png", wall(64, 48, 10'000));
    folder.write("rgb.txt", "# color images\n10.00 rgb/10.00.png\n10.04 rgb/10.04.png\n");
    folder.write("depth.txt", "# depth maps\n10.01 depth/10.01.png\n10.05 depth/10.05.png\n");
    folder.write("groundtruth.txt", "# timestamp tx ty tz qx qy qz qw\n9.9 0 0 0 0 0 0 1\n10.1 2 0 0 0 0 0 1\n");
    folder.write("dvi.toml", "[camera.rgb]\nK = [50, 0, 32, 0, 50, 24, 0, 0, 1]\n");
  }
  TestFolder folder;
};

TEST_F(TumRgbd, HasSeparateTimesOfImagesAndDepth) {
  const Drive drive = read_drive(folder.path);
  EXPECT_EQ(drive.format, "tum-rgbd");
  EXPECT_TRUE(drive.registered_depth);
  ASSERT_EQ(drive.frames.size(), 2U);
  EXPECT_EQ(drive.frames[1].time_ns, 10'040'000'000);
  EXPECT_EQ(drive.scan_headers[1].time_ns, 10'050'000'000);
  EXPECT_TRUE(drive.warnings.empty());
  EXPECT_TRUE(in_world(drive, 0, 0).isApprox(Eigen::Vector3d(1.1 - 2 * 32 / 50.0, -2 * 24 / 50.0, 2), 1e-5));
}

TEST_F(TumRgbd, RefusesListsOfFilesOutsideTheDrive) {
  folder.write("rgb.txt", "10.00 rgb/9.png\n");
  EXPECT_THAT(error_of(folder), AllOf(HasSubstr("rgb.txt:1"), HasSubstr("9.png")));
  folder.write("rgb.txt", "10.00 ../9.png\n");
  EXPECT_THAT(error_of(folder), HasSubstr("is not a file below the drive"));
  folder.write("rgb.txt", "10.00\n");
  EXPECT_THAT(error_of(folder), HasSubstr("lines are: seconds file"));
}

TEST_F(TumRgbd, WarnsOfTheAssumedCamera) {
  folder.write_image("rgb/10.00.png", cv::Mat3b(480, 640));
  folder.write_image("rgb/10.04.png", cv::Mat3b(480, 640));
  folder.write_image("depth/10.01.png", wall(640, 480, 10'000));
  fs::remove(folder.path / "dvi.toml");
  EXPECT_THAT(read_drive(folder.path).warnings, ElementsAre(HasSubstr("fx = fy = 525")));
}

class Scannet : public testing::Test {
 protected:
  Scannet() {
    for (const int number : {9, 10}) {
      const std::string name = std::to_string(number);
      folder.write_image("color/" + name + ".jpg", cv::Mat3b(96, 128, cv::Vec3b(5, 5, 5)));
      folder.write_image("depth/" + name + ".png", wall(64, 48, 2000));
      folder.write("pose/" + name + ".txt", number == 9 ? kIdentity
                                                        : "-inf -inf -inf -inf\n-inf -inf -inf -inf\n"
                                                          "-inf -inf -inf -inf\n-inf -inf -inf -inf\n");
    }
    folder.write("intrinsic/intrinsic_color.txt", "100 0 64 0\n0 100 48 0\n0 0 1 0\n0 0 0 1\n");
    folder.write("intrinsic/intrinsic_depth.txt", "50 0 32 0\n0 50 24 0\n0 0 1 0\n0 0 0 1\n");
    folder.write("intrinsic/extrinsic_color.txt", kIdentity);
    folder.write("intrinsic/extrinsic_depth.txt", kIdentity);
  }
  TestFolder folder;
};

TEST_F(Scannet, ReadsDepthOfAnotherSizeInOrderOfNumbers) {
  const Drive drive = read_drive(folder.path);
  EXPECT_EQ(drive.format, "scannet");
  EXPECT_TRUE(drive.registered_depth);
  ASSERT_EQ(drive.frames.size(), 2U);
  EXPECT_EQ(drive.frames[0].number, 9);
  EXPECT_EQ(drive.camera.width, 128);
  EXPECT_EQ(drive.camera.fx, 100);
  EXPECT_EQ(drive.poses.poses().size(), 1U) << "-inf: lost";
  EXPECT_TRUE(in_world(drive, 0, 0).isApprox(Eigen::Vector3d(-2 * 32 / 50.0, -2 * 24 / 50.0, 2), 1e-5));
}

TEST_F(Scannet, PlacesTheDepthCameraByBothExtrinsics) {
  folder.write("intrinsic/extrinsic_depth.txt", kOneRight);
  const Drive drive = read_drive(folder.path);
  EXPECT_FALSE(drive.registered_depth);
  const Eigen::Vector3d in_color = drive.camera_from_lidar * drive.scans[0]->points[0].cast<double>();
  EXPECT_TRUE(in_color.isApprox(Eigen::Vector3d(1 - 2 * 32 / 50.0, -2 * 24 / 50.0, 2), 1e-5));
}

TEST_F(Scannet, RefusesMissingFiles) {
  fs::remove(folder.path / "intrinsic/intrinsic_depth.txt");
  EXPECT_THAT(error_of(folder), AllOf(HasSubstr("intrinsic_depth.txt"), HasSubstr("is missing")));
}

}  // namespace
}  // namespace dvi::datasets
