#include "dvi/media/image_file.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>

#include <libdeflate.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "dvi/core/error.h"
#include "dvi/geometry/camera.h"
#include "dvi/media/numpy_file.h"

namespace dvi::media {
namespace {

constexpr const char* kRemedy = "replace or remove the file";

std::string to_text(cv::Size size) { return std::to_string(size.width) + "x" + std::to_string(size.height); }

int get_byte(const std::string& bytes, std::size_t i) { return static_cast<unsigned char>(bytes[i]); }
int read_big_endian(const std::string& bytes, std::size_t i) { return get_byte(bytes, i) << 8 | get_byte(bytes, i + 1); }

bool is_jpeg(const std::string& bytes) { return bytes.starts_with("\xFF\xD8"); }
bool is_png(const std::string& bytes) { return bytes.starts_with("\x89PNG\r\n\x1A\n"); }

std::optional<cv::Size> read_jpeg_size(const std::string& bytes) {
  for (std::size_t at = 2; at + 9 < bytes.size() && get_byte(bytes, at) == 0xFF;) {
    const int marker = get_byte(bytes, at + 1);
    const bool start_of_frame = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (start_of_frame) return cv::Size(read_big_endian(bytes, at + 7), read_big_endian(bytes, at + 5));
    at += marker == 0xFF ? 1 : 2 + static_cast<std::size_t>(read_big_endian(bytes, at + 2));
  }
  return std::nullopt;
}

// Verifies the checksums of all chunks. libpng would print its errors to the terminal.
bool is_complete_png(const std::string& bytes) {
  for (std::size_t at = 8; at + 12 <= bytes.size();) {
    const auto number = [&](std::size_t i) {
      return static_cast<std::uint32_t>(read_big_endian(bytes, i)) << 16 |
             static_cast<std::uint32_t>(read_big_endian(bytes, i + 2));
    };
    const std::size_t length = number(at);
    if (length > bytes.size() - at - 12) return false;
    if (libdeflate_crc32(0, bytes.data() + at + 4, length + 4) != number(at + 8 + length)) return false;
    if (bytes.compare(at + 4, 4, "IEND") == 0) return true;
    at += 12 + length;
  }
  return false;
}

// Returns whether a file is complete. libjpeg fills the missing part of a truncated file with gray and reports success, so the
// end marker is checked.
bool is_complete(const std::string& bytes) {
  if (is_jpeg(bytes)) return bytes.find("\xFF\xD9", bytes.size() / 2) != std::string::npos;
  return !is_png(bytes) || is_complete_png(bytes);
}

std::optional<cv::Size> read_png_size(const std::string& bytes) {
  if (bytes.size() < 24) return std::nullopt;
  return cv::Size(read_big_endian(bytes, 16) << 16 | read_big_endian(bytes, 18),
                  read_big_endian(bytes, 20) << 16 | read_big_endian(bytes, 22));
}

// Returns the size by the header of a PNG or JPEG; nothing if the file is neither.
std::optional<cv::Size> read_stated_size(const fs::path& path, const std::string& bytes) {
  const std::optional<cv::Size> size = is_png(bytes)    ? read_png_size(bytes)
                                       : is_jpeg(bytes) ? read_jpeg_size(bytes)
                                                        : std::nullopt;
  if (!size || size->width <= 0 || size->height <= 0) return std::nullopt;
  if (std::int64_t{size->width} * size->height > kMaxPixels)
    throw InputError(path, "is " + to_text(*size) + " pixels, above the limit", "use images of at most 2^28 pixels");
  return size;
}

// Decodes an image; returns an empty one if the file is not a complete image.
cv::Mat decode(const fs::path& path, const std::string& bytes, int mode) {
  if (!read_stated_size(path, bytes) || !is_complete(bytes)) return {};
  try {
    const cv::Mat1b buffer(1, static_cast<int>(bytes.size()), reinterpret_cast<uchar*>(const_cast<char*>(bytes.data())));
    return cv::imdecode(buffer, mode);
  } catch (const cv::Exception& e) {
    throw InputError(path, "cannot be decoded (" + e.err + ")", kRemedy);
  }
}

void require_size(const fs::path& path, cv::Size found, cv::Size wanted) {
  if (found != wanted)
    throw InputError(
        path, "is " + to_text(found) + " pixels instead of " + to_text(wanted),
        found == cv::Size(wanted.height, wanted.width)
            ? "it is rotated by 90 degrees: images, masks and calibration must all refer to the pixels as they are "
              "stored, because neither EXIF orientation nor the rotation of a video is applied"
            : "images, masks and calibration must have the same size");
}

cv::Mat decode(const fs::path& path, const std::string& bytes, cv::Size size, int mode) {
  if (const auto stated = read_stated_size(path, bytes)) require_size(path, *stated, size);
  cv::Mat image = decode(path, bytes, mode);
  if (image.empty()) throw InputError(path, "cannot be decoded as an image", kRemedy);
  require_size(path, image.size(), size);
  return image;
}

cv::Mat1b is_not_zero(const cv::Mat& image, int channel) {
  cv::Mat values;
  cv::extractChannel(image, values, channel);
  cv::compare(values, 0, values, cv::CMP_NE);
  return values;
}

bool varies(const cv::Mat& image, int channel) {
  cv::Mat values;
  cv::extractChannel(image, values, channel);
  double low = 0, high = 0;
  cv::minMaxLoc(values, &low, &high);
  return low != high;
}

// Converts a PNG with a palette to one in gray, whose pixels are the indices. Returns nothing if there is no palette.
std::optional<std::string> remove_palette(const std::string& png) {
  constexpr std::size_t kHeaderBytes = 33, kColorTypeByte = 25, kCheckedByte = 12, kChecksumByte = 29;
  constexpr char kPalette = 3, kGray = 0;
  if (!is_png(png) || png.size() < kHeaderBytes || png[kColorTypeByte] != kPalette || !is_complete_png(png))
    return std::nullopt;
  std::string out = png.substr(0, kHeaderBytes);
  out[kColorTypeByte] = kGray;
  const std::uint32_t sum = libdeflate_crc32(0, out.data() + kCheckedByte, kChecksumByte - kCheckedByte);
  for (std::size_t i = 0; i < 4; ++i) out[kChecksumByte + i] = static_cast<char>(sum >> (24 - 8 * i));
  for (std::size_t at = kHeaderBytes; at + 12 <= png.size();) {
    const std::size_t chunk = 12 + (static_cast<std::size_t>(read_big_endian(png, at)) << 16 |
                                    static_cast<std::size_t>(read_big_endian(png, at + 2)));
    if (png.compare(at + 4, 4, "IDAT") == 0 || png.compare(at + 4, 4, "IEND") == 0) out += png.substr(at, chunk);
    at += chunk;
  }
  return out;
}

// Decodes the indices of a PNG with a palette. Returns nothing if there is no palette.
std::optional<cv::Mat> decode_indices(const fs::path& path, const std::string& bytes, cv::Size size) {
  const std::optional<std::string> gray = remove_palette(bytes);
  if (!gray) return std::nullopt;
  constexpr std::size_t kBitDepthByte = 24;  // the decoder scales depths below 8 bits to the whole range
  const int largest = (1 << std::clamp(get_byte(bytes, kBitDepthByte), 1, 8)) - 1, stretched = 255 / largest;
  const cv::Mat indices = decode(path, *gray, size, cv::IMREAD_UNCHANGED);
  return indices.depth() == CV_8U ? cv::Mat(indices / stretched) : indices;
}

// Returns whether the indices of a palette are numbers of objects with the background 0, whatever its color. Otherwise the
// colors count: the image has black pixels that are not 0, or is gray.
bool are_indices_of_objects(const cv::Mat3b& colors, const cv::Mat1b& indices) {
  bool is_gray = true, has_other_black = false, has_colored_background = false;
  auto index = indices.begin();
  for (const cv::Vec3b& color : colors) {
    const bool is_background = *index++ == 0, is_black = color == cv::Vec3b(0, 0, 0);
    is_gray &= color[0] == color[1] && color[1] == color[2];
    has_other_black |= is_black && !is_background;
    has_colored_background |= !is_black && is_background;
  }
  return !is_gray && !(has_other_black && has_colored_background);
}

}  // namespace

cv::Size image_size(const fs::path& path) { return image_size(path, read_file(path)); }

cv::Size image_size(const fs::path& name, const std::string& bytes) {
  if (const auto size = read_stated_size(name, bytes)) return *size;
  throw InputError(name, "cannot be decoded as an image", "supported formats are PNG and JPEG");
}

cv::Mat3b decode_image(const fs::path& name, const std::string& bytes, cv::Size size) {
  return decode(name, bytes, size, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
}

cv::Mat decode_unchanged(const fs::path& name, const std::string& bytes, cv::Size size) {
  return decode(name, bytes, size, cv::IMREAD_UNCHANGED);
}

cv::Mat3b read_image(const fs::path& path, cv::Size size) { return decode_image(path, read_file(path), size); }

cv::Mat read_unchanged(const fs::path& path, cv::Size size) {
  if (is_numpy(path)) return read_numpy(path, size);
  const std::string bytes = read_file(path);
  return read_stated_size(path, bytes) == size ? decode(path, bytes, cv::IMREAD_UNCHANGED) : cv::Mat();
}

cv::Mat1b to_mask(const cv::Mat& picture) {
  cv::Mat1b mask(picture.size(), uchar{0});
  bool colored = false;
  for (int channel = 0; channel < std::min(picture.channels(), 3); ++channel) {
    mask |= is_not_zero(picture, channel);
    colored |= varies(picture, channel);
  }
  return picture.channels() < 4 || colored || !varies(picture, 3) ? mask : is_not_zero(picture, 3);
}

cv::Mat read_indices(const fs::path& path, cv::Size size) {
  if (is_numpy(path)) return read_numpy(path, size);
  const std::string bytes = read_file(path);
  if (const auto indices = decode_indices(path, bytes, size)) return *indices;
  return decode(path, bytes, size, cv::IMREAD_UNCHANGED);
}

cv::Mat1b read_mask(const fs::path& path, cv::Size size) {
  if (is_numpy(path)) return to_mask(read_numpy(path, size));
  const std::string bytes = read_file(path);
  const cv::Mat picture = decode(path, bytes, size, cv::IMREAD_UNCHANGED);
  if (picture.type() != CV_8UC3) return to_mask(picture);
  const std::optional<cv::Mat> indices = decode_indices(path, bytes, size);
  return indices && are_indices_of_objects(picture, *indices) ? to_mask(*indices) : to_mask(picture);
}

}  // namespace dvi::media
