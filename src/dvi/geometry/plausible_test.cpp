#include "dvi/geometry/plausible.h"

#include <limits>

#include "dvi/datasets/reader.h"
#include "dvi/testing/image_folder.h"

namespace dvi {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(Plausible, AcceptsRotationsOnly) {
  const Eigen::Matrix3d R = so3_exp({0.3, -1.2, 0.7});
  EXPECT_EQ(describe_rotation_problem(R), "");
  EXPECT_EQ(describe_rotation_problem((R.array() + 3e-4).matrix()), "");
  EXPECT_THAT(describe_rotation_problem(Eigen::Matrix3d::Zero()),
              HasSubstr("does not hold a rotation: its rows have lengths 0, 0, 0"));
  EXPECT_THAT(describe_rotation_problem(-R), HasSubstr("mirrors"));
  EXPECT_THAT(describe_rotation_problem(1.01 * R), HasSubstr("lengths 1.01"));
  Eigen::Matrix3d sheared = R;
  sheared.row(0) = R.row(1);
  EXPECT_THAT(describe_rotation_problem(sheared), HasSubstr("its rows have lengths 1, 1, 1"));
  sheared(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(describe_rotation_problem(sheared), HasSubstr("not finite"));
}

TEST(Plausible, AcceptsCameraMatricesRowByRow) {
  EXPECT_EQ(describe_camera_matrix_problem({500, 0, 320, 0, 500, 240, 0, 0, 1}), "");
  EXPECT_THAT(describe_camera_matrix_problem({500, 0, 0, 0, 500, 0, 320, 240, 1}), HasSubstr("is transposed"));
  EXPECT_THAT(describe_camera_matrix_problem({500, 0, 320, 0, 500, 240, 0, 0, 0}), HasSubstr("0 0 0 as its last row"));
  EXPECT_THAT(describe_camera_matrix_problem({500, 0, 320, 0, -500, 240, 0, 0, 1}), HasSubstr("fy = -500"));
  EXPECT_THAT(describe_camera_matrix_problem({500, 9, 320, 0, 500, 240, 0, 0, 1}), HasSubstr("skewed"));
}

Camera camera_of(cv::Size size, double f, cv::Point2d center) {
  Camera camera;
  camera.width = size.width, camera.height = size.height, camera.fx = camera.fy = f;
  camera.cx = center.x, camera.cy = center.y;
  return camera;
}

TEST(Plausible, AcceptsCamerasThatMatchTheirImages) {
  const auto error = [](const Camera& camera) { return input_error([&] { require_plausible(camera, "calib.txt", "P2"); }); };
  EXPECT_NO_THROW(require_plausible(camera_of({640, 480}, 500, {320, 240}), "calib.txt", "P2"));
  EXPECT_NO_THROW(require_plausible(camera_of({640, 480}, 32, {-320, 720}), "calib.txt", "P2"));
  EXPECT_THAT(error(camera_of({640, 480}, 1e12, {320, 240})),
              HasSubstr("calib.txt: P2: fx = 1e+12 px is not within 32 to 32000"));
  EXPECT_THAT(error(camera_of({640, 480}, 1, {320, 240})), HasSubstr("fx = 1 px"));
  EXPECT_THAT(error(camera_of({640, 480}, 500, {961, 240})), HasSubstr("cx = 961 px is not within -320 to 960"));
  EXPECT_THAT(error(camera_of({640, 480}, 500, {320, -241})), HasSubstr("cy = -241 px is not within -240 to 720"));
  EXPECT_THAT(error(camera_of({0, 480}, 500, {320, 240})), HasSubstr("0x480"));
  EXPECT_THAT(error(camera_of({65536, 65536}, 65536, {320, 240})), AllOf(HasSubstr("65536x65536"), HasSubstr("2^28")));
}

TEST(Plausible, AcceptsNamesWithinTheirFolder) {
  EXPECT_NO_THROW(require_plain_name("front..left", "dvi.toml", "a camera"));
  for (const char* name : {"", ".", "..", "../../evil", "a/b", "a\\b"})
    EXPECT_THAT(input_error([&] { require_plain_name(name, "dvi.toml", "a camera"); }),
                HasSubstr("is not a valid name of a camera"));
}

}  // namespace
}  // namespace dvi
