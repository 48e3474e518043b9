#include "dvi/media/image_storage.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/media/image_file.h"

namespace dvi::media {
namespace {

constexpr std::size_t kMaxSampleFiles = 25;
constexpr int kFullBits = 16;

// Selects evenly spaced files, without empty paths.
std::vector<fs::path> sample_files(std::vector<fs::path> files) {
  std::erase_if(files, [](const fs::path& file) { return file.empty(); });
  std::vector<fs::path> sample;
  const std::size_t count = std::min(files.size(), kMaxSampleFiles);
  for (std::size_t i = 0; i < count; ++i) sample.push_back(files[i * files.size() / count]);
  return sample;
}

std::vector<fs::path> sample_images(const Drive& drive) {
  std::vector<fs::path> files;
  for (const Frame& frame : drive.frames) files.push_back(frame.file);
  return sample_files(std::move(files));
}

// Joins up to four bytes to a number, in either byte order.
std::uint32_t join_bytes(std::string_view bytes, bool big_endian) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i])) << 8 * (big_endian ? bytes.size() - 1 - i : i);
  return value;
}

std::string take_bytes(std::istream& in, std::size_t count) {
  std::string bytes(count, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(count));
  return in ? bytes : std::string();
}

// Finds the value of tag 0x0112 in the first directory of a TIFF structure, which is the format of EXIF data.
std::optional<int> find_orientation(std::string_view tiff) {
  if (tiff.size() < 8 || (!tiff.starts_with("II") && !tiff.starts_with("MM"))) return std::nullopt;
  const bool big_endian = tiff.starts_with("MM");
  const auto number = [&](std::size_t at, std::size_t bytes) { return join_bytes(tiff.substr(at, bytes), big_endian); };
  constexpr std::size_t kEntryBytes = 12;
  constexpr std::uint32_t kOrientationTag = 0x0112;
  const std::size_t directory = number(4, 4);
  if (directory + 2 > tiff.size()) return std::nullopt;
  const std::size_t entries = number(directory, 2);
  for (std::size_t i = 0; i < entries; ++i) {
    const std::size_t at = directory + 2 + i * kEntryBytes;
    if (at + kEntryBytes > tiff.size()) return std::nullopt;
    if (number(at, 2) == kOrientationTag) return static_cast<int>(number(at + 8, 2));
  }
  return std::nullopt;
}

// Reads the EXIF data from the segments before the image data.
std::string read_jpeg_exif(std::istream& in) {
  constexpr std::string_view kExif("Exif\0\0", 6);
  in.seekg(2);
  while (in) {
    const std::string head = take_bytes(in, 4);
    if (head.empty() || head[0] != '\xFF') return {};
    const auto marker = static_cast<unsigned char>(head[1]);
    constexpr unsigned char kFill = 0xFF, kScan = 0xDA, kApp1 = 0xE1;
    if (marker == kFill) {
      in.seekg(-3, std::ios::cur);
      continue;
    }
    const std::uint32_t length = join_bytes(std::string_view(head).substr(2), true);
    if (marker == kScan || length < 2) return {};
    if (marker != kApp1) {
      in.seekg(length - 2, std::ios::cur);
      continue;
    }
    const std::string segment = take_bytes(in, length - 2);
    if (segment.starts_with(kExif)) return segment.substr(kExif.size());
  }
  return {};
}

std::string read_png_exif(std::istream& in) {
  constexpr std::uint32_t kMaxExifBytes = 1 << 20;
  in.seekg(8);
  while (in) {
    const std::string head = take_bytes(in, 8);
    if (head.empty() || head.ends_with("IEND")) return {};
    const std::uint32_t length = join_bytes(std::string_view(head).substr(0, 4), true);
    if (head.ends_with("eXIf") && length <= kMaxExifBytes) return take_bytes(in, length);
    in.seekg(std::int64_t{length} + 4, std::ios::cur);
  }
  return {};
}

bool is_16_bit_png(const fs::path& file) {
  require_regular_file(file);
  std::ifstream in(file, std::ios::binary);
  const std::string head = take_bytes(in, 25);
  return head.starts_with("\x89PNG") && head[24] == 16;
}

// The first file of a sample with an orientation other than 1.
struct RotatedFile {
  fs::path first;
  int orientation = 1;
};

std::optional<RotatedFile> find_rotated_file(const std::vector<fs::path>& sample) {
  for (const fs::path& file : sample)
    if (const int orientation = read_exif_orientation(file); orientation != 1) return RotatedFile{file, orientation};
  return std::nullopt;
}

}  // namespace

int estimate_value_bits(int largest) {
  int bits = 8;
  while (bits < 16 && largest >= 1 << bits) bits += 2;
  return bits;
}

int read_exif_orientation(const fs::path& file) {
  require_regular_file(file);
  std::ifstream in(file, std::ios::binary);
  const std::string magic = take_bytes(in, 4);
  const std::string exif = magic.starts_with("\xFF\xD8") ? read_jpeg_exif(in) : magic == "\x89PNG" ? read_png_exif(in) : "";
  const int orientation = find_orientation(exif).value_or(1);
  return orientation >= 1 && orientation <= 8 ? orientation : 1;
}

std::string describe_orientation(int exif_orientation) {
  constexpr std::array<const char*, 9> kEffects = {"",
                                                   "show the image as it is stored",
                                                   "mirror the image",
                                                   "rotate the image by 180 degrees",
                                                   "mirror and rotate the image by 180 degrees",
                                                   "mirror and rotate the image by 90 degrees",
                                                   "rotate the image by 90 degrees clockwise",
                                                   "mirror and rotate the image by 90 degrees",
                                                   "rotate the image by 90 degrees counterclockwise"};
  return kEffects.at(static_cast<std::size_t>(exif_orientation));
}

void warn_of_image_orientation(Drive& drive) {
  const auto image = find_rotated_file(sample_images(drive));
  if (!image) return;
  drive.warnings.push_back(fmt::format(
      "{} has EXIF orientation {}, by which viewers and labeling tools {}. dvi reads the pixels as they are stored, and so "
      "must "
      "calibration and masks be; if they refer to the upright image, rotate the images first (mogrify -auto-orient, or "
      "exiftran "
      "-ai without loss); otherwise remove the flag (exiftool -Orientation=)",
      image->first.string(), image->orientation, describe_orientation(image->orientation)));
}

void warn_of_mask_orientation(Drive& drive, const std::vector<fs::path>& sample) {
  const auto mask = find_rotated_file(sample);
  if (!mask) return;
  drive.warnings.push_back(
      fmt::format("the mask {} has EXIF orientation {}, by which viewers {}. dvi reads the pixels as they are stored; if that "
                  "is wrong, rotate "
                  "the masks first (mogrify -auto-orient); otherwise remove the flag (exiftool -Orientation=)",
                  mask->first.string(), mask->orientation, describe_orientation(mask->orientation)));
}

std::string describe_video_rotation(const fs::path& video, int rotation_deg) {
  return fmt::format(
      "{} has a rotation flag, by which players rotate it by {} degrees clockwise. dvi reads the frames as they are stored, "
      "and "
      "so must "
      "calibration and masks be; if they refer to the upright image, rotate the frames first (ffmpeg -i IN -qp 0 OUT); "
      "otherwise "
      "remove "
      "the flag (ffmpeg -i IN -c copy -metadata:s:v rotate=0 OUT)",
      video.string(), rotation_deg);
}

int find_value_bits(Drive& drive) {
  double largest = 0;
  fs::path brightest;
  for (const fs::path& file : sample_images(drive)) {
    if (!is_16_bit_png(file)) continue;
    double low = 0, high = 0;
    const cv::Mat picture = read_unchanged(file, image_size(file));
    if (picture.empty()) continue;                                                 // reading its frame reports the error
    for (int channel = 0; channel < std::min(picture.channels(), 3); ++channel) {  // without transparency
      cv::Mat values;
      cv::extractChannel(picture, values, channel);
      cv::minMaxLoc(values, &low, &high);
      if (high > largest) largest = high, brightest = file;
    }
  }
  const int bits = largest > 0 ? estimate_value_bits(static_cast<int>(largest)) : kFullBits;
  if (bits < kFullBits)
    drive.warnings.push_back(fmt::format(
        "the images have 16 bits, but no value above {:.0f} ({}); they are read as {}-bit images, all scaled by the same "
        "factor {}",
        largest, brightest.string(), bits, 1 << (kFullBits - bits)));
  return bits;
}

cv::Mat3b read_scaled_image(const fs::path& file, cv::Size size, int value_bits) {
  if (value_bits >= kFullBits || !is_16_bit_png(file)) return read_image(file, size);
  const cv::Mat picture = read_unchanged(file, size);
  if (picture.empty()) return read_image(file, size);  // reports the error
  cv::Mat3b out(size);
  for (int channel = 0; channel < 3; ++channel) {
    cv::Mat1w values;
    cv::extractChannel(picture, values, std::min(channel, picture.channels() - 1));
    double low = 0, high = 0;
    cv::minMaxLoc(values, &low, &high);
    if (high >= 1 << value_bits)
      throw InputError(file,
                       fmt::format("holds values up to {:.0f}, but other images were read as {}-bit images", high, value_bits),
                       "write all images with 8 bits per color and the same scale");
    cv::Mat1b scaled(size);
    std::transform(values.begin(), values.end(), scaled.begin(),
                   [shift = value_bits - 8](ushort value) { return static_cast<uchar>(value >> shift); });
    cv::insertChannel(scaled, out, channel);
  }
  return out;
}

}  // namespace dvi::media
