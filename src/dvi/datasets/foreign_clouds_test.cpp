// These files were written by COLMAP, PCL, and publishers of data sets; tests/README.md describes how.

#include <cmath>

#include "dvi/datasets/colmap_model.h"
#include "dvi/datasets/reader.h"
#include "dvi/media/point_cloud.h"
#include "dvi/testing/find_recording.h"
#include "dvi/testing/image_folder.h"

namespace dvi::datasets {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const fs::path kForeign = DVI_TEST_FOREIGN;

void expect_points(const media::PointCloud& cloud, const std::vector<Eigen::Vector3d>& expected) {
  ASSERT_EQ(cloud.points.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_TRUE((cloud.origin + cloud.points[i].cast<double>()).isApprox(expected[i], 1e-6)) << i;
}

class ForeignColmapModel : public testing::TestWithParam<const char*> {};

TEST_P(ForeignColmapModel, HasTheNumbersGivenToColmap) {
  const fs::path folder = kForeign / "colmap" / GetParam();
  const ColmapModel model = read_colmap_model(folder);
  ASSERT_EQ(model.cameras.size(), 1U);
  const Camera& camera = model.cameras.at(1);
  EXPECT_EQ(camera.width, 64);
  EXPECT_EQ(camera.height, 48);
  EXPECT_EQ(camera.fx, 60);
  EXPECT_EQ(camera.fy, 61);
  EXPECT_EQ(camera.cx, 31.5) << "COLMAP's first pixel has its center at 0.5";
  EXPECT_EQ(camera.cy, 23.5);
  EXPECT_EQ(camera.distortion[0], -0.1);
  EXPECT_EQ(camera.distortion[3], -0.002);
  ASSERT_EQ(model.images.size(), 2U);
  EXPECT_EQ(model.images[1].name, "front/000002.jpg");
  EXPECT_TRUE(model.images[0].camera_from_world.t.isApprox(Eigen::Vector3d(0.5, -0.25, 0)));
  const double angle = 2 * std::asin(0.08715574274765817);
  EXPECT_TRUE(model.images[1].camera_from_world.R.isApprox(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()).matrix(), 1e-12));
  expect_points(read_colmap_points(folder / (std::string("points3D.") + GetParam())), {{1.5, -0.5, 10}});
}

INSTANTIATE_TEST_SUITE_P(Kinds, ForeignColmapModel, testing::Values("bin", "txt"));

TEST(ForeignClouds, ReadsPlyOfColmap) {
  expect_points(media::read_point_cloud(kForeign / "colmap/points.ply"), {{1.5, -0.5, 10}});
}

// PCL pads binary files with zeros, and its PLY files have a camera after the points.
class CloudOfPcl : public testing::TestWithParam<const char*> {};

TEST_P(CloudOfPcl, HasItsFourPoints) {
  const media::PointCloud cloud = media::read_point_cloud(kForeign / "pcl" / GetParam());
  expect_points(cloud, {{1.5, -2.25, 0.125}, {-3, 4, 5.5}, {10, 20, -1.75}, {0.25, 0.5, 0.75}});
  EXPECT_THAT(cloud.intensity, testing::ElementsAre(0.5F, 1, 0, 0.25F));
}

INSTANTIATE_TEST_SUITE_P(Kinds, CloudOfPcl, testing::Values("ascii.pcd", "binary.pcd", "ascii.ply", "binary.ply"));

TEST(ForeignClouds, RefusesCompressedPcd) {
  EXPECT_THAT(input_error([] { media::read_point_cloud(kForeign / "pcl/compressed.pcd"); }),
              AllOf(HasSubstr("compressed.pcd"), HasSubstr("is compressed")));
}

// Frames 250 to 310 of a recording of the publisher.
TEST(ForeignClouds, ReadsSevenScenes) {
  const fs::path path = find_recording("seven_scenes_kitchen/visit_1");
  DVI_SKIP_WITHOUT(path);
  const Drive drive = read_drive(path);
  EXPECT_EQ(drive.format, "7-scenes");
  ASSERT_EQ(drive.frames.size(), 61U);
  EXPECT_EQ(drive.frames.front().name, "frame-000250");
  EXPECT_EQ(drive.poses.poses().size(), 61U);
  EXPECT_GT(drive.scans[0]->points.size(), 10000U);
}

}  // namespace
}  // namespace dvi::datasets
