#include "dvi/media/png_encode.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <vector>

#include <libdeflate.h>

#include "dvi/media/deflate.h"

namespace dvi::media {
namespace {

constexpr std::uint8_t kGray = 0, kRgb = 2, kRgba = 6;

enum Filter : std::uint8_t { none = 0, sub = 1, up = 2, paeth = 4 };

void append_number(std::string& out, std::uint32_t value) {
  for (const int shift : {24, 16, 8, 0}) out.push_back(static_cast<char>(value >> shift));
}

void append_chunk(std::string& out, const std::string& type, const std::string& content) {
  append_number(out, static_cast<std::uint32_t>(content.size()));
  const std::size_t begin = out.size();
  out += type;
  out += content;
  append_number(out, libdeflate_crc32(0, out.data() + begin, out.size() - begin));
}

/// Converts a row to the order of the file: RGB, the high byte first.
void to_file_order(const cv::Mat& image, int y, std::uint8_t* row) {
  const std::size_t count = static_cast<std::size_t>(image.cols) * static_cast<std::size_t>(image.channels());
  const std::uint8_t* in = image.ptr(y);
  if (image.type() == CV_8UC1) std::copy_n(in, count, row);
  if (image.type() == CV_8UC3)
    for (std::size_t i = 0; i < count; i += 3) row[i] = in[i + 2], row[i + 1] = in[i + 1], row[i + 2] = in[i];
  if (image.type() == CV_8UC4)
    for (std::size_t i = 0; i < count; i += 4)
      row[i] = in[i + 2], row[i + 1] = in[i + 1], row[i + 2] = in[i], row[i + 3] = in[i + 3];
  if (image.depth() == CV_16U) {
    const auto* wide = image.ptr<std::uint16_t>(y);
    for (std::size_t i = 0; i < count; ++i)
      row[2 * i] = static_cast<std::uint8_t>(wide[i] >> 8), row[2 * i + 1] = static_cast<std::uint8_t>(wide[i]);
  }
}

/// Returns the value of left, above and corner that is nearest to left + above - corner (the Paeth predictor). The types are
/// narrow for vectorization.
inline std::uint8_t predict(std::uint8_t left, std::uint8_t above, std::uint8_t corner) {
  const std::int16_t dl = static_cast<std::int16_t>(above - corner), da = static_cast<std::int16_t>(left - corner);
  const std::int16_t dc = static_cast<std::int16_t>(dl + da);
  const auto size = [](std::int16_t value) { return static_cast<std::int16_t>(value < 0 ? -value : value); };
  const std::int16_t to_left = size(dl), to_above = size(da), to_corner = size(dc);
  const std::uint8_t other = to_above <= to_corner ? above : corner;
  return to_left <= to_above && to_left <= to_corner ? left : other;
}

/// A row of an image and the one above it, each preceded by a pixel of zeros. Sizes are in bytes.
struct PixelRow {
  const std::uint8_t *row, *above;
  int pixel, size;
};

/// Filters a row. Returns the sum of the residuals' magnitudes, which approximates the compressed size.
int filter_row(Filter filter, const PixelRow& unfiltered, std::uint8_t* __restrict out) {
  const auto [row, above, pixel, size] = unfiltered;
  const std::uint8_t *left = row - pixel, *corner = above - pixel;
  if (filter == none) std::copy_n(row, size, out);
  if (filter == sub)
    for (int i = 0; i < size; ++i) out[i] = static_cast<std::uint8_t>(row[i] - left[i]);
  if (filter == up)
    for (int i = 0; i < size; ++i) out[i] = static_cast<std::uint8_t>(row[i] - above[i]);
  if (filter == paeth)
    for (int i = 0; i < size; ++i) out[i] = static_cast<std::uint8_t>(row[i] - predict(left[i], above[i], corner[i]));
  int cost = 0;
  for (int i = 0; i < size; ++i) {
    const std::uint8_t minus = static_cast<std::uint8_t>(-out[i]), m = out[i] < minus ? out[i] : minus;
    cost += m;
  }
  return cost;
}

/// Filters the rows; each row follows the number of its filter.
std::vector<std::uint8_t> filter_rows(const cv::Mat& image) {
  const int pixel = static_cast<int>(image.elemSize()), size = image.cols * pixel;
  const auto stride = static_cast<std::size_t>(size) + 1;
  std::vector<std::uint8_t> out(stride * static_cast<std::size_t>(image.rows));
  const std::vector<std::uint8_t> zeros(static_cast<std::size_t>(pixel + size));
  std::vector<std::uint8_t> row = zeros, above = zeros, attempt(static_cast<std::size_t>(size));
  bool empty_above = true;
  for (int y = 0; y < image.rows; ++y) {
    std::uint8_t* to = out.data() + static_cast<std::size_t>(y) * stride;
    to_file_order(image, y, row.data() + pixel);
    const bool empty = std::memcmp(row.data(), zeros.data(), row.size()) == 0;
    if (!empty || !empty_above) {
      const PixelRow unfiltered{row.data() + pixel, above.data() + pixel, pixel, size};
      int least = filter_row(none, unfiltered, to + 1);
      for (const Filter filter : {sub, up, paeth}) {
        const int cost = filter_row(filter, unfiltered, attempt.data());
        if (cost >= least) continue;
        least = cost;
        to[0] = filter;
        std::copy(attempt.begin(), attempt.end(), to + 1);
      }
    }
    std::swap(row, above);
    empty_above = empty;
  }
  return out;
}

}  // namespace

std::string encode_png(const cv::Mat& image) {
  const int type = image.type();
  if (type != CV_8UC1 && type != CV_8UC3 && type != CV_8UC4 && type != CV_16UC1 && type != CV_16UC3)
    throw std::logic_error("PNG does not support this type of image");
  const std::uint8_t colors = image.channels() == 1 ? kGray : image.channels() == 3 ? kRgb : kRgba;
  std::string header;
  append_number(header, static_cast<std::uint32_t>(image.cols));
  append_number(header, static_cast<std::uint32_t>(image.rows));
  for (const std::uint8_t field :
       {static_cast<std::uint8_t>(8 * image.elemSize1()), colors, std::uint8_t{0}, std::uint8_t{0}, std::uint8_t{0}})
    header.push_back(static_cast<char>(field));
  std::string out = "\x89PNG\r\n\x1A\n";
  append_chunk(out, "IHDR", header);
  append_chunk(out, "IDAT", compress_zlib(filter_rows(image)));
  append_chunk(out, "IEND", {});
  return out;
}

}  // namespace dvi::media
