#include "dvi/harmonize/screening.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "dvi/harmonize/copies.h"
#include "dvi/image/region.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {
namespace {

/// Copies of gray level 100 in a hole, at whose boundary target and source differ by `difference(pixel)`.
struct BoundaryCase {
  sample::Candidates candidates;
  Copies copies;

  template <class Difference>
  explicit BoundaryCase(const Difference& difference) {
    const cv::Rect hole(60, 40, 180, 120);
    cv::Mat1b mask(200, 300, uchar{0});
    mask(hole) = 255;
    candidates = {Region(mask), std::vector<sample::Candidate>(Region(mask).size(), sample::Candidate{1, {}})};
    copies.color.assign(candidates.hole.size(), cv::Vec3f::all(100));
    copies.seams.resize(candidates.hole.size());
    for (int x = hole.x; x < hole.br().x; ++x)
      for (const int y : {hole.y - 1, hole.br().y}) add({x, y}, difference);
    for (int y = hole.y; y < hole.br().y; ++y)
      for (const int x : {hole.x - 1, hole.br().x}) add({x, y}, difference);
  }
  template <class Difference>
  void add(cv::Point p, const Difference& difference) {
    copies.boundary.push_back({p, 1, cv::Vec3f::all(difference(p))});
  }
  Screening run(BoundaryModel model = BoundaryModel::robust) const { return compute_screening(copies, candidates, model); }
  float weight(const Screening& screening, cv::Point p) const { return screening.weight[candidates.hole.index(p)]; }
  float color(const Screening& screening, cv::Point p) const { return screening.color[candidates.hole.index(p)][1]; }
};

constexpr float kMaxWeight = 1e-2F;
const cv::Point kLeft(65, 100), kMiddle(150, 100), kRight(234, 100);

TEST(Screening, IsNoneForAConstantDifference) {
  const BoundaryCase c([](cv::Point) { return 150.0F; });
  const Screening screening = c.run();
  EXPECT_LT(*std::max_element(screening.weight.begin(), screening.weight.end()), 1e-6F * kMaxWeight);
  EXPECT_NEAR(c.color(screening, kMiddle), 250, 1e-3);
}

TEST(Screening, IsSmallForADifferenceThatChangesSlowly) {
  const BoundaryCase c([](cv::Point p) { return 0.1F * static_cast<float>(p.x); });
  const Screening screening = c.run();
  EXPECT_LT(*std::max_element(screening.weight.begin(), screening.weight.end()), 0.01F * kMaxWeight);
  EXPECT_NEAR(c.color(screening, kLeft), 106.5, 2);
  EXPECT_NEAR(c.color(screening, kRight), 123.4, 2);
}

TEST(Screening, IsLargeAtAnInconsistentBoundary) {
  // At the left, groups of eight pixels alternate between a difference of 200 levels and none.
  const BoundaryCase c([](cv::Point p) { return p.x < 100 && (p.x + p.y) / 8 % 2 == 0 ? 200.0F : 0.0F; });
  const Screening screening = c.run();
  EXPECT_GT(c.weight(screening, kLeft), 0.9F * kMaxWeight);
  EXPECT_LT(c.weight(screening, kRight), 0.1F * kMaxWeight);
  EXPECT_NEAR(c.color(screening, kLeft), 100, 30) << "not the mean of the boundary";
  EXPECT_NEAR(c.color(screening, kRight), 100, 1);
}

TEST(Screening, IsLargeWhereSourcesContradictEachOther) {
  BoundaryCase c([](cv::Point) { return 50.0F; });
  for (int y = 60; y < 140; ++y)
    for (const int x : {80, 220}) c.copies.seams[c.candidates.hole.index({x, y})][0] = {{}, 2, x == 80 ? 150.0F : 10.0F, {}};
  const Screening screening = c.run();
  EXPECT_GT(c.weight(screening, {80, 100}), 0.9F * kMaxWeight);
  EXPECT_LT(c.weight(screening, {220, 100}), 0.1F * kMaxWeight);
  EXPECT_NEAR(c.color(screening, {80, 100}), 150, 1e-3) << "in the illumination of the boundary";
}

TEST(Seam, HasALowerWeightTheMoreItsSourcesDiffer) {
  EXPECT_EQ((Seam{{}, 2, 0, {}}.weight()), 1);
  EXPECT_EQ((Seam{{}, 2, kSeam.inconsistent_seam_levels, {}}.weight()), 0.25F);
  EXPECT_LT((Seam{{}, 2, 250, {}}.weight()), 0.01F);
}

TEST(Screening, IsNoneInThePublishedModel) {
  const BoundaryCase c([](cv::Point p) { return p.x % 2 == 0 ? 200.0F : 0.0F; });
  const Screening screening = c.run(BoundaryModel::published);
  EXPECT_EQ(*std::max_element(screening.weight.begin(), screening.weight.end()), 0);
  EXPECT_EQ(screening.color, c.copies.color);
}

TEST(Screening, IsNoneWithoutABoundary) {
  BoundaryCase c([](cv::Point) { return 0.0F; });
  c.copies.boundary.clear();
  EXPECT_EQ(c.weight(c.run(), kMiddle), 0);
}

TEST(Screening, IsConstantForCopiesOfOtherDrives) {
  BoundaryCase c([](cv::Point) { return 60.0F; });
  c.copies.from_other_drives = true;
  for (const BoundaryModel model : {BoundaryModel::published, BoundaryModel::robust}) {
    EXPECT_EQ(c.weight(c.run(model), kMiddle), kMaxWeight);
    EXPECT_EQ(c.color(c.run(model), kMiddle), 100);
  }
}

}  // namespace
}  // namespace dvi::harmonize
