#include "dvi/media/remove_points.h"

#include <cmath>

#include "dvi/core/error.h"
#include "dvi/media/point_cloud.h"
#include "dvi/testing/image_folder.h"

namespace dvi::media {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

std::string floats(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

const std::string kPlyFields = "property float x\nproperty float y\nproperty float z\nend_header\n";

TEST(RemovePoints, ShortensRowsWithoutAHeader) {
  EXPECT_EQ(remove_points("a.bin", floats({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}), {false, true, false}),
            floats({1, 2, 3, 4, 9, 10, 11, 12}));
  EXPECT_EQ(remove_points("a.pcd.bin", floats({1, 2, 3, 4, 5, 6, 7, 8, 9, 10}), {true, false}), floats({6, 7, 8, 9, 10}));
  EXPECT_EQ(remove_points("a.label", "aaaabbbbcccc", {true, false, true}), "bbbb");
}

TEST(RemovePoints, ShortensAsciiFiles) {
  const std::string head = "ply\r\nformat ascii 1.0\r\ncomment element vertex 3\r\nelement vertex ";
  EXPECT_EQ(remove_points("a.ply", head + "3\r\n" + kPlyFields + "1 2 3\r\n4 5 6\r\n7 8 9", {false, true, false}),
            head + "2\r\n" + kPlyFields + "1 2 3\r\n7 8 9");
  const std::string fields = "# POINTS\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n";
  EXPECT_EQ(
      remove_points("a.pcd", fields + "WIDTH 3\nHEIGHT 1\nPOINTS 3\nDATA ascii\n1 2 3\n4 5 6\n7 8 9\n", {false, true, false}),
      fields + "WIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n1 2 3\n7 8 9\n");
}

TEST(RemovePoints, ShortensBinaryFiles) {
  const std::string head = "ply\nformat binary_little_endian 1.0\nelement camera 1\nproperty float f\nelement vertex ";
  EXPECT_EQ(remove_points("a.ply", head + "2\n" + kPlyFields + floats({0.5F, 1, 2, 3, 4, 5, 6}), {true, false}),
            head + "1\n" + kPlyFields + floats({0.5F, 4, 5, 6}));
  const std::string fields = "FIELDS x y z _\nSIZE 4 4 4 1\nTYPE F F F U\nCOUNT 1 1 1 2\n";
  EXPECT_EQ(
      remove_points("a.pcd", fields + "WIDTH 2\nPOINTS 2\nDATA binary\n" + floats({1, 2, 3}) + "ab" + floats({4, 5, 6}) + "cd",
                    {true, false}),
      fields + "WIDTH 1\nPOINTS 1\nDATA binary\n" + floats({4, 5, 6}) + "cd");
}

TEST(RemovePoints, KeepsTheRowsOfOrganizedClouds) {
  const TestFolder folder;
  const std::string fields = "FIELDS i x y z\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH 2\nHEIGHT 2\nPOINTS 4\nDATA ";
  const std::vector<bool> removed{false, true, false, true};
  const std::string ascii = fields + "ascii\n0 1 2 3\n1 4 5 6\n2 7 8 9\n3 1 1 1\n";
  EXPECT_EQ(remove_points("a.pcd", ascii, removed), fields + "ascii\n0 1 2 3\n1 nan nan nan\n2 7 8 9\n3 nan nan nan\n");
  const std::string binary = fields + "binary\n" + floats({0, 1, 2, 3, 1, 4, 5, 6, 2, 7, 8, 9, 3, 1, 1, 1});
  const std::string blank = remove_points("a.pcd", binary, removed);
  EXPECT_EQ(blank.size(), binary.size());
  const PointCloud cloud = read_point_cloud(folder.write("a.pcd", blank));
  EXPECT_THAT(cloud.intensity, ElementsAre(0, 2));
  EXPECT_THAT(cloud.file_index, ElementsAre(0, 2));
}

TEST(RemovePoints, RefusesFilesOfOtherPoints) {
  const auto error = [](const char* path, const std::string& bytes, const std::vector<bool>& removed, const char* message) {
    EXPECT_THAT([&] { remove_points(path, bytes, removed); }, ThrowsMessage<InputError>(HasSubstr(message)));
  };
  error("a.bin", "12345", {true, false}, "5 bytes are not 2 points");
  const std::string ply = "ply\nformat ascii 1.0\nelement vertex 2\n";
  error("a.ply", ply + kPlyFields + "1 2 3\n4 5 6\n", {true}, "has 2 points instead of 1");
  error("a.ply", ply + kPlyFields + "1 2 3\n", {true, false}, "ends before its 2 points");
  error("a.ply",
        ply +
            "property float x\nproperty float y\nproperty float z\nelement face 1\n"
            "property list uchar int vertex_indices\nend_header\n1 2 3\n4 5 6\n3 0 1 0\n",
        {true, false}, "has other elements after its points");
  error("a.pcd", "FIELDS x y z\nSIZE 2 2 2\nTYPE I I I\nWIDTH 1\nHEIGHT 2\nPOINTS 2\nDATA ascii\n1 2 3\n4 5 6\n", {true, false},
        "which cannot be NaN");
}

}  // namespace
}  // namespace dvi::media
