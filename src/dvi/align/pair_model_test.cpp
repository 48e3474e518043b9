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

constexpr double kExpected = 0.005;  // radians

/// Two views of a textured wall, half a meter apart, of which the second lacks a rotation.
class PairOfViews : public testing::Test {
 protected:
  PairOfViews() {
    for (std::size_t i = 0; i < 2; ++i) {
      const auto image = std::make_shared<const BandPass>(band_pass(*drive.views.images[i], *drive.views.masks[i], 2));
      posed[i] = {drive.views[i].camera, drive.views[i].camera_from_world, image};
    }
    posed[0].camera_from_world = turned(posed[0], drive.errors[0]).camera_from_world;
    for (std::size_t k = 0; k < drive.map.points.size(); k += 7) {
      const Eigen::Vector3f& position = drive.map.points[k].position;
      const Eigen::Vector2d at = posed[0].camera.project(posed[0].camera_from_world * position.cast<double>());
      const bool clear = !cv::Rect(120, 80, 80, 80).contains(cv::Point(cvRound(at.x()), cvRound(at.y())));  // of the hole
      if (clear && posed[0].camera.contains(at)) points.push_back({position, {0, 0, -1}});
    }
    look_at(points);
  }
  /// Compares the views by these points.
  void look_at(const std::vector<SurfacePoint>& some) {
    pair.points = std::make_shared<const std::vector<SurfacePoint>>(some);
    pair.seen.resize(some.size());
    std::iota(pair.seen.begin(), pair.seen.end(), 0U);
  }
  static PosedImage turned(PosedImage view, const Eigen::Vector3d& rotation) {
    view.camera_from_world = SE3{so3_exp(rotation), {0, 0, 0}} * view.camera_from_world;
    return view;
  }
  /// The rotation of the moving view at which the model's cost is least, the fixed one staying.
  static Eigen::Vector3d best(const PairModel& model) { return -model.H.topLeftCorner<3, 3>().ldlt().solve(model.g.head<3>()); }

  const ShakyDrive drive{2, {.jitter_deg = 0.2, .speed = {5, 0, 0}, .gain_step = 0.85}};
  const Eigen::Vector3d lacking = drive.errors[1];
  PosedImage posed[2];
  std::vector<SurfacePoint> points;
  Pair pair{1, 0, {}, {}};
};

TEST_F(PairOfViews, TellsAShiftOfEitherViewAsItTellsARotation) {
  const PosedImage there = turned(posed[1], lacking);
  const Eigen::Vector3d shift(0.03, -0.02, 0);  // 1 px
  const auto at_most = [&](const PosedImage& moving, const PosedImage& fixed, int at, const Eigen::Vector3d& expected) {
    const auto model = fit_pair(pair, moving, fixed, 1, kExpected, Freedom::pose);
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

TEST_F(PairOfViews, FitFindsTheRotationThatIsLacking) {
  ASSERT_GT(lacking.norm(), 1e-3);
  const auto model = fit_pair(pair, posed[1], posed[0], 1, kExpected);
  ASSERT_TRUE(model);
  EXPECT_EQ(model->moving, 1);
  EXPECT_EQ(model->fixed, 0);
  EXPECT_LT((best(*model) - lacking).norm(), 0.1 * lacking.norm());
  EXPECT_LT(std::abs(best(*model).x() - lacking.x()) * posed[1].camera.fx, 0.05);  // px
  EXPECT_LT(std::abs(best(*model).y() - lacking.y()) * posed[1].camera.fx, 0.05);
}

TEST_F(PairOfViews, FitOfTheTruthStaysThere) {
  const auto model = fit_pair(pair, turned(posed[1], lacking), posed[0], 1, kExpected);
  ASSERT_TRUE(model);
  EXPECT_LT(best(*model).norm() * posed[1].camera.fx, 0.05);  // px
}

TEST_F(PairOfViews, ModelIsSymmetricAndNeverNegative) {
  const auto model = fit_pair(pair, posed[1], posed[0], 1, kExpected);
  ASSERT_TRUE(model);
  EXPECT_LT((model->H - model->H.transpose()).norm(), 1e-9 * model->H.norm());
  const Vector6d eigenvalues = model->H.selfadjointView<Eigen::Lower>().eigenvalues();
  EXPECT_GT(eigenvalues.minCoeff(), -1e-9 * eigenvalues.maxCoeff());
  EXPECT_GT(model->scale, 0);
}

TEST_F(PairOfViews, HeldOutPointsHaveNoSayInTheFit) {
  const auto model = fit_pair(pair, posed[1], posed[0], 1, kExpected);
  for (std::size_t i = 3; i < points.size(); i += 4) points[i].position.x() += 1;
  look_at(points);
  const auto misled = fit_pair(pair, posed[1], posed[0], 1, kExpected);
  ASSERT_TRUE(model && misled);
  EXPECT_EQ(best(*model), best(*misled));
}

TEST_F(PairOfViews, HeldOutPointsAgreeBetterAtTheTruth) {
  const auto model = fit_pair(pair, posed[1], posed[0], 1, kExpected);
  ASSERT_TRUE(model);
  const auto median_px = [](std::vector<double> offsets) {
    std::sort(offsets.begin(), offsets.end());
    return offsets[offsets.size() / 2];
  };
  const HeldOutCost given = held_out(pair, posed[1], posed[0], model->scale);
  const HeldOutCost truth = held_out(pair, turned(posed[1], lacking), posed[0], model->scale);
  const HeldOutCost beyond = held_out(pair, turned(posed[1], 3 * lacking), posed[0], model->scale);
  EXPECT_GT(truth.points, 100);
  EXPECT_EQ(truth.offsets_px.size(), static_cast<std::size_t>(truth.points));
  EXPECT_LT(truth.cost, 0.5 * given.cost);
  EXPECT_LT(given.cost, beyond.cost);
  EXPECT_LT(median_px(truth.offsets_px), 0.15);
  EXPECT_GT(median_px(given.offsets_px), 0.3);
}

TEST_F(PairOfViews, TooFewPointsGiveNoModel) {
  pair.seen.resize(kFewestPoints);  // a quarter of them is held out
  EXPECT_FALSE(fit_pair(pair, posed[1], posed[0], 1, kExpected));
  EXPECT_EQ(held_out({1, 0, {}, {}}, posed[1], posed[0], 1).points, 0);
}

}  // namespace
}  // namespace dvi::align
