#include "dvi/media/point_cloud.h"

#include <cmath>

#include "dvi/media/write_ply.h"
#include "dvi/testing/image_folder.h"

namespace dvi::media {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

template <class T>
std::string raw(T value, bool swap = false) {
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof(T));
  return swap ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}

void expect_two_points(const PointCloud& cloud) {
  ASSERT_EQ(cloud.points.size(), 2U);
  EXPECT_EQ(cloud.points[0], Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(cloud.points[1], Eigen::Vector3f(-4, 5.5F, 6));
}

TEST(PointCloud, ReadsBin) {
  const TestFolder folder;
  const PointCloud cloud = read_point_cloud(folder.write_bin("a.bin", {1, 2, 3, 0.5F, -4, 5.5F, 6, 1}));
  expect_two_points(cloud);
  EXPECT_THAT(cloud.intensity, ElementsAre(0.5F, 1.0F));
  EXPECT_TRUE(cloud.t.empty() && cloud.ring.empty());
}

TEST(PointCloud, ReadsBackTheBytesOfABin) {
  const TestFolder folder;
  const Scan scan{{{1, 2, 3}, {-4, 5.5F, 6}}, {0.5F, 1}, {0, 0}, {}};
  const PointCloud cloud = read_point_cloud(folder.write("a.bin", to_bin_bytes(scan)));
  EXPECT_EQ(cloud.points, scan.points);
  EXPECT_EQ(cloud.intensity, scan.intensity);
}

TEST(PointCloud, ReadsAsciiPly) {
  const TestFolder folder;
  const PointCloud cloud = read_point_cloud(folder.write(
      "a.ply",
      "ply\nformat ascii 1.0\ncomment x\nelement vertex 2\nproperty uchar ring\nproperty float x\nproperty float y\n"
      "property float z\nproperty float t\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "7 1 2 3 0.01\r\n8 -4 5.5 6 0.09\r\n3 0 1 0\n"));
  expect_two_points(cloud);
  EXPECT_THAT(cloud.ring, ElementsAre(7, 8));
  EXPECT_THAT(cloud.t, ElementsAre(0.01, 0.09));
  EXPECT_THAT(cloud.intensity, ElementsAre(0, 0));
}

TEST(PointCloud, KeepsRingsWithinTheirType) {
  const TestFolder folder;
  const PointCloud cloud = read_point_cloud(folder.write(
      "a.pcd",
      "FIELDS x y z ring\nSIZE 4 4 4 4\nTYPE F F F F\nPOINTS 4\nDATA ascii\n1 2 3 nan\n1 2 3 -1\n1 2 3 1e9\n1 2 3 7\n"));
  EXPECT_THAT(cloud.ring, ElementsAre(0, 0, 65535, 7));
}

TEST(PointCloud, ReadsBinaryPlyOfEitherEnd) {
  const TestFolder folder;
  for (const bool big : {false, true}) {
    std::string bytes = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                        "_endian 1.0\nelement vertex 2\nproperty double x\nproperty float y\nproperty short z\n"
                        "property uchar intensity\nend_header\n";
    bytes += raw(1.0, big) + raw(2.0F, big) + raw(std::int16_t{3}, big) + raw(std::uint8_t{200});
    bytes += raw(-4.0, big) + raw(5.5F, big) + raw(std::int16_t{6}, big) + raw(std::uint8_t{0});
    const PointCloud cloud = read_point_cloud(folder.write("a.ply", bytes));
    expect_two_points(cloud);
    EXPECT_THAT(cloud.intensity, ElementsAre(200, 0));
  }
}

TEST(PointCloud, ReadsBackWrittenPly) {
  const TestFolder folder;
  const std::vector<Eigen::Vector3f> points = {{1, 2, 3}, {-4, 5.5F, 6}};
  const std::vector<float> intensity = {0.25F, 0.75F};
  write_ply(folder.path / "a.ply", {.points = points, .scalars = {{"intensity", intensity}}});
  const PointCloud cloud = read_point_cloud(folder.path / "a.ply");
  expect_two_points(cloud);
  EXPECT_EQ(cloud.intensity, intensity);
}

TEST(PointCloud, ReadsPcd) {
  const TestFolder folder;
  const std::string head =
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z n intensity\nSIZE 4 4 4 4 4\nTYPE F F F F F\nCOUNT 1 1 1 2 1\n"
      "WIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\n";
  const PointCloud ascii = read_point_cloud(folder.write("a.pcd", head + "DATA ascii\n1 2 3 0 0 9\n-4 5.5 6 0 0 8\n"));
  expect_two_points(ascii);
  EXPECT_THAT(ascii.intensity, ElementsAre(9, 8));
  std::string bytes = head + "DATA binary\n";
  for (const float value : {1.0F, 2.0F, 3.0F, 0.0F, 0.0F, 9.0F, -4.0F, 5.5F, 6.0F, 0.0F, 0.0F, 8.0F}) bytes += raw(value);
  const PointCloud binary = read_point_cloud(folder.write("b.pcd", bytes));
  expect_two_points(binary);
  EXPECT_THAT(binary.intensity, ElementsAre(9, 8));
  EXPECT_THAT(input_error([&] { read_point_cloud(folder.write("c.pcd", head + "DATA binary_compressed\n")); }),
              HasSubstr("write it as DATA binary or ascii"));
}

// PCL and ROS keep the grid of rays in organized clouds: rays without a return are NaN or 0 0 0.
TEST(PointCloud, IgnoresRaysWithoutAReturn) {
  const TestFolder folder;
  const float nan = std::nanf("");
  const PointCloud bin = read_point_cloud(
      folder.write_bin("a.bin", {nan, nan, nan, 0, 1, 2, 3, 0.5F, 0, 0, 0, 0, -4, 5.5F, 6, 1, INFINITY, 0, 0, 0}));
  EXPECT_EQ(bin.file_points, 5U);
  EXPECT_THAT(bin.file_index, ElementsAre(1, 3)) << "labels of points need their index";
  expect_two_points(bin);
  EXPECT_THAT(bin.intensity, ElementsAre(0.5F, 1));
  const PointCloud pcd = read_point_cloud(folder.write(
      "a.pcd",
      "FIELDS x y z intensity t ring\nSIZE 4 4 4 4 4 2\nTYPE F F F F F U\nWIDTH 2\nHEIGHT 2\nPOINTS 4\nDATA ascii\n"
      "nan nan nan nan nan 0\n1 2 3 7 0.1 1\n-nan -nan -nan 0 0 2\n-4 5.5 6 8 0.2 3\n"));
  expect_two_points(pcd);
  EXPECT_THAT(pcd.intensity, ElementsAre(7, 8));
  EXPECT_THAT(pcd.t, ElementsAre(0.1, 0.2));
  EXPECT_THAT(pcd.ring, ElementsAre(1, 3));
}

TEST(PointCloud, SkipsElementsBeforeThePoints) {
  const TestFolder folder;
  const std::string head =
      "element camera 2\nproperty float a\nproperty uchar b\nelement vertex 2\nproperty float x\n"
      "property float y\nproperty float z\nelement face 1\nproperty list uchar int i\nend_header\n";
  expect_two_points(
      read_point_cloud(folder.write("a.ply", "ply\nformat ascii 1.0\n" + head + "9 8\n7 6\n1 2 3\n-4 5.5 6\n3 0 1 0\n")));
  std::string bytes = "ply\nformat binary_little_endian 1.0\n" + head + std::string(10, 'c');
  for (const float value : {1.0F, 2.0F, 3.0F, -4.0F, 5.5F, 6.0F}) bytes += raw(value);
  expect_two_points(read_point_cloud(folder.write("b.ply", bytes)));
  EXPECT_THAT(input_error([&] { read_point_cloud(folder.write("c.ply", "ply\nformat ascii 1.0\n" + head + "9 8\n")); }),
              HasSubstr("ends before its points"));
  EXPECT_THAT(input_error([&] { read_point_cloud(folder.write("d.ply", "ply\nformat ascii 1.0\nend_header\n")); }),
              HasSubstr("holds no element 'vertex'"));
}

// PDAL writes names in upper case.
TEST(PointCloud, ReadsPcdHeadersOfOtherPrograms) {
  const TestFolder folder;
  const PointCloud cloud = read_point_cloud(
      folder.write("a.pcd",
                   "# .PCD v.6\r\nVERSION .6\r\nCOLUMNS X Y Z Intensity GpsTime\r\nSIZE 4 4 4 4 8\r\nTYPE F F F F F\r\n"
                   "WIDTH 1\r\nHEIGHT 2\r\nDATA ascii\r\n1 2 3 9 0.5\r\n-4 5.5 6 8 0.6\r\n"));
  expect_two_points(cloud);
  EXPECT_THAT(cloud.intensity, ElementsAre(9, 8));
  EXPECT_THAT(cloud.t, ElementsAre(0.5, 0.6));
  EXPECT_THAT(input_error([&] { read_point_cloud(folder.write("b.pcd", "1 2 3\n4 5 6\n")); }),
              HasSubstr("header is not understood at '1 2 3'"));
  EXPECT_THAT(
      input_error([&] {
        read_point_cloud(folder.write("c.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 2\nDATA ascii\n1,2,3\n4,5,6\n"));
      }),
      AllOf(HasSubstr("point 0 has 1 numbers instead of 3"), HasSubstr("separated by blanks")));
}

TEST(PointCloud, UsesTheFirstFinitePointOfAMapAsOrigin) {
  const TestFolder folder;
  const PointCloud map =
      read_map_cloud(folder.write("map.pcd",
                                  "FIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nPOINTS 3\nDATA ascii\nnan nan nan\n500000 5800000 30\n"
                                  "500001 5800000.5 30\n"));
  EXPECT_EQ(map.origin, Eigen::Vector3d(500000, 5800000, 30));
  EXPECT_THAT(map.points, ElementsAre(Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(1, 0.5F, 0)));
}

TEST(PointCloud, ReadsBinByItsLayout) {
  const TestFolder folder;
  const std::vector<double> numbers = {0.02, 1, 2, 3, 7, 0.5, 0.03, -4, 5.5, 6, 9, 1};
  const fs::path file =
      folder.write("a.bin", std::string(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double)));
  const PointCloud cloud =
      read_point_cloud(file, {.scalar_bytes = 8, .columns = {"t", "x", "y", "z", "ring", "intensity"}, .stated = true});
  expect_two_points(cloud);
  EXPECT_THAT(cloud.t, ElementsAre(0.02, 0.03));
  EXPECT_THAT(cloud.ring, ElementsAre(7, 9));
  EXPECT_THAT(cloud.intensity, ElementsAre(0.5F, 1));
}

TEST(PointCloud, RefusesBrokenBin) {
  const TestFolder folder;
  const auto error = [&](const fs::path& file) { return input_error([&] { read_point_cloud(file); }); };
  EXPECT_THAT(error(folder.write("a.bin", std::string(33, 'x'))), AllOf(HasSubstr("a.bin"), HasSubstr("33 bytes")));
  EXPECT_THAT(error(folder.write("b.bin", "")), HasSubstr("b.bin: holds no points"));
  EXPECT_THAT(error(folder.write_bin("c.bin", {1, 2, std::nanf(""), 0, 0, 0, 0, 9})),
              AllOf(HasSubstr("c.bin"), HasSubstr("none of its 2 points is a return")));
}

TEST(PointCloud, RefusesBrokenHeadersAndTruncatedFiles) {
  const TestFolder folder;
  const auto error = [&](const std::string& name, const std::string& text) {
    return input_error([&] { read_point_cloud(folder.write(name, text)); });
  };
  const std::string head = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n";
  EXPECT_THAT(error("a.ply", "pcd"), HasSubstr("is not a PLY file"));
  EXPECT_THAT(error("b.ply", head), HasSubstr("header is truncated"));
  EXPECT_THAT(error("c.ply", head + "end_header\n1 2\n3 4\n"), HasSubstr("no field 'z'"));
  EXPECT_THAT(error("d.ply", head + "property half z\nend_header\n"), HasSubstr("'property half z'"));
  EXPECT_THAT(error("e.ply", head + "property float z\nend_header\n1 2 3\n"), HasSubstr("ends before its 2 points"));
  EXPECT_THAT(error("f.ply", head + "property float z\nend_header\n0 0 0\n4 nan 6\n"), HasSubstr("none of its 2 points"));
  EXPECT_THAT(error("g.ply", head + "property float z\nend_header\n1 2 3\n4 abc 6\n"), HasSubstr("'abc' is not a number"));
  EXPECT_THAT(error("h.ply",
                    "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\n"
                    "end_header\n"),
              HasSubstr("holds no points"));
  EXPECT_THAT(error("i.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA binary\nabc"), HasSubstr("ends before"));
  EXPECT_THAT(error("j.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F\nPOINTS 1\nDATA ascii\n1 2 3\n"), HasSubstr("not understood"));
}

}  // namespace
}  // namespace dvi::media
