#include "dvi/media/image_edit.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/core/error.h"
#include "dvi/media/image_file.h"
#include "dvi/media/png_encode.h"

namespace dvi::media {
namespace {

constexpr std::size_t kPngMagicBytes = 8, kPngHeaderEnd = 33;  // the end of the chunk IHDR

[[noreturn]] void refuse(const fs::path& name, const std::string& what) {
  throw InputError(name, fmt::format("{}, which cannot be written back", what),
                   "export the frames in another format, such as video, colmap, or mcap");
}

std::uint32_t read_big_endian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (const char byte : bytes) value = value << 8 | static_cast<unsigned char>(byte);
  return value;
}

// A part of a file: a chunk of a PNG or a segment of a JPEG.
struct FilePart {
  std::string type;
  std::string_view bytes;  // with its head
};

std::vector<FilePart> split_png(std::string_view file) {
  constexpr std::size_t kFrameBytes = 12;  // length, type, and checksum
  std::vector<FilePart> parts;
  for (std::size_t at = kPngMagicBytes; at + kFrameBytes <= file.size();) {
    const std::size_t size = std::min<std::size_t>(kFrameBytes + read_big_endian(file.substr(at, 4)), file.size() - at);
    parts.push_back({std::string(file.substr(at + 4, 4)), file.substr(at, size)});
    at += size;
  }
  return parts;
}

// Lists the segments before the image data.
std::vector<FilePart> split_jpeg(std::string_view file) {
  constexpr char kFill = '\xFF', kScan = '\xDA';
  std::vector<FilePart> parts;
  for (std::size_t at = 2; at + 4 <= file.size() && file[at] == kFill && file[at + 1] != kScan;) {
    if (file[at + 1] == kFill) {
      ++at;
      continue;
    }
    const std::size_t size = std::min<std::size_t>(2 + read_big_endian(file.substr(at + 2, 2)), file.size() - at);
    parts.push_back({std::string(1, file[at + 1]), file.substr(at, size)});
    at += size;
  }
  return parts;
}

bool has_png_header(const std::string& file) { return file.starts_with("\x89PNG") && file.size() >= kPngHeaderEnd; }

void require_writable_png(const fs::path& name, const std::string& file) {
  constexpr std::size_t kBitDepthByte = 24, kColorTypeByte = 25;
  constexpr char kPalette = 3, kGrayWithAlpha = 4;
  const int bits = file[kBitDepthByte];
  if (bits != 8) refuse(name, fmt::format("it is a PNG of {} bits per color", bits));
  if (file[kColorTypeByte] == kPalette) refuse(name, "it is a PNG with a palette");
  if (file[kColorTypeByte] == kGrayWithAlpha) refuse(name, "it is a PNG of gray with transparency");
  for (const FilePart& part : split_png(file))
    if (part.type == "tRNS") refuse(name, "it is a PNG with a transparent color");
}

void require_writable_jpeg(const fs::path& name, const std::string& file) {
  for (const FilePart& part : split_jpeg(file)) {
    constexpr std::size_t kComponentsByte = 9;
    const auto marker = static_cast<unsigned char>(part.type[0]);
    const bool is_frame = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (!is_frame || part.bytes.size() <= kComponentsByte) continue;
    const int components = part.bytes[kComponentsByte];
    if (components != 1 && components != 3) refuse(name, fmt::format("it is a JPEG of {} color components", components));
  }
}

// Returns the metadata of a PNG: all chunks that describe neither the size nor the pixels.
std::string collect_png_metadata(const std::string& file) {
  constexpr std::array kPixelChunks = {"IHDR", "PLTE", "IDAT", "IEND", "bKGD", "hIST"};
  std::string out;
  for (const FilePart& part : split_png(file))
    if (std::find(kPixelChunks.begin(), kPixelChunks.end(), part.type) == kPixelChunks.end()) out += part.bytes;
  return out;
}

// Returns the metadata of a JPEG: EXIF, color profiles, comments and others, without those by which pixels are decoded.
std::string collect_jpeg_metadata(const std::string& file) {
  std::string out;
  for (const FilePart& part : split_jpeg(file)) {
    const auto marker = static_cast<unsigned char>(part.type[0]);
    constexpr unsigned char kJfif = 0xE0, kLastApplication = 0xEF, kAdobe = 0xEE, kComment = 0xFE;
    if ((marker > kJfif && marker <= kLastApplication && marker != kAdobe) || marker == kComment) out += part.bytes;
  }
  return out;
}

std::string encode_jpeg(const cv::Mat& image, int quality) {
  std::vector<uchar> bytes;
  cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  return {bytes.begin(), bytes.end()};
}

std::string encode_like(const std::string& file, const cv::Mat& image, int jpeg_quality) {
  if (has_png_header(file)) {
    std::string out = encode_png(image);
    return out.insert(kPngHeaderEnd, collect_png_metadata(file));
  }
  std::string out = encode_jpeg(image, jpeg_quality);
  constexpr std::size_t kJfifEnd = 20;  // the encoder begins with a JFIF segment of 18 bytes
  return out.insert(kJfifEnd, collect_jpeg_metadata(file));
}

}  // namespace

bool ImageEdit::is_empty() const { return cv::countNonZero(is_changed) == 0; }

bool ImageEdit::matches(const cv::Mat3b& recorded) const {
  if (recorded.size() != colors.size()) return false;
  for (int y = 0; y < colors.rows; ++y)
    for (int x = 0; x < colors.cols; ++x)
      if (is_changed(y, x) == 0 && recorded(y, x) != colors(y, x)) return false;
  return true;
}

void ImageEdit::apply_to(cv::Mat& image, bool is_rgb) const {
  cv::Mat1b gray;
  if (image.channels() == 1) cv::cvtColor(colors, gray, cv::COLOR_BGR2GRAY);
  for (int y = 0; y < image.rows; ++y) {
    uchar* pixel = image.ptr(y);
    for (int x = 0; x < image.cols; ++x, pixel += image.channels()) {
      if (is_changed(y, x) == 0) continue;
      if (!gray.empty()) {
        pixel[0] = gray(y, x);
        continue;
      }
      for (int c = 0; c < 3; ++c) pixel[is_rgb ? 2 - c : c] = colors(y, x)[c];
    }
  }
}

std::optional<std::string> edit_image_file(const fs::path& name, const std::string& file, const ImageEdit& edit,
                                           int jpeg_quality) {
  if (has_png_header(file))
    require_writable_png(name, file);
  else
    require_writable_jpeg(name, file);
  if (image_size(name, file) != edit.colors.size() || !edit.matches(decode_image(name, file, edit.colors.size())))
    return std::nullopt;
  if (edit.is_empty()) return file;
  cv::Mat image = decode_unchanged(name, file, edit.colors.size());
  edit.apply_to(image);
  return encode_like(file, image, jpeg_quality);
}

}  // namespace dvi::media
