#include "dvi/media/image_file.h"

#include <libdeflate.h>

#include "dvi/media/deflate.h"
#include "dvi/testing/image_folder.h"

namespace dvi::media {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(ImageFile, ReadsTheSizeFromTheHeader) {
  const TestFolder folder;
  const cv::Mat3b image(37, 301, cv::Vec3b(10, 20, 30));
  EXPECT_EQ(image_size(folder.write_image("a.png", image)), cv::Size(301, 37));
  EXPECT_EQ(image_size(folder.write_image("a.jpg", image)), cv::Size(301, 37));
  EXPECT_THAT(input_error([&] { image_size(folder.write("b.png", "no image")); }), HasSubstr("b.png: cannot be decoded"));
}

TEST(ImageFile, DecodesToBgrAndMasksToTwoValues) {
  const TestFolder folder;
  const cv::Mat3b image(4, 6, cv::Vec3b(10, 20, 30));
  EXPECT_EQ(read_image(folder.write_image("a.png", image), image.size())(1, 1), cv::Vec3b(10, 20, 30));
  cv::Mat1b mask(4, 6, uchar{0});
  mask(2, 3) = 1, mask(0, 0) = 255;
  const cv::Mat1b read = read_mask(folder.write_image("m.png", mask), mask.size());
  EXPECT_EQ(read(2, 3), 255);
  EXPECT_EQ(cv::countNonZero(read), 2);
}

TEST(ImageFile, RefusesUnreadableFiles) {
  const TestFolder folder;
  cv::Mat3b image(200, 300);
  cv::randu(image, 0, 255);
  for (const char* name : {"a.png", "a.jpg"}) {
    const std::string bytes = read_file(folder.write_image(name, image));
    folder.write(name, bytes.substr(0, bytes.size() * 2 / 3));
    EXPECT_THAT(input_error([&] { read_image(folder.path / name, image.size()); }),
                AllOf(HasSubstr(name), HasSubstr("cannot be decoded")));
  }
  EXPECT_THAT(input_error([&] { read_image(folder.write("c.png", ""), {1, 1}); }), HasSubstr("cannot be decoded"));
  EXPECT_THAT(input_error([&] { read_image(folder.path / "d.png", {1, 1}); }), HasSubstr("d.png: cannot be read"));
}

TEST(ImageFile, ReportsBothSizes) {
  const TestFolder folder;
  const fs::path file = folder.write_image("a.png", cv::Mat3b(4, 6, cv::Vec3b()));
  EXPECT_THAT(input_error([&] { read_image(file, {6, 5}); }), HasSubstr("is 6x4 pixels instead of 6x5"));
  EXPECT_THAT(input_error([&] { read_mask(file, {7, 4}); }), HasSubstr("is 6x4 pixels instead of 7x4"));
}

TEST(ImageFile, ReadsAllChannelsOfAMask) {
  const TestFolder folder;
  const auto count = [&](const cv::Mat& image) {
    return cv::countNonZero(read_mask(folder.write_image("m.png", image), image.size()));
  };
  cv::Mat1w deep(4, 6, ushort{0});
  deep(1, 1) = 1, deep(2, 2) = 255, deep(3, 3) = 65535;
  EXPECT_EQ(count(deep), 3);
  cv::Mat3b color(4, 6, cv::Vec3b());
  color(1, 1) = {1, 0, 0}, color(2, 2) = {0, 1, 0}, color(3, 3) = {0, 0, 1};
  EXPECT_EQ(count(color), 3);
}

TEST(ImageFile, UsesTransparencyOnlyIfColorsAreEqual) {
  const TestFolder folder;
  const auto count = [&](const cv::Mat4b& image) {
    return cv::countNonZero(read_mask(folder.write_image("m.png", image), image.size()));
  };
  cv::Mat4b image(4, 6, cv::Vec4b(0, 0, 0, 255));
  EXPECT_EQ(count(image), 0);
  image(2, 3) = {0, 0, 9, 255};
  EXPECT_EQ(count(image), 1);
  cv::Mat4b drawn(4, 6, cv::Vec4b(0, 0, 0, 0));
  EXPECT_EQ(count(drawn), 0);
  drawn(1, 1) = drawn(1, 2) = {0, 0, 0, 128};
  EXPECT_EQ(count(drawn), 2);
  cv::Mat4b white(4, 6, cv::Vec4b(255, 255, 255, 0));
  white(1, 1) = {255, 255, 255, 255};
  EXPECT_EQ(count(white), 1) << "painted in one color on a transparent background";
  EXPECT_EQ(count(cv::Mat4b(4, 6, cv::Vec4b(255, 255, 255, 255))), 24);
}

std::string make_chunk(const std::string& body) {  // the body begins with the chunk's name
  const auto number = [](std::uint32_t value) {
    std::string out;
    for (const int shift : {24, 16, 8, 0}) out += static_cast<char>(value >> shift);
    return out;
  };
  return number(static_cast<std::uint32_t>(body.size() - 4)) + body + number(libdeflate_crc32(0, body.data(), body.size()));
}

// Makes a PNG of 3x2 pixels with a palette of RGB colors; `indices` are the pixels.
std::string make_palette_png(const std::string& colors, const std::string& indices) {
  using namespace std::string_literals;
  std::string rows;
  for (std::size_t row = 0; row < 2; ++row) rows += '\0' + indices.substr(3 * row, 3);
  return "\x89PNG\r\n\x1A\n" + make_chunk("IHDR\0\0\0\3\0\0\0\2\x08\3\0\0\0"s) + make_chunk("PLTE" + colors) +
         make_chunk("IDAT" + compress_zlib({rows.begin(), rows.end()})) + make_chunk("IEND");
}

TEST(ImageFile, ReadsMasksWithAPalette) {
  const TestFolder folder;
  // The 2x1 pixels have the indices 0 and 1: black, and red of 1.
  const std::vector<uchar> bytes = {0x89, 0x50, 0x4E, 0x47, 0x0D, 0x0A, 0x1A, 0x0A, 0x00, 0x00, 0x00, 0x0D, 0x49, 0x48, 0x44,
                                    0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x03, 0x00, 0x00, 0x00, 0xC3,
                                    0xFC, 0x8F, 0xB8, 0x00, 0x00, 0x00, 0x06, 0x50, 0x4C, 0x54, 0x45, 0x00, 0x00, 0x00, 0x01,
                                    0x00, 0x00, 0xA4, 0xA5, 0xD3, 0xF8, 0x00, 0x00, 0x00, 0x0E, 0x49, 0x44, 0x41, 0x54, 0x78,
                                    0x01, 0x01, 0x03, 0x00, 0xFC, 0xFF, 0x00, 0x00, 0x01, 0x00, 0x04, 0x00, 0x02, 0x0B, 0x21,
                                    0x8B, 0x71, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4E, 0x44, 0xAE, 0x42, 0x60, 0x82};
  const cv::Mat1b mask = read_mask(folder.write("m.png", std::string(bytes.begin(), bytes.end())), {2, 1});
  EXPECT_EQ(mask(0, 0), 0);
  EXPECT_EQ(mask(0, 1), 255);
  const cv::Mat indices = read_indices(folder.path / "m.png", {2, 1});
  ASSERT_EQ(indices.type(), CV_8UC1);
  EXPECT_EQ(indices.at<uchar>(0, 0), 0);
  EXPECT_EQ(indices.at<uchar>(0, 1), 1);
}

TEST(ImageFile, ReadsPalettesWhoseBackgroundIsNotBlack) {
  const TestFolder folder;
  const auto count = [&](const std::string& colors, const std::string& numbers) {
    return cv::countNonZero(read_mask(folder.write("m.png", make_palette_png(colors, numbers)), {3, 2}));
  };
  using namespace std::string_literals;
  const std::string blue = "\x1F\x77\xB4", orange = "\xFF\x7F\x0E", black = "\0\0\0"s, white = "\xFF\xFF\xFF";
  EXPECT_EQ(count(blue + orange + white, "\0\1\2\0\0\1"s), 3) << "numbers of objects";
  EXPECT_EQ(count(black + orange + black, "\0\1\2\0\0\1"s), 3) << "a palette with fewer colors than objects";
  EXPECT_EQ(count(blue + orange + white, "\0\0\0\0\0\0"s), 0) << "no objects";
  EXPECT_EQ(count(white + black, "\0\1\1\0\1\1"s), 2) << "black and white";
  EXPECT_EQ(count(orange + black, "\0\1\1\0\1\1"s), 2) << "painted on black";
}

// Adds the EXIF tag for a rotation by 90 degrees to a JPEG.
std::string add_rotation(const std::string& jpeg) {
  using namespace std::string_literals;
  const std::string exif =
      "\xFF\xE1\0\x22"
      "Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0"s;
  return jpeg.substr(0, 2) + exif + jpeg.substr(2);
}

TEST(ImageFile, DoesNotApplyTheOrientationOfImages) {
  const TestFolder folder;
  cv::Mat3b image(16, 32, cv::Vec3b());
  image.colRange(0, 16) = cv::Vec3b(255, 255, 255);
  const fs::path file = folder.write("a.jpg", add_rotation(read_file(folder.write_image("plain.jpg", image))));
  ASSERT_EQ(cv::imread(file.string()).size(), cv::Size(16, 32)) << "the tag is not understood";
  EXPECT_EQ(image_size(file), cv::Size(32, 16));
  EXPECT_GT(read_image(file, {32, 16})(8, 2)[0], 200);
  EXPECT_EQ(read_mask(file, {32, 16})(8, 2), 255);
}

// Changes the size in the header of a PNG; its data would fail to decode.
std::string change_size(std::string png, std::uint32_t width, std::uint32_t height) {
  for (int i = 0; i < 4; ++i) {
    png[static_cast<std::size_t>(16 + i)] = static_cast<char>(width >> (24 - 8 * i));
    png[static_cast<std::size_t>(20 + i)] = static_cast<char>(height >> (24 - 8 * i));
  }
  return png;
}

TEST(ImageFile, RefusesSizesByTheHeader) {
  const TestFolder folder;
  const std::string png = read_file(folder.write_image("a.png", cv::Mat1w(4, 6, ushort{1})));
  const fs::path huge = folder.write("huge.png", change_size(png, 60000, 60000));
  const auto too_large = AllOf(HasSubstr("huge.png: is 60000x60000 pixels"), HasSubstr("2^28"));
  EXPECT_THAT(input_error([&] { image_size(huge); }), too_large);
  EXPECT_THAT(input_error([&] { read_unchanged(huge, {60000, 60000}); }), too_large);
  EXPECT_THAT(input_error([&] { read_mask(huge, {60000, 60000}); }), too_large);
  EXPECT_TRUE(read_unchanged(folder.path / "a.png", {6, 5}).empty());
  const fs::path other = folder.write("other.png", change_size(png, 16000, 16000));
  EXPECT_THAT(input_error([&] { read_image(other, {6, 4}); }), HasSubstr("is 16000x16000 pixels instead of 6x4"));
  EXPECT_THAT(input_error([&] { image_size(folder.write("minus.png", change_size(png, 0x80000001U, 4))); }),
              HasSubstr("cannot be decoded"));
}

}  // namespace
}  // namespace dvi::media
