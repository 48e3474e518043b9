#include "dvi/geometry/camera.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/core/random.h"
#include "dvi/geometry/camera_json.h"

namespace dvi {
namespace {

const Camera kPlain{1280, 720, 1000, 990, 640.5, 359.5, {}};
const Camera kBarrel{1280, 720, 1000, 990, 640.5, 359.5, {-0.3, 0.1, 0.001, -0.0005, -0.01}};
// The distortion is as strong as that of lenses in published driving data sets.
const Camera kStrong{1392, 512, 984, 980, 690, 233, {-0.3728, 0.2037, 0.002219, 0.001383, -0.07233}};

const Camera kRational{1280, 720, 560, 560, 640, 360, {0.9, 0.2, 2e-4, -1e-4, 0.01, 1.25, 0.45, 0.05}};
const Camera kFisheye{1280, 960, 400, 410, 640, 480, {-0.02, 0.01, -0.004, 0.0005}, CameraModel::fisheye};
const Camera kUnified{1400, 1400, 1336.3, 1335.8, 716.9, 705.8, {0.0168, 1.655, 4.2e-4, 4.2e-4}, CameraModel::unified, 2.2134};
const Camera kPanorama{1024,  512, 512 / std::numbers::pi,      512 / std::numbers::pi, 511.5,
                       255.5, {},  CameraModel::equirectangular};
const Camera kCylinder{800, 500, 300, 300, 400, 250, {}, CameraModel::cylindrical};
const std::array kAll{kPlain, kBarrel, kStrong, kRational, kFisheye, kUnified, kPanorama, kCylinder};

TEST(Camera, ProjectsTheOpticalAxisToThePrincipalPoint) {
  for (const Camera& camera : {kPlain, kBarrel}) {
    const Eigen::Vector2d p = camera.project({0, 0, 7});
    EXPECT_EQ(p, Eigen::Vector2d(640.5, 359.5));
  }
}

TEST(Camera, HasPositiveAxesToTheRightAndDown) {
  EXPECT_EQ(kPlain.project({1, 0, 10}), Eigen::Vector2d(740.5, 359.5));
  EXPECT_EQ(kPlain.project({0, 1, 10}), Eigen::Vector2d(640.5, 458.5));
}

// The formula of OpenCV's documentation, written for one point.
TEST(Camera, HasBrownsDistortion) {
  const double x = 0.3, y = -0.2, r2 = x * x + y * y;
  const auto [k1, k2, p1, p2, k3, k4, k5, k6] = kBarrel.distortion;
  const double radial = 1 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
  const double u = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
  const double v = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
  const Eigen::Vector2d p = kBarrel.project({0.6, -0.4, 2});
  EXPECT_NEAR(p.x(), 1000 * u + 640.5, 1e-10);
  EXPECT_NEAR(p.y(), 990 * v + 359.5, 1e-10);
}

// The formulas of OpenCV's documentation (calib3d, fisheye, omnidir) and of KITTI-360's tools, written for one point.
TEST(Camera, HasTheRationalDistortion) {
  const double x = 0.3, y = -0.2, r2 = x * x + y * y;
  const auto [k1, k2, p1, p2, k3, k4, k5, k6] = kRational.distortion;
  const double radial = (1 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2) / (1 + k4 * r2 + k5 * r2 * r2 + k6 * r2 * r2 * r2);
  const double u = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
  const double v = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
  EXPECT_LT((kRational.project({0.6, -0.4, 2}) - Eigen::Vector2d(560 * u + 640, 560 * v + 360)).norm(), 1e-10);
}

TEST(Camera, HasTheFisheyeModelOfKannalaAndBrandt) {
  const double a = 3, b = -2, r = std::sqrt(a * a + b * b), theta = std::atan(r), t2 = theta * theta;
  const auto& k = kFisheye.distortion;
  const double theta_d = theta * (1 + k[0] * t2 + k[1] * t2 * t2 + k[2] * t2 * t2 * t2 + k[3] * t2 * t2 * t2 * t2);
  const Eigen::Vector2d expected(400 * theta_d / r * a + 640, 410 * theta_d / r * b + 480);
  EXPECT_LT((kFisheye.project({15, -10, 5}) - expected).norm(), 1e-10);
  EXPECT_EQ(kFisheye.project({0, 0, 5}), Eigen::Vector2d(640, 480));
}

TEST(Camera, HasTheUnifiedModelOfMeiAndRives) {
  const Eigen::Vector3d x(3, -1, 1.5), on_sphere = x / x.norm();
  const double u = on_sphere.x() / (on_sphere.z() + kUnified.xi), v = on_sphere.y() / (on_sphere.z() + kUnified.xi);
  const double r2 = u * u + v * v, radial = 1 + kUnified.distortion[0] * r2 + kUnified.distortion[1] * r2 * r2;
  const double p1 = kUnified.distortion[2], p2 = kUnified.distortion[3];
  const Eigen::Vector2d m(u * radial + 2 * p1 * u * v + p2 * (r2 + 2 * u * u),
                          v * radial + p1 * (r2 + 2 * v * v) + 2 * p2 * u * v);
  EXPECT_LT((kUnified.project(x) - Eigen::Vector2d(1336.3 * m.x() + 716.9, 1335.8 * m.y() + 705.8)).norm(), 1e-10);
}

TEST(Camera, SpreadsPanoramasOverLongitudeAndLatitude) {
  constexpr double kPi = std::numbers::pi;
  EXPECT_LT((kPanorama.project({0, 0, 4}) - Eigen::Vector2d(511.5, 255.5)).norm(), 1e-9);
  EXPECT_LT((kPanorama.project({4, 0, 0}) - Eigen::Vector2d(767.5, 255.5)).norm(), 1e-9) << "a quarter turn to the right";
  EXPECT_LT((kPanorama.project({0, -3, 3}) - Eigen::Vector2d(511.5, 127.5)).norm(), 1e-9) << "45 degrees upward";
  EXPECT_LT((kPanorama.project({0, 5, 0}) - Eigen::Vector2d(511.5, 511.5)).norm(), 1e-9) << "straight down";
  EXPECT_NEAR(kPanorama.period_px(), 1024, 1e-9);
  EXPECT_NEAR(kCylinder.period_px(), 2 * kPi * 300, 1e-9);
  EXPECT_LT((kCylinder.project({3, -3, 3}) - Eigen::Vector2d(300 * kPi / 4 + 400, -300 / std::sqrt(2) + 250)).norm(), 1e-9);
  EXPECT_EQ(kBarrel.period_px(), 0);
}

TEST(Camera, ProjectsTheRayOfEachPixelBackToThePixel) {
  for (const Camera& camera : kAll) {
    int shown = 0;
    for (int y = 0; y < camera.height; y += 13)
      for (int x = 0; x < camera.width; x += 13) {
        const Eigen::Vector3d ray = camera.ray({x, y});
        ASSERT_NEAR(camera.depth(ray), 1, 1e-12);
        if (!camera.shows({x, y})) continue;
        ++shown;
        ASSERT_LT((camera.project(ray * 12.5) - Eigen::Vector2d(x, y)).norm(), 1e-6)
            << to_string(camera.model) << x << ' ' << y;
        ASSERT_TRUE(camera.in_front(ray)) << to_string(camera.model) << x << ' ' << y;
      }
    EXPECT_GT(shown, camera.is_wide() ? 0.75 * camera.width * camera.height / 169 : camera.width * camera.height / 169)
        << to_string(camera.model);
  }
}

TEST(Camera, HasNoGapAtTheSeamOfAPanorama) {
  for (const double left : {-0.001, 0.0, 0.001}) {
    const Eigen::Vector2d pixel = kPanorama.project({left, 0, -5});
    EXPECT_TRUE(kPanorama.contains(pixel)) << pixel.transpose();
    EXPECT_TRUE(pixel.x() == 0 || pixel.x() == 1023) << pixel.transpose();
  }
  EXPECT_LT((kPanorama.project(kPanorama.ray({1023, 100})) - Eigen::Vector2d(1023, 100)).norm(), 1e-9);
  EXPECT_FALSE(kCylinder.contains(kCylinder.project({0, 0, -5}))) << "it shows less than the full turn";
}

TEST(Camera, ShowsNothingInTheCornersOfAFisheyeImage) {
  const Camera circle{1000, 1000, 300, 300, 499.5, 499.5, {}, CameraModel::fisheye};
  EXPECT_TRUE(circle.shows({499.5, 2}));
  EXPECT_TRUE(circle.shows({1, 499.5}));
  Camera narrow = circle;
  narrow.fx = narrow.fy = 150;
  EXPECT_TRUE(narrow.shows({499.5 + 150 * 2.9, 499.5})) << "166 degrees off the axis";
  EXPECT_FALSE(narrow.shows({499.5 + 150 * 3.2, 499.5}));
  EXPECT_LT((narrow.ray({499.5, 499.5 + 150 * 3.3}) - Eigen::Vector3d(0, std::sin(3.05), std::cos(3.05))).norm(), 1e-6)
      << "the nearest direction with a projection";
  const Camera mirror{1400, 1400, 1336, 1336, 700, 700, {}, CameraModel::unified, 2.2};
  EXPECT_TRUE(mirror.shows({1300, 700}));
  EXPECT_FALSE(mirror.shows({1399, 10})) << "beyond the edge of the sphere";
  EXPECT_TRUE(mirror.ray({1399, 10}).allFinite());
}

TEST(Camera, SeesBehindItselfIfItIsWide) {
  EXPECT_FALSE(kPlain.in_front({3, 0, -0.5}));
  EXPECT_TRUE(kFisheye.in_front({3, 0, -0.5}));
  EXPECT_TRUE(kUnified.in_front({3, 0, -0.5}));
  EXPECT_FALSE(kUnified.in_front({0.5, 0, -3})) << "behind the edge of the sphere";
  EXPECT_TRUE(kPanorama.in_front({0.1, 0, -3}));
  EXPECT_FALSE(kPanorama.in_front({0.01, 0, 0.01}));
  EXPECT_EQ(kPlain.depth({3, 4, 12}), 12);
  EXPECT_EQ(kFisheye.depth({3, 4, 12}), 13);
}

TEST(Camera, DifferentiatesItsProjection) {
  Random random(3);
  for (const Camera& camera : kAll)
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3d x(random.uniform(-4, 4), random.uniform(-3, 3), random.uniform(camera.is_wide() ? 0.2 : 4, 9));
      const Eigen::Matrix<double, 2, 3> J = camera.differentiate(x);
      for (int axis = 0; axis < 3; ++axis) {
        constexpr double kStep = 1e-5;
        const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(axis);
        const Eigen::Vector2d slope = (camera.project(x + step) - camera.project(x - step)) / (2 * kStep);
        ASSERT_LT((J.col(axis) - slope).norm(), 1e-4 * (1 + slope.norm())) << to_string(camera.model) << ' ' << axis;
      }
    }
  EXPECT_LT((kFisheye.differentiate({0, 0, 2}).col(0) - Eigen::Vector2d(200, 0)).norm(), 1e-9) << "on the axis";
}

TEST(Camera, ExcludesDirectionsBeyondTheRangeOfARationalModel) {
  // The denominator has a root at r = 2: beyond it, the model would project points into the image again.
  const Camera camera{1280, 720, 560, 560, 640, 360, {0, 0, 0, 0, 0, -0.25, 0, 0}};
  EXPECT_TRUE(camera.in_front({1.5, 0, 1}));
  EXPECT_FALSE(camera.in_front({2.5, 0, 1}));
}

TEST(Camera, KnowsTheCoefficientsOfEachModel) {
  EXPECT_EQ(kPlain.coefficients().size(), 5U);
  EXPECT_EQ(kRational.coefficients().size(), 8U);
  EXPECT_EQ(kFisheye.coefficients().size(), 4U);
  EXPECT_TRUE(kPanorama.coefficients().empty());
  const auto problem = [](CameraModel model, const std::vector<double>& k) { return describe_lens_problem(model, k); };
  for (const std::size_t count : {0, 4, 5, 8, 12, 14})
    EXPECT_EQ(problem(CameraModel::pinhole, std::vector<double>(count)), "") << count;
  EXPECT_NE(problem(CameraModel::pinhole, {1, 2, 3}), "");
  EXPECT_NE(problem(CameraModel::pinhole, {0, 0, 0, 0, 0, 0, 0, 0, 0.1, 0, 0, 0}), "") << "a thin prism";
  EXPECT_EQ(problem(CameraModel::fisheye, {1, 2, 3, 4}), "");
  EXPECT_NE(problem(CameraModel::fisheye, {1, 2, 3, 4, 5}), "");
  EXPECT_NE(problem(CameraModel::equirectangular, {0.1}), "");
  EXPECT_EQ(find_camera_model("Kannala_Brandt"), CameraModel::fisheye);
  EXPECT_EQ(find_camera_model("MEI"), CameraModel::unified);
  EXPECT_EQ(find_camera_model("polynomial"), std::nullopt);
}

TEST(Camera, IsTheSameAfterJson) {
  for (const Camera& camera : kAll) EXPECT_EQ(camera_from_json(to_json(camera)), camera) << to_string(camera.model);
  EXPECT_FALSE(to_json(kBarrel).contains("model")) << "of most cameras";
  nlohmann::json later = to_json(kBarrel);
  later["model"] = "polynomial";
  EXPECT_THAT([&] { camera_from_json(later); },
              testing::ThrowsMessage<InputError>(testing::HasSubstr("'polynomial' is unknown")));
}

TEST(Camera, RecoversPointsFromPixelAndDepth) {
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    const double z = random.uniform(1, 80);
    const Eigen::Vector3d x(random.uniform(-0.6, 0.6) * z, random.uniform(-0.35, 0.35) * z, z);
    for (const Camera& camera : {kPlain, kBarrel}) ASSERT_LT((camera.ray(camera.project(x)) * z - x).norm(), 1e-6 * z);
  }
}

TEST(Camera, ContainsPositionsWithFourNeighbors) {
  EXPECT_TRUE(kPlain.contains({0, 0}));
  EXPECT_TRUE(kPlain.contains({1279, 719}));
  EXPECT_FALSE(kPlain.contains({-0.01, 0}));
  EXPECT_FALSE(kPlain.contains({1279.01, 0}));
  EXPECT_FALSE(kPlain.contains({0, 719.01}));
}

TEST(Camera, ExcludesDirectionsThatTheDistortionFoldsBack) {
  EXPECT_FALSE(kPlain.in_front({0, 0, -1}));
  EXPECT_FALSE(kPlain.in_front({0, 0, 0}));
  EXPECT_TRUE(kPlain.in_front({50, 0, 1}));
  const Camera folding{1280, 720, 1000, 1000, 640, 360, {-0.4, 0, 0, 0, 0}};  // r(1 - 0.4 r^2) increases up to r = 0.913
  EXPECT_TRUE(folding.in_front({0.90, 0, 1}));
  EXPECT_FALSE(folding.in_front({0.92, 0, 1}));
  EXPECT_TRUE(folding.contains(folding.project({1.5, 0, 1})));  // although it is projected into the image
  EXPECT_FALSE(folding.in_front({1.5, 0, 1}));
}

}  // namespace
}  // namespace dvi
