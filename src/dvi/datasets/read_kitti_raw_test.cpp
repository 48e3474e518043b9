#include <cmath>

#include <fmt/format.h>

#include "dvi/datasets/reader.h"
#include "dvi/testing/image_folder.h"

namespace dvi::datasets {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

constexpr const char* kDrive = "2011_09_26/2011_09_26_drive_0001_sync";

std::string file_name(int number, const char* ending) { return fmt::format("{:010d}.{}", number, ending); }

// Returns one line per 0.1 s for frames 0-29, `shift` seconds late.
std::string stamps(double shift) {
  std::string text;
  for (int i = 0; i < 30; ++i) text += fmt::format("2011-09-26 13:00:{:012.9f}\n", 10 + 0.1 * i + shift);
  return text;
}

// Frames 20-24 of a drive to the north at 10 m/s. The IMU is 1 m above the LiDAR, image_02 6 cm to the left of camera 0.
class KittiRaw : public testing::Test {
 protected:
  KittiRaw() : drive(folder.path / kDrive) {
    write_calibration();
    put("image_02/timestamps.txt", stamps(0));
    put("oxts/timestamps.txt", stamps(0.01));
    put("velodyne_points/timestamps_start.txt", stamps(-0.05));
    put("velodyne_points/timestamps_end.txt", stamps(0.05));
    for (int i = 20; i < 25; ++i) {
      folder.write_image(fs::path(kDrive) / "image_02/data" / file_name(i, "png"), cv::Mat3b(6, 8, cv::Vec3b(9, 9, 9)));
      folder.write_bin(fs::path(kDrive) / "velodyne_points/data" / file_name(i, "bin"), {1, 0, 0, 0.5F, 0, 1, 0, 0.5F});
      put("oxts/data/" + file_name(i, "txt"),
          fmt::format("{:.12f} 8.4 110 0 0 {:.12f} 1 2 3\n", 49 + (i - 20) / 111319.490793, std::numbers::pi / 2));
    }
  }
  void write_calibration() const {
    put("../calib_cam_to_cam.txt",
        "calib_time: now\nS_rect_02: 8 6\nR_rect_00: 1 0 0 0 1 0 0 0 1\nP_rect_02: 4 0 4 0.24 0 4 3 0 0 0 1 0\n"
        "P_rect_03: 4 0 4 -2 0 4 3 0 0 0 1 0\nS_rect_03: 8 6\n");
    put("../calib_velo_to_cam.txt", "R: 0 -1 0 0 0 -1 1 0 0\nT: 0 0 0\n");
    put("../calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: 0 0 1\n");
  }
  void put(const std::string& name, const std::string& text) const {
    folder.write((fs::path(kDrive) / name).lexically_normal(), text);
  }
  void drop(const std::string& name) const { fs::remove(drive / name); }
  std::string error(const ReadOptions& options = {}) const {
    return input_error([&] { read_drive(drive, options); });
  }

  TestFolder folder;
  fs::path drive;
};

TEST_F(KittiRaw, ReadsAnExcerpt) {
  const Drive read = read_drive(drive);
  EXPECT_EQ(read.format, "kitti-raw");
  EXPECT_EQ(read.camera_name, "image_02");
  EXPECT_TRUE(read.warnings.empty()) << read.warnings[0];
  ASSERT_EQ(read.frames.size(), 5U);
  EXPECT_EQ(read.frames[0].number, 20);
  EXPECT_EQ(read.frames[0].name, "0000000020");
  EXPECT_EQ(read.frames[0].time_ns % 60'000'000'000, 12'000'000'000);
  ASSERT_EQ(read.scan_headers.size(), 5U);
  EXPECT_EQ(read.scan_headers[0].time_ns, read.frames[0].time_ns);
  EXPECT_EQ(read.scan_headers[0].end_ns - read.scan_headers[0].start_ns, 100'000'000);
  // A point straight ahead is 6 cm to the right of the camera's center at f = 4.
  const Eigen::Vector3d ahead = read.camera_from_lidar * Eigen::Vector3d(6, 0, 0);
  EXPECT_TRUE(ahead.isApprox(Eigen::Vector3d(0.06, 0, 6)));
  const auto scan = read.scans[0];
  EXPECT_FLOAT_EQ(scan->time[0], 0);
  EXPECT_FLOAT_EQ(scan->time[1], -0.025F);
}

TEST_F(KittiRaw, ReadsPosesOfOxtsInAbsoluteMercatorMeters) {
  const Drive read = read_drive(drive);
  EXPECT_NEAR(read.world_scale, std::cos(49 * std::numbers::pi / 180), 1e-12);
  const auto& poses = read.poses.poses();
  ASSERT_EQ(poses.size(), 5U);
  EXPECT_EQ(poses[0].time_ns, read.frames[0].time_ns + 10'000'000);
  const SE3 motion = poses[0].world_from_body.inverse() * poses[4].world_from_body;
  EXPECT_NEAR(motion.t.x(), 4, 1e-4);
  EXPECT_NEAR(motion.t.y(), 0, 1e-4);
  EXPECT_NEAR(poses[0].world_from_body.t.x(), read.world_scale * 6378137 * 8.4 * std::numbers::pi / 180, 1e-5);
  EXPECT_NEAR(poses[0].world_from_body.t.z(), 109, 1e-9);
}

// A receiver without a fix writes arbitrary positions: here one beyond the equator, whose latitude would set the scale.
TEST_F(KittiRaw, IgnoresOutliersAmongPackets) {
  const SE3 right = *read_drive(drive).poses.at(read_drive(drive).frames[2].time_ns);
  for (const int far : {20, 22}) {
    const std::string name = "oxts/data/" + file_name(far, "txt"), good = read_file(drive / name);
    put(name, "-1 8.4 110 0 0 1.570796326794897 1 2 3\n");
    const Drive read = read_drive(drive);
    EXPECT_NEAR(read.world_scale, std::cos(49 * std::numbers::pi / 180), 1e-6);
    ASSERT_EQ(read.poses.poses().size(), 4U);
    EXPECT_EQ(read.fixes.size(), 4U);
    EXPECT_LT((read.poses.at(read.frames[2].time_ns)->t - right.t).norm(), 10) << "interpolated, at nearly the same scale";
    EXPECT_THAT(read.warnings, testing::ElementsAre(AllOf(HasSubstr("1 of 5 oxts packets"), HasSubstr(name))));
    put(name, good);
  }
}

TEST_F(KittiRaw, SelectsCamerasByNumber) {
  put("image_03/timestamps.txt", stamps(0));
  folder.write_image(fs::path(kDrive) / "image_03/data" / file_name(21, "png"), cv::Mat3b(6, 8, cv::Vec3b()));
  for (const char* name : {"3", "03", "image_03"}) EXPECT_EQ(read_drive(drive, {.camera = name}).camera_name, "image_03");
  EXPECT_EQ(read_drive(drive).camera_names.size(), 2U);
  EXPECT_THAT(error({.camera = "1"}), HasSubstr("it has image_02, image_03"));
}

TEST_F(KittiRaw, ReportsGaps) {
  drop("image_02/data/" + file_name(21, "png"));
  drop("velodyne_points/data/" + file_name(22, "bin"));
  drop("velodyne_points/data/" + file_name(23, "bin"));
  drop("oxts/data/" + file_name(22, "txt"));
  EXPECT_THAT(read_drive(drive).warnings,
              testing::ElementsAre("no image for frames 21", "no scan for frames 22-23", "no oxts packet for frames 22"));
}

TEST_F(KittiRaw, ReportsScansWithoutImagesAtTheEnds) {
  drop("image_02/data/" + file_name(20, "png"));
  drop("image_02/data/" + file_name(24, "png"));
  EXPECT_THAT(read_drive(drive).warnings, testing::ElementsAre("no image for scans 20, 24"));
  EXPECT_TRUE(read_drive(drive, {.frames = FrameRange{21, 22}}).warnings.empty());
}

TEST_F(KittiRaw, RefusesCalibrationThatIsMissingOrMalformed) {
  for (const char* name : {"calib_cam_to_cam.txt", "calib_velo_to_cam.txt", "calib_imu_to_velo.txt"}) {
    fs::remove(drive.parent_path() / name);
    EXPECT_THAT(error(), AllOf(HasSubstr(name), HasSubstr("is missing")));
    write_calibration();
  }
  put("../calib_cam_to_cam.txt", "R_rect_00: 1 0 0 0 1 0 0 0 1\n");
  EXPECT_THAT(error(), AllOf(HasSubstr("calib_cam_to_cam.txt"), HasSubstr("no entry P_rect_02")));
  put("../calib_cam_to_cam.txt", "R_rect_00: 1 0 0 0 1 0 0 0 1\nP_rect_02: 4 0 4\n");
  EXPECT_THAT(error(), HasSubstr("calib_cam_to_cam.txt:2: P_rect_02 does not have 12 numbers"));
  write_calibration();
  put("../calib_velo_to_cam.txt", "R: 0 -1 0 0 zero -1 1 0 0\nT: 0 0 0\n");
  EXPECT_THAT(error(), HasSubstr("calib_velo_to_cam.txt:1: 'zero' is not a number"));
}

TEST_F(KittiRaw, RefusesImplausibleCalibration) {
  const auto with = [&](const char* name, const char* text) {
    put(name, text);
    const std::string message = error();
    write_calibration();
    return message;
  };
  EXPECT_THAT(with("../calib_velo_to_cam.txt", "R: 0 0 0 0 0 0 0 0 0\nT: 0 0 0\n"),
              HasSubstr("calib_velo_to_cam.txt: R does not hold a rotation"));
  EXPECT_THAT(with("../calib_velo_to_cam.txt", "R: 0 1 0 0 0 -1 1 0 0\nT: 0 0 0\n"), HasSubstr("it mirrors"));
  const std::string rest = "R_rect_00: 1 0 0 0 1 0 0 0 1\nP_rect_02: ";
  const auto camera = [&](const char* P) { return with("../calib_cam_to_cam.txt", (rest + P + "\nS_rect_02: 8 6\n").c_str()); };
  EXPECT_THAT(camera("4 0 4 0 0 4 3 0 0 0 0 0"), HasSubstr("P_rect_02 has 0 0 0 as its last row"));
  EXPECT_THAT(camera("1e12 0 4 0 0 4 3 0 0 0 1 0"), HasSubstr("calib_cam_to_cam.txt: P_rect_02: fx = 1e+12 px"));
}

TEST_F(KittiRaw, RefusesBrokenOxts) {
  const std::string packet = "oxts/data/" + file_name(22, "txt");
  put(packet, "");
  EXPECT_THAT(error(), HasSubstr("0000000022.txt:1: the line is empty"));
  put(packet, "\n");
  EXPECT_THAT(error(), HasSubstr("0000000022.txt:1: the line is empty"));
  put(packet, "49 8.4 north 0 0 0\n");
  EXPECT_THAT(error(), HasSubstr("0000000022.txt:1: 'north' is not a number"));
  put(packet, "49 8.4 110\n");
  EXPECT_THAT(error(), HasSubstr("0000000022.txt:1: has only 3 entries"));
}

TEST_F(KittiRaw, RefusesBrokenTimestamps) {
  put("image_02/timestamps.txt", "2011-09-26 13:00:10.0\n");
  EXPECT_THAT(error(), AllOf(HasSubstr("image_02/timestamps.txt"), HasSubstr("ends before line 21")));
  std::string text = stamps(0);
  text.replace(text.find("13:00:12.2"), 8, "yesterda");
  put("image_02/timestamps.txt", text);
  EXPECT_THAT(error(), HasSubstr("timestamps.txt:23:"));
  text = stamps(0);
  put("image_02/timestamps.txt", text.substr(0, text.find("13:00:12.4") + 10));
  EXPECT_THAT(error(), AllOf(HasSubstr("timestamps.txt:25:"), HasSubstr("is truncated")));
  drop("image_02/timestamps.txt");
  EXPECT_THAT(error(), HasSubstr("image_02/timestamps.txt: is missing"));
}

TEST_F(KittiRaw, RefusesImagesThatDifferInSizeWhenDecoded) {
  folder.write_image(fs::path(kDrive) / "image_02/data" / file_name(22, "png"), cv::Mat3b(5, 8, cv::Vec3b()));
  const Drive read = read_drive(drive);
  EXPECT_THAT(input_error([&] { read.images[2]; }), AllOf(HasSubstr("0000000022.png"), HasSubstr("8x5 pixels instead of 8x6")));
}

TEST_F(KittiRaw, RefusesUnrectifiedImages) {
  const fs::path extract = folder.path / "2011_09_26/2011_09_26_drive_0001_extract";
  fs::copy(drive, extract, fs::copy_options::recursive);
  EXPECT_EQ(read_drive(extract).frames.size(), 5U) << "the user may have rectified them";
  folder.write_image(extract / "image_02/data" / file_name(20, "png"), cv::Mat3b(10, 13, cv::Vec3b()));
  EXPECT_THAT(input_error([&] { read_drive(extract); }), AllOf(HasSubstr("13x10 pixels as recorded"), HasSubstr("_sync")));
}

TEST_F(KittiRaw, SuggestsTheDriveInTheFolderOfADay) {
  EXPECT_THAT(input_error([&] { read_drive(drive.parent_path()); }), HasSubstr("did you mean " + drive.string()));
}

TEST_F(KittiRaw, LetsDviTomlOverrideCalibrationAndClocks) {
  put("dvi.toml", "[camera.image_02]\nK=[5,0,4,0,5,3,0,0,1]\noffset_s=0.002\n[lidar]\noffset_s=-0.001\n");
  const Drive read = read_drive(drive);
  EXPECT_EQ(read.camera.fx, 5);
  EXPECT_EQ(read.frames[0].time_ns - read.scan_headers[0].time_ns, 3'000'000);
  EXPECT_THAT(read.other_files, Contains(drive / "dvi.toml"));
  put("dvi.toml", "[camera.front]\noffset_s=0.002\n");
  EXPECT_THAT(error(), AllOf(HasSubstr("[camera.front]"), HasSubstr("it has image_02")));
}

TEST_F(KittiRaw, ReadsLabelsBesideTheImages) {
  put("tracking_labels.txt", "21 3 Car 0 0 0 1 0 3 2 1.5 1.6 4.0 -2 1.7 10 -1.5707963267948966\n");
  const Drive read = read_drive(drive);
  ASSERT_EQ(read.frames[1].labels.size(), 1U);
  EXPECT_TRUE(read.frames[1].labels[0].box->frame_from_box.t.isApprox(Eigen::Vector3d(10, 2, -0.95)));
  EXPECT_TRUE(read.labeled);
  // Frames 0-29 were recorded, of which 20-24 exist.
  EXPECT_THAT(read.warnings, testing::ElementsAre("tracking_labels.txt ends early: it has no labels for frames 22-24"));
  const std::string car = " 3 Car 0 0 0 1 0 3 2 1.5 1.6 4.0 -2 1.7 10 0\n";
  put("tracking_labels.txt", "24" + car + "29" + car + "30" + car);
  EXPECT_THAT(read_drive(drive).warnings,
              testing::ElementsAre("tracking_labels.txt labels 1 frames that the drive does not have, first 30: its frames are "
                                   "30, those of the drive are 0 to 29"));
}

}  // namespace
}  // namespace dvi::datasets
