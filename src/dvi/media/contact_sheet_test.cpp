#include "dvi/media/contact_sheet.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace dvi::media {
namespace {

TEST(ContactSheet, ArrangesImagesSideBySideAtOneWidth) {
  const cv::Mat3b red(100, 200, cv::Vec3b(0, 0, 255)), blue(50, 100, cv::Vec3b(255, 0, 0));
  const cv::Mat3b sheet = make_contact_sheet({{{red, "1 input"}, {blue, "1 result"}}, {{blue, "2 input"}}}, 100);
  EXPECT_EQ(sheet.cols, 4 + 2 * 104);
  EXPECT_EQ(sheet.rows, 4 + 2 * (50 + 20 + 4));
  EXPECT_EQ(sheet(4 + 25, 4 + 50), cv::Vec3b(0, 0, 255));
  EXPECT_EQ(sheet(4 + 25, 4 + 104 + 50), cv::Vec3b(255, 0, 0));
  EXPECT_EQ(sheet(4 + 74 + 25, 4 + 50), cv::Vec3b(255, 0, 0));
  EXPECT_EQ(make_contact_sheet({}, 100).rows, 4);
}

TEST(ContactSheet, TintsTheMaskOnly) {
  const cv::Mat3b gray(40, 40, cv::Vec3b(100, 100, 100));
  cv::Mat1b mask(40, 40, uchar{0});
  mask(cv::Rect(10, 10, 20, 20)) = 255;
  const cv::Mat3b overlay = draw_mask_overlay(gray, mask);
  EXPECT_EQ(overlay(2, 2), gray(2, 2));
  EXPECT_GT(overlay(20, 20)[2], 150);
  EXPECT_LT(overlay(20, 20)[0], 100);
}

TEST(ContactSheet, FindsTheDensestPartOfTheMask) {
  cv::Mat1b mask(100, 200, uchar{0});
  mask(cv::Rect(0, 0, 6, 6)) = 255;
  mask(cv::Rect(130, 50, 40, 20)) = 255;
  const cv::Rect part = find_densest_part(mask, {80, 40});
  EXPECT_EQ(part.size(), cv::Size(80, 40));
  EXPECT_EQ(part & cv::Rect(130, 50, 40, 20), cv::Rect(130, 50, 40, 20));
  EXPECT_EQ(find_densest_part(mask, {500, 500}), cv::Rect(0, 0, 200, 100)) << "not larger than the image";
}

TEST(ContactSheet, ColorsLabels) {
  const cv::Mat3b gray(4, 4, cv::Vec3b(90, 90, 90));
  cv::Mat1b labels(4, 4, uchar{0});
  labels(1, 1) = 2;
  labels(2, 2) = 9;
  const cv::Mat3b out = draw_label_overlay(gray, labels, {{}, {}, {0, 30, 240}});
  EXPECT_EQ(out(0, 0), gray(0, 0));
  EXPECT_EQ(out(1, 1), cv::Vec3b(30, 50, 190));
  EXPECT_EQ(out(2, 2), gray(2, 2)) << "the label has no color";
}

TEST(ContactSheet, FitsCaptionsIntoTheImage) {
  for (const int width : {8, 60, 1200}) {
    cv::Mat3b image(40, width, cv::Vec3b(200, 200, 200));
    write_caption(image, "0000000123  copied 20 %  interpolated 80 %");
    EXPECT_LT(cv::mean(image)[0], 200) << width;
    EXPECT_EQ(image(0, width - 1), cv::Vec3b(200, 200, 200)) << width;
  }
}

TEST(ContactSheet, ReturnsAThumbnailUnchanged) {
  const cv::Mat3b image(90, 160, cv::Vec3b(1, 2, 3));
  const cv::Mat3b small = make_thumbnail(image, 80);
  EXPECT_EQ(small.size(), cv::Size(80, 45));
  EXPECT_EQ(make_thumbnail(small, 80).data, small.data);
}

}  // namespace
}  // namespace dvi::media
