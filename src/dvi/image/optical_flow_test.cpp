#include "dvi/image/optical_flow.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/core/random.h"
#include "dvi/image/gray.h"

namespace dvi {
namespace {

TEST(OpticalFlow, PointsFromOneImageIntoTheOther) {
  constexpr int kShiftPx = 3;
  Random random(5);
  cv::Mat1b wide(96, 128 + kShiftPx);
  for (uchar& pixel : wide) pixel = static_cast<uchar>(random.below(256));
  cv::GaussianBlur(wide, wide, {}, 2);
  const cv::Mat1b from = wide(cv::Rect(kShiftPx, 0, 128, 96)).clone(), to = wide(cv::Rect(0, 0, 128, 96)).clone();
  const cv::Mat2f flow = compute_optical_flow(from, to);
  double sum = 0;
  for (int y = 20; y < 76; ++y)
    for (int x = 20; x < 108; ++x) sum += cv::norm(flow(y, x) - cv::Vec2f(kShiftPx, 0));
  EXPECT_LT(sum / (56 * 88), 0.1);
}

TEST(Gray, IsWeightedAndRounded) {
  const cv::Mat3b colors =
      (cv::Mat3b(1, 4) << cv::Vec3b(255, 0, 0), cv::Vec3b(0, 255, 0), cv::Vec3b(0, 0, 255), cv::Vec3b(90, 90, 90));
  const cv::Mat1b gray = gray_8bit(colors);
  EXPECT_EQ(std::vector<int>(gray.begin(), gray.end()), (std::vector<int>{29, 150, 76, 90}));
}

}  // namespace
}  // namespace dvi
