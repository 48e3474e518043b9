#include "dvi/harmonize/confidence.h"

#include <vector>

#include <gtest/gtest.h>

namespace dvi::harmonize {
namespace {

TEST(Confidence, DecreasesWithEachPieceOfEvidence) {
  const CopyEvidence some{.position_error_px = 0.3, .texture = 10, .spread = 3, .change = 3, .seconds = 1};
  CopyEvidence worse[] = {some, some, some, some, some, some};
  worse[0].position_error_px *= 2;
  worse[1].texture *= 2;
  worse[2].spread *= 2;
  worse[3].change *= 2;
  worse[4].seconds *= 2;
  worse[5].is_other_drive = true;
  for (const CopyEvidence& evidence : worse) EXPECT_GT(estimate_error_levels(evidence), estimate_error_levels(some));
  EXPECT_GT(confidence_of_copy(estimate_error_levels({})), 0.98);
  CopyEvidence changed = worse[5];
  changed.change = 100, changed.seconds = 1e6;
  EXPECT_EQ(estimate_error_levels(changed), estimate_error_levels(worse[5]))
      << "a change of illumination is expected between drives";
  EXPECT_GT(confidence_of_copy(estimate_error_levels(
                {.position_error_px = 1e6, .texture = 255, .spread = 255, .change = 255, .seconds = 1e6})),
            0);
  EXPECT_GT(confidence_of_interpolation(1), confidence_of_interpolation(5));
}

// Copies whose errors are `scale` times the expected ones, over all sizes of errors.
std::vector<KnownCopy> copies_with_scale(double scale) {
  std::vector<KnownCopy> out;
  for (double expected = 2.5; expected < 200; expected *= 1.1)
    for (int i = 0; i < 1000; ++i) out.push_back({expected, (i + 0.5) / 1000 < confidence_of_copy(1.22 * scale * expected)});
  return out;
}

TEST(ErrorScale, IsTheScaleOfTheKnownCopies) {
  for (const double scale : {0.5, 1.0, 1.7})
    for (const double expected : {5.0, 20.0, 60.0})
      EXPECT_NEAR(ErrorScale(copies_with_scale(scale)).at(expected), scale, 0.06 * scale) << scale << " " << expected;
}

TEST(ErrorScale, IsOneWithoutKnownCopiesAndBoundedIfAllAreWrong) {
  EXPECT_EQ(ErrorScale({}).at(10), 1);
  const ErrorScale wrong(std::vector<KnownCopy>(100000, {5, false}));
  for (const double expected : {0.0, 5.0, 1e9}) {
    EXPECT_GE(wrong.at(expected), 1);
    EXPECT_LE(wrong.at(expected), 4);
  }
  EXPECT_LT(ErrorScale(std::vector<KnownCopy>(10, {5, false})).at(5), wrong.at(5)) << "few copies change the scale less";
}

}  // namespace
}  // namespace dvi::harmonize
