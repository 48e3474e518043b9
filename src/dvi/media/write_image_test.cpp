#include "dvi/media/write_image.h"

#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "dvi/core/random.h"
#include "dvi/media/image_file.h"
#include "dvi/testing/temp_folder.h"

namespace dvi::media {
namespace {

class WriteImage : public testing::Test {
 protected:
  const TempFolder temporary;
  const fs::path folder = temporary.path;
};

template <class T>
cv::Mat_<T> noise(cv::Size size, int levels) {
  Random random(1);
  cv::Mat_<T> image(size);
  cv::Mat flat = image.reshape(1);
  for (int y = 0; y < flat.rows; ++y)
    for (int x = 0; x < flat.cols; ++x) {
      const int value = random.below(levels);
      if (flat.depth() == CV_8U) flat.at<uchar>(y, x) = static_cast<uchar>(value);
      if (flat.depth() == CV_16U) flat.at<ushort>(y, x) = static_cast<ushort>(value);
    }
  return image;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.type() == b.type() && a.size() == b.size() && cv::norm(a.reshape(1), b.reshape(1), cv::NORM_INF) == 0;
}

TEST_F(WriteImage, ReadsBackWrittenImages) {
  const cv::Size size(37, 21);
  const fs::path path = folder / "1534313591.432032.png";
  const auto color = noise<cv::Vec3b>(size, 256);
  write_png(path, color);
  EXPECT_TRUE(same(cv::imread(path.string(), cv::IMREAD_UNCHANGED), color));
  const auto gray = noise<uchar>(size, 256);
  write_png(path, gray);
  EXPECT_TRUE(same(read_png_gray(path, size), gray));
  const auto depth = noise<ushort>(size, 65536);
  write_png(path, depth);
  EXPECT_TRUE(same(read_png_depth(path, size), depth));
  const auto triples = noise<cv::Vec3w>(size, 65536);
  write_png(path, triples);
  EXPECT_TRUE(same(read_png_triples(path, size), triples));
  EXPECT_EQ(list_files(folder, {".png"}).size(), 1U);
}

// Smooth rows, empty rows and noise, so that each filter is chosen somewhere; single pixels and columns.
TEST_F(WriteImage, ReadsBackAllFiltersAndSizes) {
  const fs::path path = folder / "a.png";
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(1, 9), cv::Size(9, 1), cv::Size(64, 48)}) {
    cv::Mat3b color = noise<cv::Vec3b>(size, 256);
    cv::Mat_<cv::Vec3w> triples = noise<cv::Vec3w>(size, 65536);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        if (y % 4 == 0) continue;
        const int value = y % 4 == 1 ? 0 : y % 4 == 2 ? 3 * x : 5 * y + 2 * x;
        color(y, x) = cv::Vec3b::all(static_cast<uchar>(value));
        triples(y, x) = cv::Vec3w::all(static_cast<ushort>(300 * value));
      }
    write_png(path, color);
    EXPECT_TRUE(same(cv::imread(path.string(), cv::IMREAD_UNCHANGED), color)) << size;
    write_png(path, triples);
    EXPECT_TRUE(same(read_png_triples(path, size), triples)) << size;
  }
}

TEST_F(WriteImage, WritesChannelsInTheOrderOfTheFormat) {
  const fs::path path = folder / "a.png";
  write_png(path, cv::Mat3b(2, 2, cv::Vec3b(10, 20, 30)));
  const cv::Mat color = cv::imread(path.string(), cv::IMREAD_UNCHANGED);  // OpenCV converts the file's RGB to BGR
  EXPECT_EQ(color.at<cv::Vec3b>(0, 0), cv::Vec3b(10, 20, 30));
  write_png(path, cv::Mat_<cv::Vec3w>(2, 2, cv::Vec3w(1, 16 * 500, 16 * 300)));
  const cv::Mat triples = cv::imread(path.string(), cv::IMREAD_UNCHANGED);
  EXPECT_EQ(triples.at<cv::Vec3w>(0, 0), cv::Vec3w(16 * 300, 16 * 500, 1));
}

TEST_F(WriteImage, ReportsFilesThatCannotBeWrittenOrRead) {
  EXPECT_THROW(write_png(folder / "none" / "a.png", cv::Mat1b(2, 2, uchar{0})), InputError);
  EXPECT_THROW(write_png(folder / "a.png", cv::Mat1f(2, 2, 0.0F)), std::logic_error);
  const fs::path path = folder / "a.png";
  EXPECT_THROW(read_png_gray(path, {2, 2}), InputError);
  write_png(path, cv::Mat1b(2, 2, uchar{0}));
  EXPECT_NO_THROW(read_png_gray(path, {2, 2}));
  EXPECT_THROW(read_png_gray(path, {2, 3}), InputError);
  EXPECT_THROW(read_png_depth(path, {2, 2}), InputError);
  EXPECT_THROW(read_png_triples(path, {2, 2}), InputError);
  const std::string bytes = read_file(path);
  for (const std::size_t left : {std::size_t{0}, std::size_t{20}, bytes.size() - 24}) {
    write_file(path, bytes.substr(0, left));
    EXPECT_THROW(read_png_gray(path, {2, 2}), InputError) << left;
  }
}

}  // namespace
}  // namespace dvi::media
