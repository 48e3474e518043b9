#include "dvi/io/image_file.h"

#include <optional>
#include <string>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "dvi/core/error.h"

namespace dvi::io {
namespace {

constexpr const char* kRemedy = "replace or remove the file";

std::string text(cv::Size size) { return std::to_string(size.width) + "x" + std::to_string(size.height); }

int byte(const std::string& bytes, std::size_t i) { return static_cast<unsigned char>(bytes[i]); }
int big_endian(const std::string& bytes, std::size_t i) { return byte(bytes, i) << 8 | byte(bytes, i + 1); }

bool is_jpeg(const std::string& bytes) { return bytes.starts_with("\xFF\xD8"); }
bool is_png(const std::string& bytes) { return bytes.starts_with("\x89PNG\r\n\x1A\n"); }

std::optional<cv::Size> jpeg_size(const std::string& bytes) {
  for (std::size_t at = 2; at + 9 < bytes.size() && byte(bytes, at) == 0xFF;) {
    const int marker = byte(bytes, at + 1);
    const bool start_of_frame = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (start_of_frame) return cv::Size(big_endian(bytes, at + 7), big_endian(bytes, at + 5));
    at += marker == 0xFF ? 1 : 2 + static_cast<std::size_t>(big_endian(bytes, at + 2));
  }
  return std::nullopt;
}

// libjpeg fills what is missing of a cut file with grey and calls it a success; the end marker tells.
bool whole(const std::string& bytes) {
  if (is_jpeg(bytes)) return bytes.find("\xFF\xD9", bytes.size() / 2) != std::string::npos;
  if (is_png(bytes)) return bytes.rfind("IEND") != std::string::npos;
  return true;
}

// Empty where it is no image, or not all of one.
cv::Mat decode(const fs::path& path, cv::ImreadModes mode) {
  const std::string bytes = read_file(path);
  if (bytes.empty() || !whole(bytes)) return {};
  try {
    const cv::Mat1b buffer(1, static_cast<int>(bytes.size()), reinterpret_cast<uchar*>(const_cast<char*>(bytes.data())));
    return cv::imdecode(buffer, mode);
  } catch (const cv::Exception& e) {
    throw InputError(path, "cannot be decoded (" + e.err + ")", kRemedy);
  }
}

cv::Mat decode(const fs::path& path, cv::Size size, cv::ImreadModes mode) {
  cv::Mat image = decode(path, mode);
  if (image.empty()) throw InputError(path, "cannot be decoded as an image", kRemedy);
  if (image.size() != size)
    throw InputError(path, "is " + text(image.size()) + " pixels instead of " + text(size),
                     "images, masks and calibration must be of one size");
  return image;
}

}  // namespace

cv::Size image_size(const fs::path& path) {
  const std::string bytes = read_file(path);
  std::optional<cv::Size> size;
  if (is_png(bytes) && bytes.size() > 24)
    size = cv::Size(big_endian(bytes, 16) << 16 | big_endian(bytes, 18), big_endian(bytes, 20) << 16 | big_endian(bytes, 22));
  if (is_jpeg(bytes)) size = jpeg_size(bytes);
  if (!size || size->width <= 0 || size->height <= 0)
    throw InputError(path, "cannot be decoded as an image", "PNG and JPEG are read");
  return *size;
}

cv::Mat3b read_image(const fs::path& path, cv::Size size) { return decode(path, size, cv::IMREAD_COLOR); }

cv::Mat read_unchanged(const fs::path& path) { return decode(path, cv::IMREAD_UNCHANGED); }

cv::Mat1b read_mask(const fs::path& path, cv::Size size) {
  cv::Mat1b mask;
  cv::compare(decode(path, size, cv::IMREAD_GRAYSCALE), 0, mask, cv::CMP_GT);
  return mask;
}

}  // namespace dvi::io
