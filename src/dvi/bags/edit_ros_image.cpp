#include <algorithm>
#include <array>
#include <stdexcept>

#include <fmt/format.h>

#include "dvi/bags/ros_image.h"
#include "dvi/core/error.h"

namespace dvi::bags {
namespace {

struct WritableEncoding {
  const char* name;
  int channels;
  bool is_rgb = false;
};

constexpr std::array kWritableEncodings{WritableEncoding{"bgr8", 3},         WritableEncoding{"8UC3", 3},
                                        WritableEncoding{"rgb8", 3, true},   WritableEncoding{"bgra8", 4},
                                        WritableEncoding{"8UC4", 4},         WritableEncoding{"rgba8", 4, true},
                                        WritableEncoding{"mono8", 1, false}, WritableEncoding{"8UC1", 1, false}};

const WritableEncoding& find_writable(const std::string& encoding) {
  const auto* const found = std::find_if(kWritableEncodings.begin(), kWritableEncodings.end(),
                                         [&](const WritableEncoding& known) { return encoding == known.name; });
  if (found == kWritableEncodings.end())
    throw std::invalid_argument(fmt::format(
        "clean pixels cannot be written back in its encoding '{}'; they can in bgr8, rgb8, bgra8, rgba8, and mono8", encoding));
  return *found;
}

}  // namespace

std::optional<std::string> edit_image(std::string message, BagEncoding encoding, const media::ImageEdit& edit) {
  const RosImage image = parse_image(message, encoding);
  const WritableEncoding& writable = find_writable(image.encoding);
  if (!edit.matches(to_bgr(image))) return std::nullopt;
  cv::Mat pixels(edit.colors.rows, edit.colors.cols, CV_8UC(writable.channels),
                 message.data() + (image.data.data() - message.data()), image.step);
  edit.apply_to(pixels, writable.is_rgb);
  return message;
}

std::optional<std::string> edit_compressed_image(std::string_view message, BagEncoding encoding, const media::ImageEdit& edit,
                                                 int jpeg_quality) {
  const RosCompressedImage image = parse_image_file(message, encoding);
  if (image.format.starts_with("bayer_"))
    throw std::invalid_argument(
        fmt::format("clean pixels cannot be written back in its format '{}', a Bayer pattern", image.format));
  std::optional<std::string> file;
  try {
    file = media::edit_image_file(fmt::format("a file of the format '{}'", image.format), image.file, edit, jpeg_quality);
  } catch (const InputError& e) {
    throw std::invalid_argument(e.what());
  }
  if (!file) return std::nullopt;
  RosFields fields(message, encoding);
  take_header(fields);
  fields.text();
  const std::string_view data = fields.bytes();
  const auto begin = static_cast<std::size_t>(data.data() - message.data()), end = begin + data.size();
  return std::string(message.substr(0, begin - sizeof(std::uint32_t))) +
         to_field(static_cast<std::uint32_t>(file->size()), fields.is_big_endian()) + *file + std::string(message.substr(end));
}

}  // namespace dvi::bags
