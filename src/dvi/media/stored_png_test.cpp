#include "dvi/media/stored_png.h"

#include <opencv2/imgcodecs.hpp>

#include "dvi/media/png_encode.h"
#include "dvi/testing/image_folder.h"

namespace dvi::media {
namespace {

cv::Mat decode(const std::string& png) {
  return cv::imdecode(std::vector<uchar>(png.begin(), png.end()), cv::IMREAD_UNCHANGED);
}

TEST(StoredPng, HasTheSamePixels) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC3})
    for (const cv::Size size : {cv::Size(1, 1), cv::Size(7, 300), cv::Size(301, 233)}) {
      cv::Mat image(size, type);
      cv::randu(image, 0, 4);
      std::vector<uchar> by_libpng;  // it has several chunks of pixels
      cv::imencode(".png", image, by_libpng);
      for (const std::string& png : {encode_png(image), std::string(by_libpng.begin(), by_libpng.end())}) {
        const std::optional<std::string> stored = store_png(png);
        ASSERT_TRUE(stored.has_value());
        const cv::Mat read = decode(*stored);
        ASSERT_EQ(read.type(), type);
        EXPECT_EQ(cv::norm(read, decode(png), cv::NORM_INF), 0);
      }
    }
}

TEST(StoredPng, RefusesFilesThatItDoesNotUnderstand) {
  std::string png = encode_png(cv::Mat3b(20, 30, cv::Vec3b(1, 2, 3)));
  EXPECT_FALSE(store_png("").has_value());
  EXPECT_FALSE(store_png(png.substr(0, png.size() / 2)).has_value());
  const auto change = [&](std::size_t at, char value) {
    std::string changed = png;
    changed[at] = value;
    return changed;
  };
  EXPECT_FALSE(store_png(change(28, 1)).has_value()) << "interlaced";
  EXPECT_FALSE(store_png(change(25, 5)).has_value()) << "unknown type of color";
  EXPECT_FALSE(store_png(change(23, 21)).has_value()) << "more rows than pixels";
  EXPECT_FALSE(store_png(change(23, 19)).has_value()) << "fewer rows than pixels";
}

}  // namespace
}  // namespace dvi::media
