#include "dvi/media/write_ply.h"

#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "dvi/core/error.h"
#include "dvi/core/files.h"
#include "dvi/media/point_cloud.h"

namespace dvi::media {
namespace {

const fs::path kPath = fs::path(testing::TempDir()) / ("write_" + std::to_string(getpid()) + ".ply");

TEST(WritePly, HasTheHeaderAndTheBytesOfEachPoint) {
  const std::vector<Eigen::Vector3f> points = {{1, 2, 3}, {-4.5F, 0, 6}};
  const std::vector<cv::Vec3b> colors = {{1, 2, 3}, {255, 128, 0}};
  const std::vector<float> intensity = {0.25F, 0.5F}, count = {7, 9};
  write_ply(kPath, {points, colors, {{"intensity", intensity}, {"count", count}}, "static map"});
  const std::string bytes = read_file(kPath);
  const std::string header =
      "ply\nformat binary_little_endian 1.0\ncomment static map\nelement vertex 2\n"
      "property float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n"
      "property float intensity\nproperty float count\nend_header\n";
  constexpr std::size_t kPointBytes = 3 * 4 + 3 + 2 * 4;
  ASSERT_EQ(bytes.size(), header.size() + 2 * kPointBytes);
  EXPECT_EQ(bytes.substr(0, header.size()), header);
  const char* second = bytes.data() + header.size() + kPointBytes;
  float x = 0, last = 0;
  std::memcpy(&x, second, 4);
  std::memcpy(&last, second + kPointBytes - 4, 4);
  EXPECT_EQ(x, -4.5F);
  EXPECT_EQ(last, 9);
  EXPECT_EQ(static_cast<unsigned char>(second[12]), 0);  // red
  EXPECT_EQ(static_cast<unsigned char>(second[14]), 255);
  fs::remove(kPath);
}

TEST(WritePly, WritesPointsAloneAndNone) {
  const std::vector<Eigen::Vector3f> points(100000, Eigen::Vector3f(1, 2, 3));
  write_ply(kPath, {points});
  EXPECT_GT(fs::file_size(kPath), 1200000U);
  write_ply(kPath, {});
  EXPECT_NE(read_file(kPath).find("element vertex 0\n"), std::string::npos);
  fs::remove(kPath);
}

TEST(WritePly, ReportsErrors) {
  const std::vector<Eigen::Vector3f> points(2, Eigen::Vector3f::Zero());
  EXPECT_THROW(write_ply("/nowhere/map.ply", {points}), InputError);
  const std::vector<float> three = {1, 2, 3};
  EXPECT_THROW(write_ply(kPath, {points, {}, {{"intensity", three}}}), std::logic_error);
  EXPECT_FALSE(fs::exists(kPath));
}

TEST(WritePly, KeepsMillimetersOfAMapProjection) {
  const std::vector<Eigen::Vector3f> points = {{0, 0, 0}, {0.001F, 0.002F, 0.003F}};
  const Eigen::Vector3d origin(691'000.125, 5'334'000.25, 512.5);
  write_ply(kPath, {.points = points, .origin = origin});
  const PointCloud cloud = read_map_cloud(kPath);
  EXPECT_EQ(cloud.origin, origin);
  ASSERT_EQ(cloud.points.size(), 2);
  EXPECT_LT((cloud.points[1] - points[1]).norm(), 1e-6F);
}

}  // namespace
}  // namespace dvi::media
