#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/io/bag.h"
#include "dvi/io/reader.h"
#include "dvi/io/test_folder.h"

namespace dvi::io {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// The same drive in bags of all kinds, by the formats' own writers (tests/layouts).
const fs::path kBags = DVI_TEST_BAGS;

std::string bag_error(const fs::path& path, const ReadOptions& options = {}) {
  return input_error([&] {
    const Drive drive = read_drive(path, options);
    for (std::size_t i = 0; i < drive.images.size(); ++i) drive.images[i];
    for (std::size_t i = 0; i < drive.scans.size(); ++i) drive.scans[i];
  });
}

TEST(RosBagOfDepth, DepthImagesAreScans) {
  const Drive drive = read_drive(kBags / "rgbd.bag");
  EXPECT_EQ(drive.sensor, Sensor::depth_camera);
  EXPECT_TRUE(drive.registered_depth);
  ASSERT_EQ(drive.frames.size(), 3U);
  ASSERT_EQ(drive.scan_headers.size(), 3U);
  ASSERT_EQ(drive.poses.poses().size(), 3U);
  EXPECT_EQ(drive.scan_headers[1].time_ns, drive.frames[1].time_ns);
  EXPECT_TRUE(drive.warnings.empty());
  // The room's floor and walls: from the camera's place, each point in its pixel.
  const auto scan = drive.scans[1];
  EXPECT_GT(scan->size(), 400U) << "of 1536 pixels; those beside a jump in depth are left out";
  for (const Eigen::Vector3f& p : scan->points) {
    const Eigen::Vector2d pixel = drive.camera.project(drive.camera_from_lidar * p.cast<double>());
    EXPECT_LT((pixel - pixel.array().round().matrix()).norm(), 1e-3);
    EXPECT_TRUE(p.x() > 0.1F && p.x() < 10) << "x is forward";
  }
}

TEST(RosBagOfDepth, TopicsCanBeNamed) {
  const Drive drive = read_drive(kBags / "rgbd.bag", {.topics = {"depth=/camera/depth/image"}});
  EXPECT_EQ(drive.scan_headers.size(), 3U);
  EXPECT_THAT(bag_error(kBags / "rgbd.bag", {.topics = {"depth=/camera/rgb/image_color/compressed"}}), HasSubstr("no depth"));
  EXPECT_THAT(bag_error(kBags / "rgbd.bag", {.topics = {"depth=/depth"}}), HasSubstr("no topic /depth"));
}

class RosBag : public testing::TestWithParam<const char*> {};

TEST_P(RosBag, HoldsTheDrive) {
  const Drive drive = read_drive(kBags / GetParam()), expected = read_drive(kBags / "zstd.mcap");
  EXPECT_EQ(drive.format, "rosbag");
  EXPECT_EQ(drive.camera_names, (std::vector<std::string>{"front", "right"}));
  EXPECT_EQ(drive.camera.fx, 25.6);
  EXPECT_EQ(drive.camera.width, 32);
  EXPECT_NEAR(drive.camera_from_lidar.t.z(), -0.270928524747, 1e-9);
  ASSERT_EQ(drive.frames.size(), 3U);
  EXPECT_EQ(drive.frames[1].time_ns, 1000'150'000'000);
  ASSERT_EQ(drive.scan_headers.size(), 3U);
  EXPECT_EQ(drive.scan_headers[1].start_ns, 1000'100'000'000);
  EXPECT_EQ(drive.scan_headers[1].end_ns, 1000'200'000'000) << "when the next begins";
  ASSERT_EQ(drive.poses.poses().size(), 3U);
  EXPECT_NEAR(drive.poses.poses()[0].world_from_body.t.z(), 1.73, 1e-9);
  ASSERT_EQ(drive.fixes.size(), 2U) << "without the one that the receiver marks as none";
  EXPECT_EQ(drive.fixes[1].time_ns, drive.scan_headers[2].time_ns);
  EXPECT_NEAR(drive.fixes[0].latitude_deg, 49, 1e-4);
  EXPECT_GT(drive.fixes[1].longitude_deg, drive.fixes[0].longitude_deg);
  EXPECT_LT((drive.fixes[0].antenna - Eigen::Vector3d(-0.5, 0.2, -0.3)).norm(), 1e-9) << "in the LiDAR's axes";
  EXPECT_TRUE(drive.warnings.empty());
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(cv::norm(*drive.images[i], *expected.images[i], cv::NORM_INF), 0);
    const auto scan = drive.scans[i], other = expected.scans[i];
    EXPECT_TRUE(scan->points == other->points && scan->time == other->time && scan->ring == other->ring);
    EXPECT_EQ(scan->size(), 160U) << "without the one that is not finite";
  }
}

TEST_P(RosBag, AnotherCameraIsOfPixels) {
  const Drive drive = read_drive(kBags / GetParam(), {.camera = "right"});
  EXPECT_NEAR(drive.camera_from_lidar.t.x(), -0.437363218501, 1e-9);
  const cv::Mat3b image = *drive.images[0];
  EXPECT_EQ(image.size(), cv::Size(32, 32));
  EXPECT_GT(cv::norm(image, cv::NORM_L1), 0);
}

// At every byte would take long; a prime number of bytes meets all kinds of records.
TEST_P(RosBag, CutAnywhereItIsRefused) {
  if (std::string(GetParam()).ends_with(".db3")) GTEST_SKIP() << "a database finds its last pages by itself";
  const std::string whole = read_file(kBags / GetParam());
  const TestFolder folder;
  const std::string name = "cut" + fs::path(GetParam()).extension().string();
  for (std::size_t size = 0; size + 50 < whole.size(); size += 1777) {
    const std::string error = bag_error(folder.write(name, whole.substr(0, size)));
    EXPECT_THAT(error, HasSubstr(name)) << size;
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, RosBag,
                         testing::Values("zstd.mcap", "lz4_without_index.mcap", "without_chunks.mcap", "sqlite.db3", "bz2.bag",
                                         "lz4.bag"),
                         [](const auto& kind) { return std::string(kind.param).substr(0, std::string(kind.param).find('.')); });

class ChangedBag : public testing::Test {
 protected:
  // The unpacked bag with one word replaced wherever it stands, by one of the same length.
  fs::path replaced(const std::string& word, const std::string& other) const {
    EXPECT_EQ(word.size(), other.size());
    std::string bytes = read_file(kBags / "without_chunks.mcap");
    for (std::size_t at = bytes.find(word); at != std::string::npos; at = bytes.find(word, at + word.size()))
      bytes.replace(at, word.size(), other);
    return folder.write("changed.mcap", bytes);
  }
  TestFolder folder;
};

TEST_F(ChangedBag, WithoutTfAsksForTheExtrinsics) {
  const fs::path bag = replaced("tf2_msgs/msg/TFMessage", "tf2_msgs/msg/Unknown__");
  EXPECT_THAT(bag_error(bag), AllOf(HasSubstr("no tf joins front_optical"), HasSubstr("camera_from_lidar")));
  folder.write("dvi.toml", "[camera.front]\ncamera_from_lidar = [0, -1, 0, 0,  0, 0, -1, 0,  1, 0, 0, 0]\n");
  const Drive drive = read_drive(bag);
  EXPECT_TRUE(drive.poses.empty()) << "nothing says where the odometry's frame is";
  EXPECT_THAT(drive.warnings, testing::Contains(HasSubstr("base_link")));
}

TEST_F(ChangedBag, WithoutCalibrationAsksForIt) {
  EXPECT_THAT(bag_error(replaced("sensor_msgs/msg/CameraInfo", "sensor_msgs/msg/CameraXXXX")),
              AllOf(HasSubstr("no calibration of /front/image_raw/compressed"), HasSubstr("[camera.front] K")));
}

TEST_F(ChangedBag, WithoutScansListsTheTopics) {
  EXPECT_THAT(bag_error(replaced("sensor_msgs/msg/PointCloud2", "sensor_msgs/msg/LaserScan2_")),
              AllOf(HasSubstr("no topic of sensor_msgs/PointCloud2"), HasSubstr("/lidar/points")));
}

TEST_F(ChangedBag, AnotherEncodingOfMessagesIsNotRead) {
  EXPECT_THAT(bag_error(replaced(std::string("\3\0\0\0cdr", 7), std::string("\3\0\0\0xml", 7))),
              HasSubstr("no topic of images"))
      << "of those that can be read";
}

TEST_F(ChangedBag, TopicsCanBeNamed) {
  const fs::path bag = kBags / "zstd.mcap";
  EXPECT_EQ(read_drive(bag, {.topics = {"image=/right/image_raw", "poses=/odometry"}}).camera_name, "right");
  EXPECT_THAT(bag_error(bag, {.topics = {"image=/rear"}}), AllOf(HasSubstr("no topic /rear"), HasSubstr("/right/image_raw")));
  EXPECT_THAT(bag_error(bag, {.topics = {"points=/tf"}}), HasSubstr("topic /tf of tf2_msgs/TFMessage"));
  EXPECT_THROW(read_drive(bag, {.topics = {"colour=/right/image_raw"}}), UsageError);
}

TEST_F(ChangedBag, AnEmptyBagIsRefused) {
  std::string bytes = "\x89MCAP0\r\n";
  bytes += std::string("\x02\x14\0\0\0\0\0\0\0", 9) + std::string(20, '\0') + "\x89MCAP0\r\n";
  EXPECT_THAT(bag_error(folder.write("empty.mcap", bytes)), HasSubstr("holds no messages"));
  EXPECT_THAT(bag_error(folder.write("nothing.bag", "#ROSBAG V2.0\n")), HasSubstr("holds no messages"));
  EXPECT_THAT(bag_error(folder.write("nothing.db3", "no database")), HasSubstr("nothing.db3"));
}

}  // namespace
}  // namespace dvi::io
