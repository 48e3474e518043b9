#include "dvi/align/pair_model.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "dvi/align/test_wall.h"

namespace dvi::align {
namespace {

constexpr double kExpectedRad = 0.005;

/// Two views of a textured wall, half a meter apart; the pose of the second lacks a rotation.
class PairOfViews : public testing::Test {
 protected:
  PairOfViews() {
    for (std::size_t i = 0; i < 2; ++i) {
      const auto image = std::make_shared<const BandPass>(make_band_pass(*drive.views.images[i], *drive.views.masks[i], 2));
      posed[i] = {drive.views[i].camera, drive.views[i].camera_from_world, image};
    }
    posed[0].camera_from_world = rotate(posed[0], drive.errors[0]).camera_from_world;
    for (std::size_t k = 0; k < drive.map.points.size(); k += 7) {
      const Eigen::Vector3f& position = drive.map.points[k].position;
      const Eigen::Vector2d at = posed[0].camera.project(posed[0].camera_from_world * position.cast<double>());
      const bool is_outside = !cv::Rect(120, 80, 80, 80).contains(cv::Point(cvRound(at.x()), cvRound(at.y())));  // the hole
      if (is_outside && posed[0].camera.contains(at)) points.push_back({position, {0, 0, -1}});
    }
    compare_at(points);
  }
  /// Sets the points by which the views are compared.
  void compare_at(const std::vector<SurfacePoint>& some) {
    pair.points = std::make_shared<const std::vector<SurfacePoint>>(some);
    pair.visible.resize(some.size());
    std::iota(pair.visible.begin(), pair.visible.end(), 0U);
  }
  static PosedImage rotate(PosedImage view, const Eigen::Vector3d& rotation) {
    view.camera_from_world = SE3{so3_exp(rotation), {0, 0, 0}} * view.camera_from_world;
    return view;
  }
  /// Returns the rotation of the moving view with the lowest cost for a fixed pose of the other view.
  static Eigen::Vector3d find_best(const PairModel& model) {
    return -model.H.topLeftCorner<3, 3>().ldlt().solve(model.g.head<3>());
  }

  const ShakyDrive drive{2, {.jitter_deg = 0.2, .speed = {5, 0, 0}, .gain_step = 0.85}};
  const Eigen::Vector3d missing = drive.errors[1];
  PosedImage posed[2];
  std::vector<SurfacePoint> points;
  Pair pair{1, 0, {}, {}};
};

TEST_F(PairOfViews, ModelsAShiftOfEitherView) {
  const PosedImage there = rotate(posed[1], missing);
  const Eigen::Vector3d shift(0.03, -0.02, 0);  // 1 px
  const auto at_most = [&](const PosedImage& moving, const PosedImage& fixed, int at, const Eigen::Vector3d& expected) {
    const auto model = fit_pair({pair, moving, fixed}, 1, kExpectedRad, Freedom::pose);
    ASSERT_TRUE(model);
    ASSERT_EQ(model->g.size(), 12);
    const Eigen::Vector2d found = -model->H.block<2, 2>(at, at).ldlt().solve(model->g.segment<2>(at));
    EXPECT_LT((found - expected.head<2>()).norm(), 0.15 * expected.norm()) << at;
  };
  PosedImage moving = there, fixed = posed[0];
  moving.camera_from_world.t -= shift;
  at_most(moving, fixed, 3, shift);
  fixed.camera_from_world.t -= shift;
  at_most(there, fixed, 9, shift);
}

TEST_F(PairOfViews, FindsTheMissingRotation) {
  ASSERT_GT(missing.norm(), 1e-3);
  const auto model = fit_pair({pair, posed[1], posed[0]}, 1, kExpectedRad);
  ASSERT_TRUE(model);
  EXPECT_EQ(model->moving, 1);
  EXPECT_EQ(model->fixed, 0);
  EXPECT_LT((find_best(*model) - missing).norm(), 0.1 * missing.norm());
  EXPECT_LT(std::abs(find_best(*model).x() - missing.x()) * posed[1].camera.fx, 0.05);  // px
  EXPECT_LT(std::abs(find_best(*model).y() - missing.y()) * posed[1].camera.fx, 0.05);
}

TEST_F(PairOfViews, DoesNotChangeTheTruth) {
  const auto model = fit_pair({pair, rotate(posed[1], missing), posed[0]}, 1, kExpectedRad);
  ASSERT_TRUE(model);
  EXPECT_LT(find_best(*model).norm() * posed[1].camera.fx, 0.05);  // px
}

TEST_F(PairOfViews, TheModelIsSymmetricAndPositiveSemidefinite) {
  const auto model = fit_pair({pair, posed[1], posed[0]}, 1, kExpectedRad);
  ASSERT_TRUE(model);
  EXPECT_LT((model->H - model->H.transpose()).norm(), 1e-9 * model->H.norm());
  const Vector6d eigenvalues = model->H.selfadjointView<Eigen::Lower>().eigenvalues();
  EXPECT_GT(eigenvalues.minCoeff(), -1e-9 * eigenvalues.maxCoeff());
  EXPECT_GT(model->scale, 0);
}

TEST_F(PairOfViews, HeldOutPointsDoNotInfluenceTheFit) {
  const auto model = fit_pair({pair, posed[1], posed[0]}, 1, kExpectedRad);
  for (std::size_t i = 3; i < points.size(); i += 4) points[i].position.x() += 1;
  compare_at(points);
  const auto other = fit_pair({pair, posed[1], posed[0]}, 1, kExpectedRad);
  ASSERT_TRUE(model && other);
  EXPECT_EQ(find_best(*model), find_best(*other));
}

TEST_F(PairOfViews, HeldOutPointsAgreeBetterAtTheTruth) {
  const auto model = fit_pair({pair, posed[1], posed[0]}, 1, kExpectedRad);
  ASSERT_TRUE(model);
  const auto median_px = [](std::vector<double> offsets) {
    std::sort(offsets.begin(), offsets.end());
    return offsets[offsets.size() / 2];
  };
  const HeldOutCost given = evaluate_held_out({pair, posed[1], posed[0]}, model->scale);
  const HeldOutCost truth = evaluate_held_out({pair, rotate(posed[1], missing), posed[0]}, model->scale);
  const HeldOutCost beyond = evaluate_held_out({pair, rotate(posed[1], 3 * missing), posed[0]}, model->scale);
  EXPECT_GT(truth.points, 100);
  EXPECT_EQ(truth.offsets_px.size(), static_cast<std::size_t>(truth.points));
  EXPECT_LT(truth.cost, 0.5 * given.cost);
  EXPECT_LT(given.cost, beyond.cost);
  EXPECT_LT(median_px(truth.offsets_px), 0.15);
  EXPECT_GT(median_px(given.offsets_px), 0.3);
}

TEST_F(PairOfViews, HasNoModelForTooFewPoints) {
  pair.visible.resize(kMinPairPoints);  // a quarter of them is held out
  EXPECT_FALSE(fit_pair({pair, posed[1], posed[0]}, 1, kExpectedRad));
  EXPECT_EQ(evaluate_held_out({{1, 0, {}, {}}, posed[1], posed[0]}, 1).points, 0);
}

}  // namespace
}  // namespace dvi::align
