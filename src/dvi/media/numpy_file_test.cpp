#include "dvi/media/numpy_file.h"

#include <opencv2/core.hpp>

#include "dvi/testing/image_folder.h"

namespace dvi::media {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// The format is that of numpy/lib/format.py: magic, version, length of the header, header, numbers.
struct NumpyHeader {
  int version = 1;
  std::string fortran_order = "False";
};

std::string array(const std::string& type, const std::string& shape, const std::string& numbers,
                  const NumpyHeader& format = {}) {
  std::string header = "{'descr': '" + type + "', 'fortran_order': " + format.fortran_order + ", 'shape': " + shape + ", }";
  header.resize(117, ' ');
  header += '\n';
  std::string out =
      std::string("\x93NUMPY") + static_cast<char>(format.version) + '\0' + static_cast<char>(header.size()) + '\0';
  if (format.version > 1) out += std::string(2, '\0');
  return out + header + numbers;
}

template <class T>
std::string bytes(const std::vector<T>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(T)};
}

std::vector<int> parse(const std::string& text, int type = CV_8UC1) {
  const cv::Mat parsed = parse_numpy("a.npy", text, {3, 2});
  EXPECT_EQ(parsed.type(), type);
  cv::Mat1i out;
  parsed.convertTo(out, CV_32S);
  return {out.begin(), out.end()};
}

TEST(NumpyFile, ReadsAllTypesOfNumbers) {
  const std::vector<int> expected = {0, 1, 2, 3, 4, 5};
  EXPECT_EQ(parse(array("|u1", "(2, 3)", bytes<std::uint8_t>({0, 1, 2, 3, 4, 5}))), expected);
  EXPECT_EQ(parse(array("|i1", "(2, 3)", bytes<std::int8_t>({-1, 1, 2, 3, 4, 5}))), expected) << "negative numbers become 0";
  EXPECT_EQ(parse(array("<u2", "(2, 3)", bytes<std::uint16_t>({0, 1, 2, 3, 4, 5}))), expected);
  EXPECT_EQ(parse(array("<i2", "(2, 3)", bytes<std::int16_t>({-7, 1, 2, 3, 4, 5}))), expected);
  EXPECT_EQ(parse(array("<u4", "(2, 3)", bytes<std::uint32_t>({0, 1, 2, 3, 4, 5}))), expected);
  EXPECT_EQ(parse(array("<i4", "(2, 3)", bytes<std::int32_t>({-1, 1, 2, 3, 4, 5}))), expected);
  EXPECT_EQ(parse(array("<i8", "(2, 3)", bytes<std::int64_t>({-1, 1, 2, 3, 4, 5}), {2})), expected);
  EXPECT_EQ(parse(array("<u8", "(2, 3)", bytes<std::uint64_t>({0, 1, 2, 3, 4, 5}), {3})), expected);
  EXPECT_EQ(parse(array("<f4", "(1, 2, 3)", bytes<float>({0, 1, 2, 3, 4, 5}))), expected);
  EXPECT_EQ(parse(array("<f8", "(2, 3, 1)", bytes<double>({-1, 1, 2, 3, 4, 5}))), expected);
  EXPECT_EQ(parse(array("|b1", "(2, 3)", bytes<std::uint8_t>({0, 1, 0, 0, 1, 1}))), (std::vector<int>{0, 255, 0, 0, 255, 255}));
  EXPECT_EQ(parse(array("<u2", "(2, 3)", bytes<std::uint16_t>({0, 1, 300, 3, 4, 65535})), CV_16UC1),
            (std::vector<int>{0, 1, 300, 3, 4, 65535}));
}

TEST(NumpyFile, RefusesOtherArrays) {
  const auto error = [](const std::string& text) { return input_error([&] { parse_numpy("a.npy", text, {3, 2}); }); };
  const std::string six(6, '\1');
  EXPECT_THAT(error(array("|u1", "(2, 3)", six, {1, "True"})),
              AllOf(HasSubstr("Fortran order"), HasSubstr("ascontiguousarray")));
  EXPECT_THAT(error(array("|O", "(2, 3)", six)), AllOf(HasSubstr("type '|O'"), HasSubstr("np.save")));
  EXPECT_THAT(error(array(">u2", "(2, 3)", six + six)), HasSubstr("type '>u2'"));
  EXPECT_THAT(error(array("|u1", "(3, 2)", six)), HasSubstr("is 2x3 pixels instead of 3x2"));
  EXPECT_THAT(error(array("|u1", "(4, 2, 3)", six)), AllOf(HasSubstr("shape (4, 2, 3)"), HasSubstr("one array per image")));
  EXPECT_THAT(error(array("|u1", "(6,)", six)), HasSubstr("shape (6)"));
  EXPECT_THAT(error(array("|u1", "()", six)), HasSubstr("shape ()"));
  EXPECT_THAT(error(array("<u2", "(2, 3)", six)), HasSubstr("truncated: it has 6 of 12 bytes"));
  EXPECT_THAT(error(array("<f4", "(2, 3)", bytes<float>({0, 0.5, 0, 0, 0, 0}))),
              AllOf(HasSubstr("0.5"), HasSubstr("mask > 0.5")));
  EXPECT_THAT(error(array("<f4", "(2, 3)", bytes<float>({0, NAN, 0, 0, 0, 0}))), HasSubstr("not whole"));
  EXPECT_THAT(error(array("<u4", "(2, 3)", bytes<std::uint32_t>({0, 70000, 0, 0, 0, 0}))), HasSubstr("at most 65535"));
  for (const char* text : {"", "\x93NUMPY", "\x93NUMPY\1", "PNG", "\x93NUMPY\1\1\xFF\xFF{'descr"})
    EXPECT_THAT(error(text), HasSubstr("is not an array of NumPy"));
  EXPECT_THAT(error(array("|u1", "(2, 3)", six, {9})), HasSubstr("is not an array of NumPy"));
}

}  // namespace
}  // namespace dvi::media
