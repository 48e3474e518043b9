#include "dvi/io/contact_sheet.h"

#include <gtest/gtest.h>

namespace dvi::io {
namespace {

TEST(ContactSheet, PutsPicturesSideBySideAtOneWidth) {
  const cv::Mat3b red(100, 200, cv::Vec3b(0, 0, 255)), blue(50, 100, cv::Vec3b(255, 0, 0));
  const cv::Mat3b sheet = contact_sheet({{{red, "1 input"}, {blue, "1 result"}}, {{blue, "2 input"}}}, 100);
  EXPECT_EQ(sheet.cols, 4 + 2 * 104);
  EXPECT_EQ(sheet.rows, 4 + 2 * (50 + 20 + 4));
  EXPECT_EQ(sheet(4 + 25, 4 + 50), cv::Vec3b(0, 0, 255));
  EXPECT_EQ(sheet(4 + 25, 4 + 104 + 50), cv::Vec3b(255, 0, 0));
  EXPECT_EQ(sheet(4 + 74 + 25, 4 + 50), cv::Vec3b(255, 0, 0));
  EXPECT_EQ(contact_sheet({}, 100).rows, 4);
}

TEST(ContactSheet, TintsTheMaskOnly) {
  const cv::Mat3b grey(40, 40, cv::Vec3b(100, 100, 100));
  cv::Mat1b mask(40, 40, uchar{0});
  mask(cv::Rect(10, 10, 20, 20)) = 255;
  const cv::Mat3b overlay = mask_overlay(grey, mask);
  EXPECT_EQ(overlay(2, 2), grey(2, 2));
  EXPECT_GT(overlay(20, 20)[2], 150);
  EXPECT_LT(overlay(20, 20)[0], 100);
}

TEST(ContactSheet, LeavesAThumbnailAsItIs) {
  const cv::Mat3b image(90, 160, cv::Vec3b(1, 2, 3));
  const cv::Mat3b small = thumbnail(image, 80);
  EXPECT_EQ(small.size(), cv::Size(80, 45));
  EXPECT_EQ(thumbnail(small, 80).data, small.data);
}

}  // namespace
}  // namespace dvi::io
