#include "dvi/harmonize/hold.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "dvi/harmonize/copies.h"
#include "dvi/image/region.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {
namespace {

/// Copies of 100 in a hole whose rim differs from its sources by what `difference` says of each place.
struct RimCase {
  sample::Candidates candidates;
  Copies copies;

  template <class Difference>
  explicit RimCase(const Difference& difference) {
    const cv::Rect where(60, 40, 180, 120);
    cv::Mat1b mask(200, 300, uchar{0});
    mask(where) = 255;
    candidates = {Region(mask), std::vector<sample::Candidate>(Region(mask).size(), sample::Candidate{1, {}})};
    copies.color.assign(candidates.hole.size(), cv::Vec3f::all(100));
    copies.seams.resize(candidates.hole.size());
    for (int x = where.x; x < where.br().x; ++x)
      for (const int y : {where.y - 1, where.br().y}) add({x, y}, difference);
    for (int y = where.y; y < where.br().y; ++y)
      for (const int x : {where.x - 1, where.br().x}) add({x, y}, difference);
  }
  template <class Difference>
  void add(cv::Point p, const Difference& difference) {
    copies.rim.push_back({p, 1, cv::Vec3f::all(difference(p))});
  }
  Hold held(bool robust = true) const { return hold_of(copies, candidates, robust); }
  float weight(const Hold& hold, cv::Point p) const { return hold.weight[candidates.hole.index(p)]; }
  float color(const Hold& hold, cv::Point p) const { return hold.color[candidates.hole.index(p)][1]; }
};

constexpr float kFull = 1e-2F;
const cv::Point kLeft(65, 100), kMiddle(150, 100), kRight(234, 100);

TEST(Hold, AnotherLightIsLeftToTheRim) {
  const RimCase c([](cv::Point) { return 150.0F; });
  const Hold hold = c.held();
  EXPECT_LT(*std::max_element(hold.weight.begin(), hold.weight.end()), 1e-6F * kFull);
  EXPECT_NEAR(c.color(hold, kMiddle), 250, 1e-3);
}

TEST(Hold, LightThatChangesSlowlyIsLeftToTheRim) {
  const RimCase c([](cv::Point p) { return 0.1F * static_cast<float>(p.x); });
  const Hold hold = c.held();
  EXPECT_LT(*std::max_element(hold.weight.begin(), hold.weight.end()), 0.01F * kFull);
  EXPECT_NEAR(c.color(hold, kLeft), 106.5, 2);
  EXPECT_NEAR(c.color(hold, kRight), 123.4, 2);
}

TEST(Hold, ARimThatContradictsItselfIsNotFollowed) {
  // At the left every other eight pixels are off by 200 levels; at the right all are right.
  const RimCase c([](cv::Point p) { return p.x < 100 && (p.x + p.y) / 8 % 2 == 0 ? 200.0F : 0.0F; });
  const Hold hold = c.held();
  EXPECT_GT(c.weight(hold, kLeft), 0.9F * kFull);
  EXPECT_LT(c.weight(hold, kRight), 0.1F * kFull);
  EXPECT_NEAR(c.color(hold, kLeft), 100, 30) << "nor is its mean";
  EXPECT_NEAR(c.color(hold, kRight), 100, 1);
}

TEST(Hold, WhereSourcesContradictEachOtherCopiesAreHeld) {
  RimCase c([](cv::Point) { return 50.0F; });
  for (int y = 60; y < 140; ++y)
    for (const int x : {80, 220}) c.copies.seams[c.candidates.hole.index({x, y})][0] = {{}, 2, x == 80 ? 150.0F : 10.0F, {}};
  const Hold hold = c.held();
  EXPECT_GT(c.weight(hold, {80, 100}), 0.9F * kFull);
  EXPECT_LT(c.weight(hold, {220, 100}), 0.1F * kFull);
  EXPECT_NEAR(c.color(hold, {80, 100}), 150, 1e-3) << "in the light of the rim";
}

TEST(Seam, CountsLessTheMoreItsSourcesDiffer) {
  EXPECT_EQ((Seam{{}, 2, 0, {}}.weight()), 1);
  EXPECT_EQ((Seam{{}, 2, kDoubtfulSeam, {}}.weight()), 0.25F);
  EXPECT_LT((Seam{{}, 2, 250, {}}.weight()), 0.01F);
}

TEST(Hold, WithoutARobustRimNothingIsHeld) {
  const RimCase c([](cv::Point p) { return p.x % 2 == 0 ? 200.0F : 0.0F; });
  const Hold hold = c.held(false);
  EXPECT_EQ(*std::max_element(hold.weight.begin(), hold.weight.end()), 0);
  EXPECT_EQ(hold.color, c.copies.color);
}

TEST(Hold, WithoutARimNothingIsHeld) {
  RimCase c([](cv::Point) { return 0.0F; });
  c.copies.rim.clear();
  EXPECT_EQ(c.weight(c.held(), kMiddle), 0);
}

TEST(Hold, CopiesOfOtherDaysAreHeldByTheirOwnColors) {
  RimCase c([](cv::Point) { return 60.0F; });
  c.copies.of_other_days = true;
  for (const bool robust : {false, true}) {
    EXPECT_EQ(c.weight(c.held(robust), kMiddle), kFull);
    EXPECT_EQ(c.color(c.held(robust), kMiddle), 100);
  }
}

}  // namespace
}  // namespace dvi::harmonize
