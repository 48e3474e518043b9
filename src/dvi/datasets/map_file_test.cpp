#include <bit>
#include <cmath>

#include "dvi/datasets/colmap_model.h"
#include "dvi/datasets/map_file.h"
#include "dvi/datasets/reader.h"
#include "dvi/media/point_cloud.h"
#include "dvi/media/write_ply.h"
#include "dvi/testing/find_recording.h"
#include "dvi/testing/image_folder.h"

namespace dvi::datasets {
namespace {

using testing::AllOf;
using testing::HasSubstr;

template <class T>
std::string packed(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof(T)};
}

// Coordinates of a map projection: floats would have errors of decimeters.
const Eigen::Vector3d kFar(456'789.125, 5'412'345.25, 345.5);

std::string las_header(int minor, int format, std::uint16_t record, std::uint32_t points) {
  std::string out = "LASF" + std::string(20, '\0') + std::string(1, '\1') + std::string(1, static_cast<char>(minor));
  out.resize(94, '\0');
  const std::uint16_t size = minor == 4 ? 375 : 227;
  out += packed(size) + packed<std::uint32_t>(size) + packed<std::uint32_t>(0) + std::string(1, static_cast<char>(format)) +
         packed(record);
  out += packed<std::uint32_t>(minor == 4 ? 0 : points) + std::string(20, '\0');
  for (int k = 0; k < 3; ++k) out += packed(0.001);
  for (int k = 0; k < 3; ++k) out += packed(1000 * std::floor(kFar[k] / 1000));
  out.resize(size, '\0');
  if (minor == 4) out.replace(247, 8, packed<std::uint64_t>(points));
  return out;
}

std::string las_point(const Eigen::Vector3d& position, std::uint16_t record) {
  std::string out;
  for (int k = 0; k < 3; ++k)
    out += packed(static_cast<std::int32_t>(std::lround((position[k] - 1000 * std::floor(kFar[k] / 1000)) / 0.001)));
  out += packed<std::uint16_t>(65535);
  out.resize(record, '\0');
  return out;
}

void expect_far_points(const media::PointCloud& cloud) {
  ASSERT_EQ(cloud.points.size(), 2U);
  EXPECT_LT((cloud.origin - kFar).norm(), 1e-9);
  EXPECT_EQ(cloud.points[0], Eigen::Vector3f(0, 0, 0));
  EXPECT_LT((cloud.points[1] - Eigen::Vector3f(0.25F, -0.125F, 0)).norm(), 1e-6F);
}

TEST(GivenMap, KeepsTheMillimetersOfAMapProjection) {
  const TestFolder folder;
  const Eigen::Vector3d second = kFar + Eigen::Vector3d(0.25, -0.125, 0);
  for (const auto& [minor, format, record] : {std::tuple{0, 0, 20}, {2, 3, 34}, {4, 6, 30}}) {
    const auto bytes = static_cast<std::uint16_t>(record);
    expect_far_points(media::read_map_cloud(
        folder.write("a.las", las_header(minor, format, bytes, 2) + las_point(kFar, bytes) + las_point(second, bytes))));
  }
  std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty double x\nproperty double y\nproperty double "
      "z\nend_header\n";
  for (const Eigen::Vector3d& p : {kFar, second}) ply += packed(p.x()) + packed(p.y()) + packed(p.z());
  expect_far_points(media::read_map_cloud(folder.write("a.ply", ply)));
  expect_far_points(media::read_map_cloud(
      folder.write("a.pcd",
                   "VERSION .7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\n"
                   "DATA ascii\n456789.125 5412345.25 345.5\n456789.375 5412345.125 345.5\n")));
}

TEST(GivenMap, RefusesDamagedLasFiles) {
  const TestFolder folder;
  const auto error = [&](const std::string& bytes) {
    return input_error([&] { media::read_map_cloud(folder.write("a.las", bytes)); });
  };
  EXPECT_THAT(error("PLY"), HasSubstr("is not a LAS file"));
  EXPECT_THAT(error(las_header(2, 0x83, 34, 1) + las_point(kFar, 34)), AllOf(HasSubstr("LAZ"), HasSubstr("write it as LAS")));
  EXPECT_THAT(error(las_header(2, 3, 34, 2) + las_point(kFar, 34)), HasSubstr("ends before its 2 points"));
  EXPECT_THAT(error(las_header(2, 3, 34, 0)), HasSubstr("holds no points"));
  EXPECT_THAT(error(las_header(2, 3, 34, 1).substr(0, 100)), HasSubstr("header is truncated"));
  EXPECT_THAT(error(las_header(7, 3, 34, 1)), HasSubstr("LAS 1.7"));
}

constexpr const char* kCameras = "# comment\n1 PINHOLE 8 6 4 5 4.5 3.5\n";
constexpr const char* kImages =
    "1 1 0 0 0 0 0 0 1 a.png\n1 2 3\n2 1 0 0 0 0 0 -1 1 b.png\n\n";  // the second looks from 1 m ahead

class Colmap : public testing::Test {
 protected:
  Colmap() {
    folder.write("sparse/0/cameras.txt", kCameras);
    folder.write("sparse/0/images.txt", kImages);
    for (const char* name : {"a", "b", "c"})
      folder.write_image(std::string("images/") + name + ".png", cv::Mat3b(6, 8, cv::Vec3b()));
    const std::vector<Eigen::Vector3f> points{{0, 0, 5}, {1, 0, 5}};
    media::write_ply(folder.path / "map.ply", {points});
  }
  Drive read() const { return read_drive(folder.path); }
  std::string error() const {
    return input_error([&] { read(); });
  }
  TestFolder folder;
};

TEST_F(Colmap, ReadsPosesCamerasAndTheMap) {
  const Drive drive = read();
  EXPECT_EQ(drive.format, "colmap");
  ASSERT_EQ(drive.frames.size(), 2U);
  EXPECT_EQ(drive.camera.cx, 4);
  EXPECT_EQ(drive.camera.fy, 5);
  const SE3 second = drive.camera_from_lidar * drive.poses.at(drive.frames[1].time_ns)->inverse();
  EXPECT_LT((second.t - Eigen::Vector3d(0, 0, -1)).norm(), 1e-12);
  EXPECT_LT((second.R - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_EQ(drive.map[0]->points.size(), 2U);
  ASSERT_EQ(drive.warnings.size(), 1U);
  EXPECT_THAT(drive.warnings[0], HasSubstr("1 images of camera are not in the model"));
}

// COLMAP writes one model for each group of images that it could connect.
TEST_F(Colmap, ReadsTheLargestModel) {
  folder.write("sparse/1/cameras.txt", kCameras);
  folder.write("sparse/1/images.txt", std::string(kImages) + "3 1 0 0 0 0 0 -2 1 c.png\n\n");
  const Drive drive = read();
  EXPECT_EQ(drive.frames.size(), 3U);
  ASSERT_EQ(drive.warnings.size(), 1U);
  EXPECT_THAT(drive.warnings[0], AllOf(HasSubstr("1 is the largest of the 2 models"), HasSubstr("(3 images)")));
  fs::remove_all(folder.path / "sparse/0");
  EXPECT_EQ(read().frames.size(), 3U) << "the number of the model does not matter";
  fs::remove_all(folder.path / "images");
  EXPECT_THAT(error(), HasSubstr("holds a COLMAP model, but no folder images/"));
}

TEST_F(Colmap, ReadsBinaryModelsLikeTextModels) {
  std::string cameras = packed<std::uint64_t>(1) + packed<std::uint32_t>(1) + packed<std::int32_t>(1) +
                        packed<std::uint64_t>(8) + packed<std::uint64_t>(6);
  for (const double p : {4.0, 5.0, 4.5, 3.5}) cameras += packed(p);
  std::string images = packed<std::uint64_t>(2);
  for (const bool second : {false, true}) {
    images += packed<std::uint32_t>(second ? 2 : 1);
    for (const double v : {1.0, 0.0, 0.0, 0.0, 0.0, 0.0, second ? -1.0 : 0.0}) images += packed(v);
    images += packed<std::uint32_t>(1) + (second ? "b.png" : "a.png") + std::string(1, '\0') + packed<std::uint64_t>(1) +
              std::string(24, '\0');
  }
  const Drive text = read();
  fs::remove(folder.path / "sparse/0/images.txt");
  folder.write("sparse/0/cameras.bin", cameras);
  const fs::path file = folder.write("sparse/0/images.bin", images);
  const Drive binary = read();
  ASSERT_EQ(binary.poses.poses().size(), 2U);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_EQ(binary.poses.poses()[i].world_from_body.t, text.poses.poses()[i].world_from_body.t);
  folder.write("sparse/0/images.bin", images.substr(0, images.size() - 3));
  EXPECT_THAT(error(), HasSubstr("is truncated"));
}

TEST_F(Colmap, TreatsRigidlyMountedCamerasAsARig) {
  std::string images;
  for (const char* camera : {"left", "right", "hand"})
    for (int i = 0; i < 2; ++i) {
      const std::string name = std::string(camera) + "/" + std::to_string(i) + ".png";
      const std::string x = camera == std::string("right") ? "-0.5" : camera == std::string("hand") && i == 1 ? "2" : "0";
      images += "9 1 0 0 0 " + x + " 0 " + std::to_string(-i) + " 1 " + name + "\n\n";
      folder.write_image("images/" + name, cv::Mat3b(6, 8, cv::Vec3b()));
    }
  folder.write("sparse/0/images.txt", images);
  const Drive first = read_drive(folder.path, {.camera = "hand"});
  EXPECT_EQ(first.camera_name, "hand") << "it is the first by name";
  EXPECT_EQ(first.camera_names, (std::vector<std::string>{"hand"}));
  folder.write("sparse/0/images.txt", images.substr(0, images.find("9 1 0 0 0 0 0 0 1 hand")));
  const Drive right = read_drive(folder.path, {.camera = "right"});
  EXPECT_EQ(right.camera_names, (std::vector<std::string>{"left", "right"}));
  const Drive left = read_drive(folder.path);
  const SE3 right_from_left = right.camera_from_lidar * left.camera_from_lidar.inverse();
  EXPECT_LT((right_from_left.t - Eigen::Vector3d(-0.5, 0, 0)).norm(), 1e-12);
}

TEST_F(Colmap, ReadsTheModelsOfOpenCv) {
  const auto with = [&](const char* camera) {
    return folder.write("sparse/0/cameras.txt", camera), read_drive(folder.path).camera;
  };
  const Camera fisheye = with("1 OPENCV_FISHEYE 8 6 4 5 4.5 3.5 0.1 0.2 0.3 0.4\n");
  EXPECT_EQ(fisheye.model, CameraModel::fisheye);
  EXPECT_EQ(fisheye.distortion[3], 0.4);
  EXPECT_EQ(with("1 RADIAL_FISHEYE 8 6 4 4.5 3.5 0.1 0.2\n").distortion[1], 0.2);
  const Camera rational = with("1 FULL_OPENCV 8 6 4 5 4.5 3.5 0.1 0.2 0 0 0.3 0.4 0.5 0.6\n");
  EXPECT_EQ(rational.model, CameraModel::pinhole);
  EXPECT_EQ(rational.distortion[7], 0.6);
}

TEST_F(Colmap, RefusesInvalidModels) {
  folder.write("sparse/0/cameras.txt", "1 FOV 8 6 4 5 4.5 3.5 0.9\n");
  EXPECT_THAT(error(), AllOf(HasSubstr("FOV"), HasSubstr("image_undistorter")));
  folder.write("sparse/0/cameras.txt", "2 PINHOLE 8 6 4 5 4.5 3.5\n");
  EXPECT_THAT(error(), HasSubstr("is of camera 1, which cameras.txt does not have"));
  folder.write("sparse/0/cameras.txt", kCameras);
  folder.write("sparse/0/images.txt", "1 2 0 0 0 0 0 0 1 a.png\n\n");
  EXPECT_THAT(error(), HasSubstr("quaternion of a.png has length 2"));
  folder.write("sparse/0/images.txt", kImages);
  fs::remove(folder.path / "map.ply");
  EXPECT_THAT(error(), HasSubstr("has no map"));
  folder.write("sparse/0/points3D.txt", "1 0 0 5 1 2 3 0.5 1 0\n");
  EXPECT_THAT(read().warnings.front(), HasSubstr("points3D.txt only"));
  EXPECT_EQ(read().map[0]->points.size(), 1U);
}

class FolderWithMap : public testing::Test {
 protected:
  FolderWithMap() {
    folder.write("dvi.toml", kConfig);
    for (const char* name : {"000000", "000001"})
      folder.write_image(std::string("images/front/") + name + ".png", cv::Mat3b(6, 8, cv::Vec3b()));
    const std::vector<Eigen::Vector3f> points{{0, 0, 5}};
    media::write_ply(folder.path / "map.ply", {points});
  }
  static constexpr const char* kConfig = "[drive]\nversion = 1\n[camera.front]\nK = [4, 0, 4, 0, 4, 3, 0, 0, 1]\n";
  TestFolder folder;
};

TEST_F(FolderWithMap, HasPosesOfTheCameraWithoutALidar) {
  for (const char* poses : {"0 0 0 0 0 0 0 1\n0.1 1 2 3 0 0 0 1\n", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 2 0 0 1 3\n"}) {
    folder.write("poses.txt", poses);
    const Drive drive = read_drive(folder.path);
    EXPECT_TRUE(drive.scan_headers.empty());
    EXPECT_TRUE(drive.warnings.empty());
    ASSERT_EQ(drive.map.size(), 1U);
    const SE3 second = *drive.poses.at(drive.frames[1].time_ns) * drive.camera_from_lidar.inverse();
    EXPECT_LT((second.t - Eigen::Vector3d(1, 2, 3)).norm(), 1e-12);
    EXPECT_LT((second.R - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  }
}

TEST_F(FolderWithMap, RefusesTwoMapsAndWarnsOfScans) {
  folder.write_bin("lidar/000000.bin", {1, 0, 0, 0});
  folder.write("dvi.toml", std::string(kConfig) + "camera_from_lidar = [0, -1, 0, 0,  0, 0, -1, 0,  1, 0, 0, 0]\n");
  const Drive drive = read_drive(folder.path);
  EXPECT_TRUE(drive.map.empty());
  EXPECT_THAT(drive.warnings.front(), HasSubstr("map.ply is not used"));
  folder.write("map.las", "");
  EXPECT_THAT(input_error([&] { read_drive(folder.path); }), HasSubstr("lies beside map.ply"));
}

// LAS and its variable length records follow the specification of ASPRS (LAS 1.4 R15): a header of 54 bytes each.
std::string las_record(std::uint16_t id, const std::string& content) {
  std::string head(18, '\0');
  head += packed(id) + packed(static_cast<std::uint16_t>(content.size()));
  head.resize(54, '\0');
  return head + content;
}

TEST(GivenMap, RefusesCoordinatesThatAreNotMeters) {
  const TestFolder folder;
  const auto with_record = [&](const std::string& record) {
    std::string header = las_header(2, 0, 20, 1);
    header.replace(96, 4, packed(static_cast<std::uint32_t>(227 + record.size())));
    header.replace(100, 4, packed<std::uint32_t>(1));
    return folder.write("map.las", header + record + las_point(kFar, 20));
  };
  const auto keys = [](std::uint16_t key, std::uint16_t value) {
    std::string out;
    for (const int number : {1, 1, 0, 1}) out += packed(static_cast<std::uint16_t>(number));
    return las_record(34735, out + packed(key) + packed<std::uint16_t>(0) + packed<std::uint16_t>(1) + packed(value));
  };
  const auto error = [&](const std::string& record) {
    return input_error([&] { media::read_map_cloud(with_record(record)); });
  };
  EXPECT_THAT(error(keys(1024, 2)), AllOf(HasSubstr("map.las: its coordinate system is in degrees"), HasSubstr("UTM")));
  EXPECT_THAT(error(keys(3076, 9003)), HasSubstr("in feet"));
  EXPECT_THAT(error(las_record(2112, R"(GEOGCS["WGS 84",UNIT["degree",0.0174532925199433]])")), HasSubstr("in degrees"));
  EXPECT_THAT(error(las_record(2112, R"(PROJCS["x",GEOGCS["y",UNIT["degree",0.0174]],UNIT["foot",0.3048]])")),
              HasSubstr("in feet"));
  for (const std::string& metric : {keys(3076, 9001), las_record(2112, R"(PROJCS["x",GEOGCS["y"],UNIT["meter",1]])"),
                                    las_record(2112, "UNIT[\""), las_record(34735, "abc")})
    EXPECT_EQ(media::read_map_cloud(with_record(metric)).points.size(), 1U);
}

// These clouds were written by PDAL, OpenMVG, CloudCompare and others.
TEST(GivenMap, ReadsOrRefusesFilesOfOtherPrograms) {
  const fs::path clouds = find_recording("foreign_files/clouds");
  DVI_SKIP_WITHOUT(clouds);
  const std::pair<const char*, std::size_t> read[] = {{"1.0_0.las", 1},
                                                      {"1.2_2.las", 1},
                                                      {"100-points.las", 100},
                                                      {"bad_vlr_count.las", 10},
                                                      {"extrabytes.las", 1065},
                                                      {"gps-time-nan.las", 1},
                                                      {"simple.las", 1065},
                                                      {"utm17.las", 10},
                                                      {"warsaw_small.las", 3000},
                                                      {"autzen-utm.pcd", 1065},
                                                      {"utm17_space.pcd", 10},
                                                      {"utm17_tab.pcd", 10},
                                                      {"mesh.ply", 4},
                                                      {"mesh_fixed.ply", 4},
                                                      {"issue_2421.ply", 1},
                                                      {"openmvg_cloud_and_poses.ply", 369},
                                                      {"openmvg_colorized.ply", 369},
                                                      {"openmvg_robust.ply", 527},
                                                      {"simple_binary.ply", 3},
                                                      {"simple_text.ply", 3},
                                                      {"text_extradim.ply", 1}};
  for (const auto& [name, points] : read) EXPECT_EQ(media::read_map_cloud(clouds / name).points.size(), points) << name;
  const std::pair<const char*, const char*> refused[] = {{"epsg_4326.las", "in degrees"},
                                                         {"autzen-dd.las", "in degrees"},
                                                         {"spurious.las", "in degrees"},
                                                         {"autzen_trim_7.las", "in feet"},
                                                         {"test1_4.las", "in feet"},
                                                         {"simple.laz", "is compressed (LAZ)"},
                                                         {"1.2-with-color.copc.laz", "is compressed (LAZ)"},
                                                         {"A4.e57", "is not a LAS file"},
                                                         {"utm17_comma.pcd", "point 0 has 1 numbers instead of 3"},
                                                         {"missingheader.pcd", "its header is not understood at '289814.15"},
                                                         {"no_vertex.ply", "holds no element 'vertex'"},
                                                         {"sized_dims.ply", "no field 'z'"},
                                                         {"unsized_dims.ply", "no field 'z'"}};
  for (const auto& [name, reason] : refused)
    EXPECT_THAT(input_error([&] { media::read_map_cloud(clouds / name); }), HasSubstr(reason)) << name;
}

}  // namespace
}  // namespace dvi::datasets
