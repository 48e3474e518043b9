#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "dvi/bags/bag.h"
#include "dvi/core/error.h"
#include "dvi/datasets/reader.h"
#include "dvi/testing/find_recording.h"
#include "dvi/testing/image_folder.h"

namespace dvi::datasets {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// Bags of all kinds with the same drive, written by the formats' own writers (tests/layouts).
const fs::path kBags = DVI_TEST_BAGS;

std::string bag_error(const fs::path& path, const ReadOptions& options = {}) {
  return input_error([&] {
    const Drive drive = read_drive(path, options);
    for (std::size_t i = 0; i < drive.images.size(); ++i) drive.images[i];
    for (std::size_t i = 0; i < drive.scans.size(); ++i) drive.scans[i];
  });
}

TEST(RosBagOfDepth, ReadsDepthImagesAsScans) {
  const Drive drive = read_drive(kBags / "rgbd.bag");
  EXPECT_EQ(drive.sensor, Sensor::depth_camera);
  EXPECT_TRUE(drive.registered_depth);
  ASSERT_EQ(drive.frames.size(), 3U);
  ASSERT_EQ(drive.scan_headers.size(), 3U);
  ASSERT_EQ(drive.poses.poses().size(), 3U);
  EXPECT_EQ(drive.scan_headers[1].time_ns, drive.frames[1].time_ns);
  EXPECT_GT(drive.scan_headers[1].end_ns, drive.scan_headers[1].start_ns)
      << "images that are taken slightly later belong to it as well";
  EXPECT_TRUE(drive.warnings.empty());
  // Each point of the room's floor and walls projects to its pixel.
  const auto scan = drive.scans[1];
  EXPECT_GT(scan->size(), 400U) << "of 1536 pixels; those beside a jump in depth are left out";
  for (const Eigen::Vector3f& p : scan->points) {
    const Eigen::Vector2d pixel = drive.camera.project(drive.camera_from_lidar * p.cast<double>());
    EXPECT_LT((pixel - pixel.array().round().matrix()).norm(), 1e-3);
    EXPECT_TRUE(p.x() > 0.1F && p.x() < 10) << "x is forward";
  }
}

TEST(RosBagOfDepth, ReadsTheNamedTopics) {
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
  ASSERT_EQ(drive.fixes.size(), 2U) << "without the fix that the receiver marks as invalid";
  EXPECT_EQ(drive.fixes[1].time_ns, drive.scan_headers[2].time_ns);
  EXPECT_NEAR(drive.fixes[0].latitude_deg, 49, 1e-4);
  EXPECT_GT(drive.fixes[1].longitude_deg, drive.fixes[0].longitude_deg);
  EXPECT_LT((drive.fixes[0].antenna - Eigen::Vector3d(-0.5, 0.2, -0.3)).norm(), 1e-9) << "in the LiDAR's axes";
  EXPECT_TRUE(drive.warnings.empty());
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(cv::norm(*drive.images[i], *expected.images[i], cv::NORM_INF), 0);
    const auto scan = drive.scans[i], other = expected.scans[i];
    EXPECT_TRUE(scan->points == other->points && scan->time == other->time && scan->ring == other->ring);
    EXPECT_EQ(scan->size(), 160U) << "without the point that is not finite";
  }
}

TEST_P(RosBag, ReadsAnotherCameraInPixels) {
  const Drive drive = read_drive(kBags / GetParam(), {.camera = "right"});
  EXPECT_NEAR(drive.camera_from_lidar.t.x(), -0.437363218501, 1e-9);
  const cv::Mat3b image = *drive.images[0];
  EXPECT_EQ(image.size(), cv::Size(32, 32));
  EXPECT_GT(cv::norm(image, cv::NORM_L1), 0);
}

// A step by a prime number of bytes meets all kinds of records and is faster than cutting at each byte.
TEST_P(RosBag, IsRefusedIfTruncatedAnywhere) {
  if (std::string(GetParam()).ends_with(".db3")) GTEST_SKIP() << "SQLite recovers the last pages";
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

// Scans of Livox and 12-bit images in 16 bits, written by python3-rosbag and @mcap/core.
class LivoxBag : public testing::TestWithParam<const char*> {};

TEST_P(LivoxBag, HoldsScansWithTimes) {
  const Drive drive = read_drive(kBags / GetParam());
  ASSERT_EQ(drive.scan_headers.size(), 3U);
  EXPECT_EQ(drive.scan_headers[1].start_ns, 1000'100'000'000);
  EXPECT_EQ(drive.scan_headers[1].end_ns, 1000'200'000'000);
  const auto scan = drive.scans[1];
  const Drive expected = read_drive(kBags / "zstd.mcap");
  EXPECT_TRUE(scan->points == expected.scans[1]->points) << "the same drive";
  ASSERT_EQ(scan->time.size(), scan->size());
  for (std::size_t i = 0; i < scan->size(); ++i) EXPECT_NEAR(scan->time[i], expected.scans[1]->time[i], 1e-6);
}

TEST_P(LivoxBag, Scales12BitImages) {
  const Drive drive = read_drive(kBags / GetParam());
  EXPECT_THAT(drive.warnings, testing::ElementsAre(HasSubstr("are read as 12-bit images")));
  const cv::Mat3b image = *drive.images[1], expected = *read_drive(kBags / "zstd.mcap").images[1];
  cv::Mat1b gray;
  cv::cvtColor(expected, gray, cv::COLOR_BGR2GRAY);
  cv::cvtColor(gray, expected, cv::COLOR_GRAY2BGR);
  EXPECT_LE(cv::norm(image, expected, cv::NORM_INF), 1);
}

INSTANTIATE_TEST_SUITE_P(Kinds, LivoxBag, testing::Values("livox.bag", "livox.mcap"),
                         [](const auto& kind) { return fs::path(kind.param).extension() == ".bag" ? "Ros1" : "Mcap"; });

// One file of a recording whose metadata.yaml counts five images of the first camera.
class SplitBag : public testing::Test {
 protected:
  SplitBag() { fs::copy_file(kBags / "sqlite.db3", folder.path / "drive_1.db3"); }
  void describe(const std::string& files, const std::string& count) const {
    folder.write("metadata.yaml", "rosbag2_bagfile_information:\n  relative_file_paths:\n" + files +
                                      "  topics_with_message_count:\n    - topic_metadata:\n        name: "
                                      "/front/image_raw/compressed\n      message_count: " +
                                      count + "\n");
  }
  TestFolder folder;
};

TEST_F(SplitBag, KeepsFrameNumbersWithoutTheFirstFile) {
  describe("    - drive_0.db3\n    - drive_1.db3\n", "5");
  const Drive drive = read_drive(folder.path);
  ASSERT_EQ(drive.frames.size(), 3U);
  EXPECT_EQ(drive.frames[0].number, 2);
  EXPECT_EQ(drive.frames[0].name, "000002");
  EXPECT_THAT(drive.warnings,
              testing::ElementsAre(HasSubstr("lists drive_0.db3, which is missing"), HasSubstr("frames 0-1 are missing")));
  EXPECT_EQ(cv::norm(*drive.images[2], *read_drive(kBags / "sqlite.db3").images[2], cv::NORM_INF), 0);
}

TEST_F(SplitBag, CountsMissingMessages) {
  describe("    - drive_1.db3\n", "5");
  EXPECT_THAT(read_drive(folder.path).warnings, testing::ElementsAre(HasSubstr("2 of 5 messages of /front/image_raw")));
}

TEST_F(SplitBag, RefusesAnUnknownNumberOfLostFrames) {
  describe("    - drive_0.db3\n    - drive_1.db3\n", "unknown");
  EXPECT_THAT(bag_error(folder.path), AllOf(HasSubstr("drive_0.db3 is missing"), HasSubstr("/front/image_raw/compressed")));
}

// A reader must not write beside a recording, unlike SQLite with a write-ahead log.
TEST_F(SplitBag, WritesNothingBesideIt) {
  std::string bytes = read_file(folder.path / "drive_1.db3");
  bytes[18] = bytes[19] = 2;  // file format versions of a database with a write-ahead log: https://sqlite.org/fileformat.html
  folder.write("log # 100%.db3", bytes);
  EXPECT_EQ(read_drive(folder.path / "log # 100%.db3").frames.size(), 3U);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator()), 2);
}

// Bags of rosbag.js, rosbag2, and kapture. None of them is a drive, and each message states what is missing.
TEST(ForeignBags, AreRefusedWithTheMissingTopics) {
  const fs::path folder = find_recording("foreign_files/bags");
  DVI_SKIP_WITHOUT(folder);
  const std::pair<const char*, const char*> errors[] = {
      {"empty-file.bag", "is empty"},
      {"empty_bag_0.db3", "holds no messages"},
      {"no-messages.bag", "holds no messages"},
      {"example.bag", "no topic of images; it has /rosout (rosgraph_msgs/Log, 10 messages), /tf (tf/tfMessage, 2688 messages)"},
      {"example-bz2.bag", "/turtle1/pose (turtlesim/Pose, 1344 messages)"},
      {"example-lz4.bag", "/turtle1/pose (turtlesim/Pose, 1344 messages)"},
      {"example-unsorted-chunks.bag", "it has foo (std_msgs/String, 3 messages)"},
      {"only_services.mcap", "/add_two_ints/_service_event (example_interfaces/srv/AddTwoInts_Event, 12 messages)"},
      {"t265.bag", "no topic of sensor_msgs/PointCloud2 and none of depth images"},
      {"talker.db3", "/topic (std_msgs/String, 10 messages)"},
      {"talker.mcap", "/topic (std_msgs/String, 10 messages)"},
      {"wrong_rmw_test_0.db3", "/test_topic (test_msgs/BasicTypes, 3 messages)"},
      {"wrong_rmw_test_0.mcap", "/test_topic (test_msgs/BasicTypes, 3 messages)"},
  };
  for (const auto& [file, error] : errors) EXPECT_THAT(bag_error(folder / file), HasSubstr(error)) << file;
}

class ChangedBag : public testing::Test {
 protected:
  // Writes the uncompressed bag with all occurrences of a word replaced by one of the same length.
  fs::path replaced(const std::string& word, const std::string& other) const {
    EXPECT_EQ(word.size(), other.size());
    std::string bytes = read_file(kBags / "without_chunks.mcap");
    for (std::size_t at = bytes.find(word); at != std::string::npos; at = bytes.find(word, at + word.size()))
      bytes.replace(at, word.size(), other);
    return folder.write("changed.mcap", bytes);
  }
  TestFolder folder;
};

TEST_F(ChangedBag, RequiresExtrinsicsWithoutTf) {
  const fs::path bag = replaced("tf2_msgs/msg/TFMessage", "tf2_msgs/msg/Unknown__");
  EXPECT_THAT(bag_error(bag), AllOf(HasSubstr("no tf connects front_optical"), HasSubstr("camera_from_lidar")));
  folder.write("dvi.toml", "[camera.front]\ncamera_from_lidar = [0, -1, 0, 0,  0, 0, -1, 0,  1, 0, 0, 0]\n");
  const Drive drive = read_drive(bag);
  EXPECT_TRUE(drive.poses.empty()) << "the frame of the odometry is unknown";
  EXPECT_THAT(drive.warnings, testing::Contains(HasSubstr("base_link")));
}

TEST_F(ChangedBag, RequiresACalibration) {
  EXPECT_THAT(bag_error(replaced("sensor_msgs/msg/CameraInfo", "sensor_msgs/msg/CameraXXXX")),
              AllOf(HasSubstr("no calibration of /front/image_raw/compressed"), HasSubstr("[camera.front] K")));
}

// The bytes are height, width 32, and the length of "plumb_bob".
TEST_F(ChangedBag, UsesTheSizeOfTheImagesIfTheCalibrationHasNone) {
  const std::string behind = std::string("\x0A\0\0\0plumb_bob", 13), size("\x20\0\0\0\x20\0\0\0", 8);
  const fs::path bag = replaced(size + behind, std::string(8, '\0') + behind);
  for (const char* camera : {"front", "right"}) EXPECT_EQ(read_drive(bag, {.camera = camera}).camera.width, 32) << camera;
}

// Files of @mcap/core with lengths changed to 2^31 bytes and more.
TEST_F(ChangedBag, RefusesRecordsOfGigabytes) {
  std::string bytes = read_file(kBags / "without_chunks.mcap");
  const std::size_t record = 8;
  bytes.replace(record + 1, 8, std::string("\0\0\0\x80\0\0\0\0", 8));
  EXPECT_THAT(bag_error(folder.write("long.mcap", bytes)), AllOf(HasSubstr("byte 8"), HasSubstr("mcap recover")));
  bytes = read_file(kBags / "zstd.mcap");
  const std::size_t name = bytes.find(std::string("\4\0\0\0zstd", 8));
  bytes.replace(name - 12, 8, std::string("\0\0\0\0\4\0\0\0", 8));
  const fs::path unpacked = folder.write("unpacked.mcap", bytes);
  EXPECT_THAT(bag_error(unpacked), AllOf(HasSubstr("cannot be unpacked"), HasSubstr("a size of 17179869184 bytes is stated")));
}

TEST_F(ChangedBag, AllocatesNoMemoryForSparseFilesWithLongRecords) {
  const fs::path file = folder.write("sparse.mcap", std::string("\x89MCAP0\r\n\3\0\0\0\x40\0\0\0\0", 17));
  fs::resize_file(file, std::uintmax_t{1} << 31);
  EXPECT_THAT(bag_error(file), HasSubstr("a record of 1073741824 bytes is larger than the limit of 268435456 bytes"));
  const fs::path bag = folder.write("sparse.bag", std::string("#ROSBAG V2.0\n\0\0\0\x40", 17));
  fs::resize_file(bag, std::uintmax_t{1} << 31);
  EXPECT_THAT(bag_error(bag), HasSubstr("a record of 1073741824 bytes is larger"));
}

TEST_F(ChangedBag, RefusesCamerasThatAreNotPinholes) {
  EXPECT_THAT(bag_error(replaced(std::string("\x0A\0\0\0plumb_bob\0", 14), std::string("\x0A\0\0\0equidista\0", 14))),
              AllOf(HasSubstr("the camera model 'equidista'"), HasSubstr("not supported"), HasSubstr("undistort")))
      << "even if its coefficients are zero";
}

TEST_F(ChangedBag, RefusesCamerasWithoutCalibration) {
  const double fx = 25.6, none = 0;
  const auto bytes_of = [](const double& value) { return std::string(reinterpret_cast<const char*>(&value), sizeof(value)); };
  EXPECT_THAT(bag_error(replaced(bytes_of(fx), bytes_of(none))),
              AllOf(HasSubstr("is not calibrated: K of /front/camera_info is zero"), HasSubstr("[camera.front] K")));
}

TEST_F(ChangedBag, ListsTheTopicsIfThereAreNoScans) {
  EXPECT_THAT(bag_error(replaced("sensor_msgs/msg/PointCloud2", "sensor_msgs/msg/LaserScan2_")),
              AllOf(HasSubstr("no topic of sensor_msgs/PointCloud2"), HasSubstr("/lidar/points")));
}

TEST_F(ChangedBag, IgnoresOtherEncodingsOfMessages) {
  EXPECT_THAT(bag_error(replaced(std::string("\3\0\0\0cdr", 7), std::string("\3\0\0\0xml", 7))),
              HasSubstr("no topic of images"))
      << "only supported encodings count";
}

TEST_F(ChangedBag, ReadsTheNamedTopics) {
  const fs::path bag = kBags / "zstd.mcap";
  EXPECT_EQ(read_drive(bag, {.topics = {"image=/right/image_raw", "poses=/odometry"}}).camera_name, "right");
  EXPECT_THAT(bag_error(bag, {.topics = {"image=/rear"}}), AllOf(HasSubstr("no topic /rear"), HasSubstr("/right/image_raw")));
  EXPECT_THAT(bag_error(bag, {.topics = {"points=/tf"}}), HasSubstr("topic /tf of tf2_msgs/TFMessage"));
  EXPECT_THROW(read_drive(bag, {.topics = {"color=/right/image_raw"}}), UsageError);
}

TEST_F(ChangedBag, RefusesAnEmptyBag) {
  std::string bytes = "\x89MCAP0\r\n";
  bytes += std::string("\x02\x14\0\0\0\0\0\0\0", 9) + std::string(20, '\0') + "\x89MCAP0\r\n";
  EXPECT_THAT(bag_error(folder.write("empty.mcap", bytes)), HasSubstr("holds no messages"));
  EXPECT_THAT(bag_error(folder.write("nothing.bag", "#ROSBAG V2.0\n")), HasSubstr("holds no messages"));
  EXPECT_THAT(bag_error(folder.write("nothing.db3", "no database")), HasSubstr("nothing.db3"));
  for (const char* name : {"empty_file.bag", "empty_file.mcap", "empty_file.db3"})
    EXPECT_THAT(bag_error(folder.write(name, "")), HasSubstr("is empty")) << name;
}

}  // namespace
}  // namespace dvi::datasets
