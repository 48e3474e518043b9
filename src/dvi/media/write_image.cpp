#include "dvi/media/write_image.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/core/error.h"
#include "dvi/core/files.h"
#include "dvi/media/image_file.h"
#include "dvi/media/png_encode.h"

namespace dvi::media {
namespace {

cv::Mat read_as(const fs::path& path, cv::Size size, int type, const std::string& expected) {
  cv::Mat image = read_unchanged(path, size);
  if (image.type() != type || image.size() != size)
    throw InputError(path, "is not " + expected + " image of " + std::to_string(size.width) + "x" + std::to_string(size.height),
                     "write it again with the program that made it");
  return image;
}

}  // namespace

void write_png(const fs::path& path, const cv::Mat& image) { write_file(path, encode_png(image)); }

void write_jpeg(const fs::path& path, const cv::Mat3b& image, int quality) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  write_file(path, {bytes.begin(), bytes.end()});
}

cv::Mat1b read_png_gray(const fs::path& path, cv::Size size) { return read_as(path, size, CV_8UC1, "an 8-bit gray"); }

cv::Mat1w read_png_depth(const fs::path& path, cv::Size size) { return read_as(path, size, CV_16UC1, "a 16-bit gray"); }

cv::Mat_<cv::Vec3w> read_png_triples(const fs::path& path, cv::Size size) {
  cv::Mat image = read_as(path, size, CV_16UC3, "a 16-bit RGB");
  cv::cvtColor(image, image, cv::COLOR_BGR2RGB);
  return image;
}

}  // namespace dvi::media
