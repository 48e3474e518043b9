#include "dvi/metrics/artifacts.h"

#include <gtest/gtest.h>

#include "dvi/metrics/test_result.h"

namespace dvi::metrics {
namespace {

class ArtifactsTest : public ResultFixture {
 protected:
  Artifacts count(const std::vector<std::string>& names) const { return count_artifacts(folder / "out", names); }
  void add_result(const std::string& name, const cv::Mat3b& result) const {
    add(name, {make_scene(kSize, 0), result, box(kHole), box(kHole, 1)});
  }
  static cv::Mat3b make_spot(uchar level) {
    cv::Mat3b image = make_scene(kSize, 0);
    image(cv::Rect(50, 35, 2, 2)).setTo(cv::Scalar::all(level));
    return image;
  }
};

TEST_F(ArtifactsTest, AStaticResultHasNone) {
  for (const char* name : {"0", "1", "2"}) add_result(name, make_scene(kSize, 0));
  const Artifacts found = count({"0", "1", "2"});
  EXPECT_EQ(found.hole, 3U * kHole.area());
  EXPECT_EQ(found.hole_between, static_cast<std::size_t>(kHole.area())) << "only the middle frame has two neighbors";
  EXPECT_GT(found.ring_between, 0U);
  EXPECT_EQ(found.flashes + found.ring_flashes + found.overshoots, 0U);
}

TEST_F(ArtifactsTest, ASpotOfOneFrameFlashesAndOvershoots) {
  add_result("0", make_scene(kSize, 0));
  add_result("1", make_spot(255));
  add_result("2", make_scene(kSize, 0));
  const Artifacts found = count({"0", "1", "2"});
  EXPECT_EQ(found.overshoots, 4U);
  EXPECT_GE(found.flashes, 3U);
  EXPECT_LE(found.flashes, 12U) << "flow may enlarge it";
  EXPECT_EQ(found.ring_flashes, 0U);
  EXPECT_DOUBLE_EQ(found.overshoot_ppm(), 4e6 / (3 * kHole.area()));
}

TEST_F(ArtifactsTest, ASpotThatStaysDoesNotFlash) {
  for (const char* name : {"0", "1", "2"}) add_result(name, make_spot(255));
  const Artifacts found = count({"0", "1", "2"});
  EXPECT_EQ(found.overshoots, 12U);
  EXPECT_EQ(found.flashes, 0U);
}

TEST_F(ArtifactsTest, FramesWithoutHoleAndSmallImagesHaveNone) {
  add("0", {make_scene(kSize, 0), make_scene(kSize, 0), cv::Mat1b(kSize, uchar{0}), cv::Mat1b(kSize, uchar{0})});
  EXPECT_EQ(count({"0"}).hole, 0U);
  EXPECT_EQ(count({"0"}).flash_ppm(), 0);
  const cv::Size small(16, 16);
  for (const char* name : {"1", "2", "3"})
    add(name, {make_scene(small, 0), make_scene(small, 0), cv::Mat1b(small, uchar{255}), cv::Mat1b(small, uchar{1})});
  const Artifacts found = count({"1", "2", "3"});
  EXPECT_EQ(found.hole, 3U * 256);
  EXPECT_EQ(found.hole_between, 0U);
}

}  // namespace
}  // namespace dvi::metrics
