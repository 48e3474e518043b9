// Small recordings as their publishers offer them, if they are available: $DVI_DATA/foreign_files.

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/datasets/colmap_model.h"
#include "dvi/datasets/pose_file.h"
#include "dvi/datasets/reader.h"
#include "dvi/testing/find_recording.h"
#include "dvi/testing/image_folder.h"

namespace dvi::datasets {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

// The benchmark writes times like "1.041284e-01" into times.txt.
TEST(ForeignRecordings, ReadKittiOdometry) {
  const fs::path path = find_recording("foreign_files/kitti_odometry/sequences/04");
  DVI_SKIP_WITHOUT(path);
  const Drive drive = read_drive(path);
  EXPECT_EQ(drive.format, "kitti-odometry");
  ASSERT_EQ(drive.frames.size(), 3U);
  EXPECT_EQ(drive.frames[0].time_ns, 0);
  EXPECT_EQ(drive.frames[1].time_ns, 104'128'400);
  EXPECT_EQ(drive.frames[2].time_ns, 208'253'600);
  EXPECT_EQ(drive.scan_headers[2].time_ns, 208'253'600);
  EXPECT_EQ(drive.poses.poses().size(), 3U);
  EXPECT_TRUE(drive.warnings.empty());
  EXPECT_EQ(read_drive(path, {.camera = "3"}).camera_name, "image_3");
}

// The excerpt has the numbers 3000 to 3002 and a timestamps.txt of 1,031 lines.
TEST(ForeignRecordings, ReadKitti360WithTimesOfAnotherExcerpt) {
  const fs::path path = find_recording("foreign_files/kitti_360/data_2d_raw/2013_05_28_drive_0007_sync");
  DVI_SKIP_WITHOUT(path);
  const Drive drive = read_drive(path);
  ASSERT_EQ(drive.frames.size(), 3U);
  EXPECT_EQ(drive.frames[0].number, 3000);
  EXPECT_NEAR(1e-9 * static_cast<double>(drive.frames[1].time_ns - drive.frames[0].time_ns), 0.1046, 1e-4);
  EXPECT_EQ(drive.scan_headers[2].time_ns, drive.frames[2].time_ns);
  EXPECT_THAT(drive.warnings, Contains(AllOf(HasSubstr("timestamps.txt has 1031 lines and none for 0000003000.png"),
                                             HasSubstr("another excerpt"))));
}

// A point at the left is in the image of the fisheye camera that looks to the left.
TEST(ForeignRecordings, ReadFisheyeCamerasOfKitti360) {
  const fs::path path = find_recording("foreign_files/kitti_360/data_2d_raw/2013_05_28_drive_0007_sync");
  DVI_SKIP_WITHOUT(path);
  const TestFolder folder;
  fs::copy(path.parent_path().parent_path(), folder.path / "kitti", fs::copy_options::recursive);
  const fs::path drive_path = folder.path / "kitti/data_2d_raw" / path.filename();
  for (const char* name : {"0000003000", "0000003001", "0000003002"})
    folder.write_image("kitti/data_2d_raw/" + path.filename().string() + "/image_02/data_rgb/" + name + ".png",
                       cv::Mat3b(1400, 1400, cv::Vec3b::all(90)));
  fs::copy(path / "image_00/timestamps.txt", drive_path / "image_02/timestamps.txt");
  const Drive drive = read_drive(drive_path, {.camera = "image_02"});
  EXPECT_EQ(drive.camera_names, (std::vector<std::string>{"image_00", "image_02"}));
  EXPECT_EQ(drive.camera.model, CameraModel::unified);
  EXPECT_NEAR(drive.camera.xi, 2.2134, 1e-4);
  EXPECT_EQ(drive.frames.size(), 3U);
  const Eigen::Vector3d left(0, 20, -1), at = drive.camera_from_lidar * left, behind = drive.camera_from_lidar * -left;
  ASSERT_TRUE(drive.camera.in_front(at));
  EXPECT_LT((drive.camera.project(at) - Eigen::Vector2d(717, 735)).norm(), 60) << drive.camera.project(at).transpose();
  EXPECT_FALSE(drive.camera.in_front(behind));
  write_file(folder.path / "kitti/calibration/image_02.yaml", "%YAML:1.0\n---\nimage_width: 1400\n");
  try {
    read_drive(drive_path, {.camera = "image_02"});
    ADD_FAILURE() << "a calibration without a lens was read";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("image_02.yaml"), HasSubstr("has no number")));
  }
}

TEST(ForeignRecordings, ReadTumRgbd) {
  const fs::path path = find_recording("foreign_files/tum_fr1_rpy");
  DVI_SKIP_WITHOUT(path);
  const Drive drive = read_drive(path);
  EXPECT_EQ(drive.format, "tum-rgbd");
  ASSERT_EQ(drive.frames.size(), 20U);
  EXPECT_EQ(drive.frames[0].time_ns, 1305031229'528748000);
  EXPECT_EQ(drive.scan_headers.size(), 20U);
}

// evo_traj --save_as_tum writes poses by numpy.savetxt with "%.18e".
TEST(ForeignRecordings, ReadTumPosesInScientificNotation) {
  const fs::path path = find_recording("foreign_files/tum_fr1_rpy");
  DVI_SKIP_WITHOUT(path);
  const TestFolder folder;
  std::string text;
  for (const Frame& frame : read_drive(path).frames)
    text += fmt::format(
        "{:.18e} 1.335700000000000010e+00 6.697999999999999510e-01 -1.618000000000000105e+00 "
        "0.000000000000000000e+00 0.000000000000000000e+00 0.000000000000000000e+00 1.000000000000000000e+00\n",
        1e-9 * static_cast<double>(frame.time_ns));
  const Drive drive = read_drive(path);
  const Trajectory poses = read_poses(folder.write("traj.txt", text), drive);
  ASSERT_EQ(poses.poses().size(), 20U);
  EXPECT_NEAR(static_cast<double>(poses.poses()[3].time_ns - drive.frames[3].time_ns), 0, 300) << "the precision of a double";
  EXPECT_EQ(poses.poses()[3].world_from_body.t.z(), -1.618);
}

// The model has 50 images that are named by times ("9.307.png"); the images themselves are not included.
TEST(ForeignRecordings, ReadColmap) {
  const fs::path path = find_recording("foreign_files/colmap_sparse");
  DVI_SKIP_WITHOUT(path);
  EXPECT_THAT(input_error([&] { read_drive(path); }),
              AllOf(HasSubstr("colmap_sparse: holds a COLMAP model, but no folder images/"), HasSubstr("sparse/0")));
  const ColmapModel model = read_colmap_model(path / "0");
  EXPECT_EQ(model.images.size(), 50U);
  ASSERT_EQ(model.cameras.size(), 1U);
  const Camera& camera = model.cameras.begin()->second;
  EXPECT_EQ(camera.width, 640);
  EXPECT_NEAR(camera.fx, 525.35, 0.01);
  EXPECT_NE(camera.distortion[0], 0);
  EXPECT_GT(read_colmap_points(path / "0/points3D.bin").points.size(), 1000U);

  const TestFolder workspace;
  make_folder(workspace.path / "sparse");
  fs::copy(path / "0", workspace.path / "sparse/0");
  for (const ColmapImage& image : model.images) workspace.write_image("images/" + image.name, cv::Mat3b(480, 640, cv::Vec3b()));
  const Drive drive = read_drive(workspace.path);
  ASSERT_EQ(drive.frames.size(), 50U);
  for (std::size_t i = 1; i < drive.frames.size(); ++i)
    EXPECT_LT(std::stod(drive.frames[i - 1].name), std::stod(drive.frames[i].name)) << "in order of time";
  EXPECT_EQ(drive.poses.poses().size(), 50U);
}

}  // namespace
}  // namespace dvi::datasets
