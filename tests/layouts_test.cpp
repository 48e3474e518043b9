#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/core/files.h"
#include "dvi/media/image_file.h"
#include "program.h"

namespace dvi {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::string kKitti360 = "2013_05_28_drive_0000_sync";

/// Reads one drive in the layouts of several data sets, written by a script that is independent of dvi.
class Layouts : public ProgramTest {
 protected:
  /// Makes a drive whose scans are declared to be motion-compensated, as in all of these data sets except KITTI-360.
  fs::path compensated_drive() const {
    const fs::path drive = small_drive();
    std::string config = read_file(drive / "dvi.toml");
    config.replace(config.find("\"clockwise\""), 11, "\"none\"");
    write_file(drive / "dvi.toml", config);
    return drive;
  }
  void write_layout(const std::string& layout, const std::string& out) const {
    const Result written = shell(fmt::format("python3 -B {} {} drive {}", DVI_LAYOUTS, layout, out));
    ASSERT_EQ(written.code, 0) << written.err;
  }
  /// Returns the frames of a run with mask files, because the layouts store labels differently.
  std::vector<cv::Mat3b> frames_of(const std::string& drive) const {
    fs::remove_all(folder / "out");
    const Result run = dvi(fmt::format("run {} -o out --masks masks --poses given --quiet", drive));
    EXPECT_EQ(run.code, 0) << run.err;
    std::vector<cv::Mat3b> frames;
    for (const fs::path& file : list_files(folder / "out/frames", {".png"})) frames.push_back(media::read_image(file, kSize));
    return frames;
  }
  /// Copies the drive's masks with the names of another layout's images.
  void name_masks(const std::function<std::string(int)>& name) const {
    fs::create_directories(folder / "masks");
    for (int i = 0; i < 6; ++i)
      fs::copy_file(folder / fmt::format("drive/masks/front/{:06d}.png", i), folder / "masks" / (name(i) + ".png"),
                    fs::copy_options::overwrite_existing);
  }
  /// Expects equal frames, except for `off` color values per frame that differ by one level. Poses that are stored as
  /// quaternions change the rounding of some values.
  void expect_same_frames(const std::string& drive, const std::function<std::string(int)>& name, int off = 0) const {
    name_masks([](int i) { return fmt::format("{:06d}", i); });
    name_masks(name);
    const auto expected = frames_of("drive"), found = frames_of(drive);
    ASSERT_EQ(expected.size(), 6U);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_LE(cv::norm(found[i], expected[i], cv::NORM_INF), 1) << i;
      EXPECT_LE(cv::norm(found[i], expected[i], cv::NORM_L1), off) << i;
    }
  }
  nlohmann::json check(const std::string& drive) const {
    const Result check = dvi("check " + drive + " --json --quiet");
    EXPECT_EQ(check.code, 0) << check.err;
    return nlohmann::json::parse(check.out);
  }
  void expect_refused(const std::string& drive, const std::string& words) const {
    const Result refused = dvi("check " + drive + " --quiet");
    EXPECT_EQ(refused.code, 3);
    EXPECT_THAT(refused.err, HasSubstr(words));
  }
};

TEST_F(Layouts, KittiOdometry) {
  compensated_drive();
  write_layout("kitti-odometry", "kitti");
  EXPECT_EQ(check("kitti/sequences/00")["format"], "kitti-odometry");
  expect_same_frames("kitti/sequences/00", [](int i) { return fmt::format("{:06d}", i); });

  const fs::path calib = folder / "kitti/sequences/00/calib.txt", poses = folder / "kitti/poses/00.txt";
  const std::string whole = read_file(calib), lines = read_file(poses);
  write_file(poses, lines.substr(0, lines.find('\n') + 1));
  expect_refused("kitti/sequences/00", "00.txt: ends before line 2");
  write_file(calib, whole.substr(0, whole.find("Tr:")));
  expect_refused("kitti/sequences/00", "has no entry Tr");
}

TEST_F(Layouts, Kitti360) {
  small_drive();
  write_layout("kitti-360", "kitti");
  const std::string drive = "kitti/data_2d_raw/" + kKitti360;
  const nlohmann::json found = check(drive);
  EXPECT_EQ(found["format"], "kitti-360");
  EXPECT_EQ(found["masks"]["source"], "labels");
  EXPECT_LT(found["masks"]["mean_share"], 0.4) << "of its boxes, those of traffic";
  expect_same_frames(drive, [](int i) { return fmt::format("{:010d}", i); });

  const fs::path boxes = folder / "kitti/data_3d_bboxes/train" / (kKitti360 + ".xml");
  const std::string whole = read_file(boxes);
  write_file(boxes, whole.substr(0, whole.size() / 2));
  expect_refused(drive, "is not valid XML");
}

TEST_F(Layouts, Nuscenes) {
  compensated_drive();
  write_layout("nuscenes", "nuscenes");
  const nlohmann::json found = check("nuscenes/scene-0061");
  EXPECT_EQ(found["format"], "nuscenes");
  EXPECT_EQ(found["masks"]["source"], "labels");
  const auto name = [](int i) { return fmt::format("n001__CAM_FRONT__{}", 1000050000 + 100000 * i); };
  expect_same_frames("nuscenes/scene-0061", name, 3);
  expect_refused("nuscenes", "select a scene, such as ");
  expect_refused("nuscenes/scene-0063", "has no scene scene-0063");
}

TEST_F(Layouts, NuscenesBoxesAreInterpolatedBetweenKeyFrames) {
  compensated_drive();
  write_layout("nuscenes", "nuscenes");
  ASSERT_EQ(dvi("convert nuscenes/scene-0061 -o plain --quiet").code, 0);
  const auto boxes = [&](const char* drive) {
    return nlohmann::json::parse(read_file(folder / drive / "boxes.json"))["frames"];
  };
  const nlohmann::json expected = boxes("drive")["000003"], found = boxes("plain")["n001__CAM_FRONT__1000350000"];
  ASSERT_EQ(found.size(), expected.size());
  for (const nlohmann::json& box : expected)
    EXPECT_TRUE(std::any_of(found.begin(), found.end(), [&](const nlohmann::json& other) {
      double distance = 0;
      for (int axis = 0; axis < 3; ++axis)
        distance += std::abs(other["center"][axis].get<double>() - box["center"][axis].get<double>());
      return distance < 0.1;  // the motion of the vehicles is not uniform
    })) << box;
}

TEST_F(Layouts, ANuscenesTableWithAMissingToken) {
  compensated_drive();
  write_layout("nuscenes", "nuscenes");
  const fs::path tables = folder / "nuscenes/v1.0-mini";
  const std::string poses = read_file(tables / "ego_pose.json");
  std::string other = poses;
  other.replace(other.find("ego 000002"), 10, "ego 999999");
  write_file(tables / "ego_pose.json", other);
  expect_refused("nuscenes/scene-0061", "sample_data.json: refers to token 'ego 000002', which ego_pose.json does not have");
  write_file(tables / "ego_pose.json", poses.substr(0, poses.size() / 2));
  expect_refused("nuscenes/scene-0061", "ego_pose.json");
  write_file(tables / "ego_pose.json", poses);
  fs::remove(folder / "nuscenes/sweeps/CAM_FRONT/n001__CAM_FRONT__1000250000.png");
  expect_refused("nuscenes/scene-0061", "which does not exist");
}

// LIDAR_TOP scans have 20 bytes per point and any number of points.
TEST_F(Layouts, NuscenesScansOfAnySize) {
  compensated_drive();
  write_layout("nuscenes", "nuscenes");
  const std::vector<fs::path> scans = list_files(folder / "nuscenes/sweeps/LIDAR_TOP", {".bin"});
  ASSERT_EQ(scans.size(), 4U);
  for (std::size_t i = 0; i < scans.size(); ++i) fs::resize_file(scans[i], fs::file_size(scans[i]) / 20 * 20 - 20 * i);
  EXPECT_EQ(check("nuscenes/scene-0061")["scans"]["count"], 6);
  fs::remove(scans[1]);
  const nlohmann::json bridged = check("nuscenes/scene-0061");
  EXPECT_EQ(bridged["scans"]["count"], 5);
  EXPECT_THAT(bridged["warnings"].dump(),
              HasSubstr("sample_data.json: 1 of 6 scans that it refers to are missing; the first is "
                        "sweeps/LIDAR_TOP/" +
                        scans[1].filename().string()));
  fs::resize_file(scans[2], 1006);
  expect_refused("nuscenes/scene-0061", "1006 bytes are not a whole number of points of 20 bytes");
  fs::remove_all(folder / "nuscenes/sweeps/LIDAR_TOP");
  fs::remove_all(folder / "nuscenes/samples/LIDAR_TOP");
  expect_refused("nuscenes/scene-0061", "6 of 6 scans that it refers to are missing");
}

}  // namespace
}  // namespace dvi
