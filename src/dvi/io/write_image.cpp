#include "dvi/io/write_image.h"

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/core/error.h"
#include "dvi/core/files.h"
#include "dvi/io/image_file.h"

namespace dvi::io {
namespace {

// Measured at 1280x720: 35 ms and 1.34 MB a street image; zlib's own strategy at level 1 takes 40 ms for 1.27 MB, at level 3
// 55 ms for 1.20 MB. On real images run lengths of the filtered rows are smaller too (0.69 against 0.78 MB), on masks by far.
const std::vector<int> kFast = {cv::IMWRITE_PNG_COMPRESSION, 1, cv::IMWRITE_PNG_STRATEGY, cv::IMWRITE_PNG_STRATEGY_RLE};
const std::vector<int> kSmall = {cv::IMWRITE_PNG_COMPRESSION, 2};

cv::Mat read_as(const fs::path& path, cv::Size size, int type, const std::string& expected) {
  cv::Mat image = read_unchanged(path);
  if (image.type() != type || image.size() != size)
    throw InputError(path, "is no " + expected + " image of " + std::to_string(size.width) + "x" + std::to_string(size.height),
                     "let the program that wrote it write it anew");
  return image;
}

}  // namespace

void write_png(const fs::path& path, const cv::Mat& image, PngEffort effort) {
  cv::Mat ordered;
  if (image.type() == CV_16UC3)
    cv::cvtColor(image, ordered, cv::COLOR_RGB2BGR);
  else
    ordered = image;
  std::vector<uchar> bytes;
  if (!cv::imencode(".png", ordered, bytes, effort == PngEffort::fast ? kFast : kSmall))
    throw std::logic_error("no PNG can hold this type of image");
  write_file(path, std::string(bytes.begin(), bytes.end()));
}

cv::Mat1b read_png_grey(const fs::path& path, cv::Size size) { return read_as(path, size, CV_8UC1, "8-bit grey"); }

cv::Mat1w read_png_depth(const fs::path& path, cv::Size size) { return read_as(path, size, CV_16UC1, "16-bit grey"); }

cv::Mat_<cv::Vec3w> read_png_triples(const fs::path& path, cv::Size size) {
  cv::Mat image = read_as(path, size, CV_16UC3, "16-bit RGB");
  cv::cvtColor(image, image, cv::COLOR_BGR2RGB);
  return image;
}

}  // namespace dvi::io
