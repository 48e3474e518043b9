#include "dvi/harmonize/confidence.h"

#include <vector>

#include <gtest/gtest.h>

namespace dvi::harmonize {
namespace {

TEST(Confidence, FallsWithEachPieceOfEvidence) {
  const CopyEvidence some{.shift = 0.3, .texture = 10, .spread = 3, .change = 3, .seconds = 1};
  CopyEvidence worse[] = {some, some, some, some, some, some};
  worse[0].shift *= 2;
  worse[1].texture *= 2;
  worse[2].spread *= 2;
  worse[3].change *= 2;
  worse[4].seconds *= 2;
  worse[5].elsewhere = true;
  for (const CopyEvidence& evidence : worse) EXPECT_GT(expected_error(evidence), expected_error(some));
  EXPECT_GT(copied_confidence(expected_error({})), 0.98);
  CopyEvidence other_day = worse[5];
  other_day.change = 100, other_day.seconds = 1e6;
  EXPECT_EQ(expected_error(other_day), expected_error(worse[5])) << "another day's light is another in any case";
  EXPECT_GT(copied_confidence(expected_error({.shift = 1e6, .texture = 255, .spread = 255, .change = 255, .seconds = 1e6})), 0);
  EXPECT_GT(interpolated_confidence(1), interpolated_confidence(5));
}

// Copies whose confidence is right for errors that are `scale` times those expected, over all sizes of errors.
std::vector<KnownCopy> copies_off_by(double scale) {
  std::vector<KnownCopy> out;
  for (double expected = 2.5; expected < 200; expected *= 1.1)
    for (int i = 0; i < 1000; ++i) out.push_back({expected, (i + 0.5) / 1000 < copied_confidence(1.22 * scale * expected)});
  return out;
}

TEST(ErrorScale, IsThatOfTheKnownCopies) {
  for (const double scale : {0.5, 1.0, 1.7})
    for (const double expected : {5.0, 20.0, 60.0})
      EXPECT_NEAR(ErrorScale(copies_off_by(scale)).at(expected), scale, 0.06 * scale) << scale << " " << expected;
}

TEST(ErrorScale, IsOneWithoutKnownCopiesAndBoundedWithWrongOnes) {
  EXPECT_EQ(ErrorScale({}).at(10), 1);
  const ErrorScale wrong(std::vector<KnownCopy>(100000, {5, false}));
  for (const double expected : {0.0, 5.0, 1e9}) {
    EXPECT_GE(wrong.at(expected), 1);
    EXPECT_LE(wrong.at(expected), 4);
  }
  EXPECT_LT(ErrorScale(std::vector<KnownCopy>(10, {5, false})).at(5), wrong.at(5)) << "few say little";
}

}  // namespace
}  // namespace dvi::harmonize
