#include "dvi/metrics/point_scores.h"

#include <cmath>

#include <gtest/gtest.h>

namespace dvi::metrics {
namespace {

constexpr std::uint32_t kCar = 252, kParked = 10, kInstance = 7U << 16U;

TEST(PointScores, AreSharesOfTheTrueClasses) {
  // Three static points, of which one is labeled as moving, and four dynamic ones, of which one is missed.
  const std::vector<std::uint32_t> truth{0, 9, kParked, kCar, kInstance | kCar, 254, 251};
  const std::vector<std::uint32_t> labels{0, kCar, kInstance | kParked, 259, kCar, 0, kInstance | kCar};
  const PointScores scores = score_labels(truth, labels, std::vector<bool>(7, true));
  EXPECT_EQ(scores.scans, 1U);
  EXPECT_EQ(scores.all.statics, 3U);
  EXPECT_EQ(scores.all.dynamics, 4U);
  EXPECT_DOUBLE_EQ(scores.all.static_accuracy(), 2.0 / 3);
  EXPECT_DOUBLE_EQ(scores.all.dynamic_accuracy(), 3.0 / 4);
  EXPECT_DOUBLE_EQ(scores.all.associated_accuracy(), std::sqrt(0.5));
  EXPECT_DOUBLE_EQ(scores.all.dynamic_iou(), 3.0 / 5) << "three of four true points and one wrong one";
}

TEST(PointScores, OfTheViewAreSeparate) {
  PointScores scores = score_labels({0, kCar, kCar}, {0, kCar, 0}, {true, true, false});
  EXPECT_EQ(scores.in_view.statics, 1U);
  EXPECT_DOUBLE_EQ(scores.in_view.dynamic_accuracy(), 1);
  EXPECT_DOUBLE_EQ(scores.all.dynamic_accuracy(), 0.5);
  scores += score_labels({kCar}, {0}, {true});
  EXPECT_EQ(scores.scans, 2U);
  EXPECT_DOUBLE_EQ(scores.in_view.dynamic_accuracy(), 0.5);
}

TEST(PointScores, AreUndefinedWithoutPoints) {
  const PointScores scores = score_labels({0}, {0}, {false});
  EXPECT_DOUBLE_EQ(scores.all.static_accuracy(), 1);
  EXPECT_TRUE(std::isnan(scores.all.dynamic_accuracy()));
  EXPECT_TRUE(std::isnan(scores.all.associated_accuracy()));
  EXPECT_TRUE(std::isnan(scores.all.dynamic_iou()));
  EXPECT_TRUE(std::isnan(scores.in_view.static_accuracy()));
}

}  // namespace
}  // namespace dvi::metrics
