#include "dvi/datasets/reader.h"

#include <cmath>

#include "dvi/core/text.h"
#include "dvi/testing/find_recording.h"
#include "dvi/testing/image_folder.h"

namespace dvi::datasets {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

// Writes a drive in the `folder` layout: frames 10, 11, 13, 14 and scans 10, 11, 14.
void write_drive(const TestFolder& folder) {
  folder.write("dvi.toml",
               "[camera.front]\nsize=[8,6]\nK=[4,0,4,0,4,3,0,0,1]\ncamera_from_lidar=[0,-1,0,0, 0,0,-1,0, 1,0,0,0]\n");
  for (const char* name : {"10", "11", "13", "14"})
    folder.write_image(std::string("images/front/") + name + ".png", cv::Mat3b(6, 8, cv::Vec3b(1, 2, 3)));
  for (const char* name : {"10", "11", "14"}) folder.write_bin(std::string("lidar/") + name + ".bin", {1, 2, 3, 4});
}

TEST(Reader, CutsToFramesAndTheScansTheyNeed) {
  const TestFolder folder;
  write_drive(folder);
  const Drive all = read_drive(folder.path);
  EXPECT_EQ(all.frames.size(), 4U);
  EXPECT_EQ(all.format, "folder");
  EXPECT_EQ(all.scans.size(), 3U);
  const Drive cut = read_drive(folder.path / "", {.frames = FrameRange{11, 13}});
  ASSERT_EQ(cut.frames.size(), 2U);
  EXPECT_EQ(cut.frames[0].number, 11);
  EXPECT_EQ(cut.images.size(), 2U);
  ASSERT_EQ(cut.scan_headers.size(), 1U);
  EXPECT_EQ(cut.scan_headers[0].name, "11");
  EXPECT_EQ((*cut.images[1])(0, 0), cv::Vec3b(1, 2, 3));
}

TEST(Reader, ReportsTheExistingFrames) {
  const TestFolder folder;
  write_drive(folder);
  for (const FrameRange range : {FrameRange{20, 30}, FrameRange{0, 11}, FrameRange{11, 15}, FrameRange{13, 11}})
    EXPECT_THAT(input_error([&] { read_drive(folder.path, {.frames = range}); }), HasSubstr("it has frames 10:14"));
  EXPECT_THAT(input_error([&] { read_drive(folder.path, {.frames = FrameRange{12, 12}}); }), HasSubstr("no images for frames"));
}

TEST(Reader, ReportsGapsOfTheSelectedFrames) {
  const TestFolder folder;
  write_drive(folder);
  EXPECT_THAT(read_drive(folder.path).warnings, testing::ElementsAre("no image for frames 12", "no scan for frames 13"));
  EXPECT_TRUE(read_drive(folder.path, {.frames = FrameRange{10, 11}}).warnings.empty());
}

TEST(Reader, DoesNotListTheGapBeforeAStrayNumber) {
  const TestFolder folder;
  write_drive(folder);
  folder.write_image("images/front/2000000000.png", cv::Mat3b(6, 8, cv::Vec3b()));
  const std::vector<std::string> warnings = read_drive(folder.path).warnings;
  EXPECT_THAT(warnings, Contains(HasSubstr("frame numbers jump from 14 to 2000000000")));
  for (const std::string& warning : warnings) EXPECT_THAT(warning, testing::Not(HasSubstr("no image for")));
}

TEST(Reader, ListsGapsUpToTheLargestNumber) {
  const TestFolder folder;
  write_drive(folder);
  fs::remove_all(folder.path / "images");
  fs::remove_all(folder.path / "lidar");
  for (const char* name : {"2147483600", "2147483610", "2147483630", "2147483640", "2147483647"}) {
    folder.write_image(std::string("images/front/") + name + ".png", cv::Mat3b(6, 8, cv::Vec3b()));
    folder.write_bin(std::string("lidar/") + name + ".bin", {1, 2, 3, 4});
  }
  EXPECT_THAT(read_drive(folder.path).warnings, testing::ElementsAre("no image for frames 2147483620"));
}

TEST(Reader, RefusesPositionsTooFarAway) {
  const TestFolder folder;
  write_drive(folder);
  folder.write("poses.txt", "10 1 0 0 0 0 1 0 1e300 0 0 1 0\n");
  EXPECT_THAT(input_error([&] { read_drive(folder.path); }), AllOf(HasSubstr("poses.txt"), HasSubstr("is 1e+300 m")));
  fs::remove(folder.path / "poses.txt");
  folder.write("dvi.toml",
               "[camera.front]\nsize=[8,6]\nK=[4,0,4,0,4,3,0,0,1]\ncamera_from_lidar=[0,-1,0,1e9, 0,0,-1,0, 1,0,0,0]\n");
  EXPECT_THAT(input_error([&] { read_drive(folder.path); }), HasSubstr("its camera is 1e+09 m"));
}

TEST(Reader, SuggestsFormatsIfThereIsNoDrive) {
  const TestFolder folder;
  const auto error = [](const fs::path& path) { return input_error([&] { read_drive(path); }); };
  EXPECT_THAT(error(folder.path),
              AllOf(HasSubstr("is empty"), HasSubstr("kitti-raw"), HasSubstr("apolloscape"), HasSubstr("folder")));
  folder.write("notes.txt", "x");
  EXPECT_THAT(error(folder.path), AllOf(HasSubstr("is not a drive in a supported format"), HasSubstr("kitti-raw")));
  make_folder(folder.path / "velodyne");
  make_folder(folder.path / "image_2");
  EXPECT_THAT(error(folder.path), AllOf(HasSubstr("most similar to kitti-odometry"), HasSubstr("lacks calib.txt, times.txt")));
  make_folder(folder.path / "own/lidar");
  EXPECT_THAT(error(folder.path / "own"), AllOf(HasSubstr("most similar to folder, but lacks"), HasSubstr("; dvi init"),
                                                HasSubstr("prepares images and scans")));
  folder.write("loose/1.png", "x");
  EXPECT_THAT(error(folder.path / "loose"),
              AllOf(HasSubstr("holds images"), HasSubstr("images/CAMERA"), HasSubstr("dvi init")));
  folder.write("result/dvi.toml", "[align]\n");
  make_folder(folder.path / "result/.dvi");
  EXPECT_THAT(error(folder.path / "result"),
              AllOf(HasSubstr("is a result of dvi"), HasSubstr("the drive that it was made from")));
  EXPECT_THAT(error(folder.path / "none"), HasSubstr("does not exist"));
  EXPECT_THAT(error(""), HasSubstr("path of the drive is empty"));
  EXPECT_THAT(error(folder.path / "notes.txt"), HasSubstr("is not a recording"));
  make_folder(folder.path / "day/one/images");
  EXPECT_THAT(error(folder.path), HasSubstr("did you mean " + (folder.path / "day/one").string()));
}

TEST(Reader, RefusesBrokenScansBeforeAnyWork) {
  const TestFolder folder;
  write_drive(folder);
  folder.write("lidar/11.bin", "12345");
  EXPECT_THAT(input_error([&] { read_drive(folder.path); }), AllOf(HasSubstr("11.bin"), HasSubstr("5 bytes")));
  folder.write("lidar/11.bin", "");
  EXPECT_THAT(input_error([&] { read_drive(folder.path); }), AllOf(HasSubstr("11.bin"), HasSubstr("no points")));
}

// Returns the mean distance in pixels between the left and right edges of projected boxes and of the labels' rectangles.
double box_error(const Drive& drive) {
  double sum = 0;
  int edges = 0;
  for (const Frame& frame : drive.frames)
    for (const Label& label : frame.labels) {
      if (!label.box || !label.rect) continue;
      double left = 1e9, right = -1e9, nearest = 1e9;
      for (const Eigen::Vector3d& corner : label.box->corners()) {
        const Eigen::Vector3d x = drive.camera_from_lidar * corner;
        const double u = drive.camera.project(x).x();
        left = std::min(left, u), right = std::max(right, u), nearest = std::min(nearest, x.z());
      }
      if (nearest < 1 || left < 0 || right > drive.camera.width) continue;
      sum += std::abs(left - label.rect->x) + std::abs(right - label.rect->br().x), edges += 2;
    }
  return sum / edges;
}

TEST(Recordings, KittiRaw) {
  struct Expected {
    const char* drive;
    std::size_t frames, labels;
    int first;
  };
  for (const Expected& e : {Expected{"kitti_0013/2011_09_26/2011_09_26_drive_0013_sync", 40, 104, 10},
                            Expected{"kitti_0009/2011_09_26/2011_09_26_drive_0009_sync", 35, 294, 0}}) {
    DVI_SKIP_WITHOUT(find_recording(e.drive));
    const Drive drive = read_drive(find_recording(e.drive));
    EXPECT_EQ(drive.format, "kitti-raw");
    EXPECT_EQ(drive.frames.size(), e.frames);
    EXPECT_EQ(drive.frames.front().number, e.first);
    EXPECT_EQ(drive.scan_headers.size(), e.frames);
    EXPECT_EQ(drive.poses.poses().size(), e.frames);
    EXPECT_TRUE(drive.warnings.empty());
    std::size_t labels = 0;
    for (const Frame& frame : drive.frames) labels += frame.labels.size();
    EXPECT_EQ(labels, e.labels);
    EXPECT_LT(box_error(drive), 0.5);
    EXPECT_EQ(drive.images[2]->size(), cv::Size(1242, 375));
    const auto scan = drive.scans[2];
    EXPECT_GT(scan->size(), 100'000U);
    EXPECT_NEAR(*std::max_element(scan->time.begin(), scan->time.end()), 0.052, 1e-3);
  }
}

// Returns the pose of a line "time, camera_from_world 3x4, ...".
SE3 true_pose(const TextLine& line) {
  SE3 pose;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) {
      const double value = line.number(static_cast<std::size_t>(1 + 4 * row + column));
      (column < 3 ? pose.R(row, column) : pose.t(row)) = value;
    }
  return pose;
}

TEST(Recordings, ApolloscapeHasTheTruePoses) {
  const fs::path path = find_recording("apolloscape_street");
  DVI_SKIP_WITHOUT(path);
  const Drive drive = read_drive(path);
  EXPECT_EQ(drive.format, "apolloscape");
  EXPECT_EQ(drive.scan_headers.size(), 22U);
  EXPECT_EQ(drive.masks.size(), 22U);
  EXPECT_TRUE(drive.warnings.empty());
  const std::vector<TextLine> truth = read_text_lines(path / "gt_poses.txt");
  ASSERT_EQ(drive.frames.size(), truth.size());
  const auto camera_from_world = [&](std::size_t i) {
    return drive.camera_from_lidar * drive.poses.at(drive.frames[i].time_ns).value().inverse();
  };
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const SE3 motion = camera_from_world(i) * camera_from_world(0).inverse();
    const SE3 error = motion * (true_pose(truth[i]) * true_pose(truth[0]).inverse()).inverse();
    EXPECT_LT(so3_log(nearest_rotation(error.R)).norm() * 180 / std::numbers::pi, 1e-3) << i;
    EXPECT_LT(error.t.norm(), 1e-3) << i;
  }
}

}  // namespace
}  // namespace dvi::datasets
