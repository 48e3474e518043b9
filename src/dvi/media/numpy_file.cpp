#include "dvi/media/numpy_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/core/error.h"
#include "dvi/core/text.h"

namespace dvi::media {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr const char* kArrayRemedy = "write it by np.save(FILE, mask.astype('uint16')), with an array of height x width";

/// The header of an array: {'descr': '<u2', 'fortran_order': False, 'shape': (375, 1242), }.
struct ArrayHeader {
  std::string type;
  bool is_fortran_order = false;
  std::vector<std::int64_t> shape;
  std::size_t begin = 0;  ///< the first byte of the numbers
};

// Returns the text after "'KEY':" without leading blanks.
std::optional<std::string_view> find_value(std::string_view header, std::string_view key) {
  const std::size_t at = header.find(fmt::format("'{}':", key));
  if (at == std::string_view::npos) return std::nullopt;
  std::string_view value = header.substr(at + key.size() + 3);
  value.remove_prefix(std::min(value.find_first_not_of(' '), value.size()));
  return value;
}

std::optional<std::vector<std::int64_t>> parse_shape(std::string_view text) {
  const std::size_t end = text.find(')');
  if (!text.starts_with('(') || end == std::string_view::npos) return std::nullopt;
  std::string numbers(text.substr(1, end - 1));
  std::replace(numbers.begin(), numbers.end(), ',', ' ');
  std::vector<std::int64_t> shape;
  for (const std::string& word : split_words(numbers)) {
    const auto number = to_integer(word);
    if (!number || *number < 0) return std::nullopt;
    shape.push_back(*number);
  }
  return shape;
}

std::optional<ArrayHeader> parse_array_header(std::string_view bytes) {
  constexpr std::size_t kVersionByte = 6, kLengthByte = 8;
  if (!bytes.starts_with(kMagic) || bytes.size() < kLengthByte + 4) return std::nullopt;
  const int version = bytes[kVersionByte];
  if (version < 1 || version > 3) return std::nullopt;
  const std::size_t length_bytes = version == 1 ? 2 : 4;
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + kLengthByte, length_bytes);
  const std::size_t begin = kLengthByte + length_bytes;
  if (length > bytes.size() - begin) return std::nullopt;
  const std::string_view text = bytes.substr(begin, length);
  const auto type = find_value(text, "descr"), order = find_value(text, "fortran_order"), shape = find_value(text, "shape");
  if (!type || !order || !shape) return std::nullopt;
  const auto sizes = parse_shape(*shape);
  const std::size_t quote = type->find('\'', 1);
  if (!sizes || !(order->starts_with("True") || order->starts_with("False"))) return std::nullopt;
  // The type of a record is a list.
  const std::string name(type->starts_with('\'') && quote != std::string_view::npos ? type->substr(1, quote - 1) : "record");
  return ArrayHeader{name, order->starts_with("True"), *sizes, begin + length};
}

std::string describe_shape(const std::vector<std::int64_t>& shape) { return fmt::format("({})", fmt::join(shape, ", ")); }

class Numbers {
 public:
  Numbers(const fs::path& name, std::string_view bytes) : name_(name), bytes_(bytes) {}

  template <class T>
  std::vector<int> read(std::size_t count) const {
    if (bytes_.size() < count * sizeof(T))
      throw InputError(name_, fmt::format("is truncated: it has {} of {} bytes of numbers", bytes_.size(), count * sizeof(T)),
                       "write it again");
    std::vector<int> out(count);
    for (std::size_t i = 0; i < count; ++i) {
      T value;
      std::memcpy(&value, bytes_.data() + i * sizeof(T), sizeof(T));
      out[i] = to_id(value);
    }
    return out;
  }

 private:
  template <class T>
  int to_id(T value) const {
    if constexpr (std::is_floating_point_v<T>)
      if (!(value == std::floor(value)))
        throw InputError(name_, fmt::format("holds the number {}, which is not whole", value),
                         "masks of probabilities or logits need a threshold: np.save(FILE, mask > 0.5)");
    if (value < T{0}) return 0;
    if (sizeof(T) > 2 && value > static_cast<T>(kMaxId))
      throw InputError(name_, fmt::format("holds the number {}", value),
                       fmt::format("numbers of objects are at most {}", kMaxId));
    return static_cast<int>(value);
  }

  static constexpr int kMaxId = 65535;
  const fs::path& name_;
  std::string_view bytes_;
};

std::vector<int> read_numbers(const fs::path& name, const ArrayHeader& header, std::string_view bytes, std::size_t count) {
  const Numbers numbers(name, bytes);
  const std::string& type = header.type;
  if (type == "|u1") return numbers.read<std::uint8_t>(count);
  if (type == "|i1") return numbers.read<std::int8_t>(count);
  if (type == "<u2") return numbers.read<std::uint16_t>(count);
  if (type == "<i2") return numbers.read<std::int16_t>(count);
  if (type == "<u4") return numbers.read<std::uint32_t>(count);
  if (type == "<i4") return numbers.read<std::int32_t>(count);
  if (type == "<u8") return numbers.read<std::uint64_t>(count);
  if (type == "<i8") return numbers.read<std::int64_t>(count);
  if (type == "<f4") return numbers.read<float>(count);
  if (type == "<f8") return numbers.read<double>(count);
  if (type == "|b1") {
    std::vector<int> out = numbers.read<std::uint8_t>(count);
    for (int& value : out) value = value != 0 ? 255 : 0;
    return out;
  }
  throw InputError(name, fmt::format("is an array of type '{}', which is not supported", type), kArrayRemedy);
}

}  // namespace

bool is_numpy(const fs::path& file) { return to_lower_case(file.extension().string()) == ".npy"; }

cv::Mat parse_numpy(const fs::path& name, std::string_view bytes, cv::Size size) {
  const auto header = parse_array_header(bytes);
  if (!header) throw InputError(name, "is not an array of NumPy, or its header is damaged", kArrayRemedy);
  if (header->is_fortran_order)
    throw InputError(name, "has its numbers in Fortran order", "write it by np.save(FILE, np.ascontiguousarray(mask))");
  std::vector<std::int64_t> shape = header->shape;
  if (shape.size() == 3 && shape.front() == 1) shape.erase(shape.begin());
  if (shape.size() == 3 && shape.back() == 1) shape.pop_back();
  if (shape.size() != 2)
    throw InputError(name, fmt::format("is an array of shape {}, not a mask of height x width", describe_shape(header->shape)),
                     "write one array per image");
  if (shape[0] != size.height || shape[1] != size.width)
    throw InputError(name, fmt::format("is {}x{} pixels instead of {}x{}", shape[1], shape[0], size.width, size.height),
                     "images, masks and calibration must have the same size");
  const std::size_t count = static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
  const std::vector<int> numbers = read_numbers(name, *header, bytes.substr(header->begin), count);
  const bool is_wide = std::any_of(numbers.begin(), numbers.end(), [](int value) { return value > 255; });
  cv::Mat out;
  cv::Mat(size, CV_32S, const_cast<int*>(numbers.data())).convertTo(out, is_wide ? CV_16U : CV_8U);
  return out;
}

cv::Mat read_numpy(const fs::path& file, cv::Size size) { return parse_numpy(file, read_file(file), size); }

}  // namespace dvi::media
