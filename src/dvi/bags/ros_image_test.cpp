#include "dvi/bags/ros_image.h"

#include <opencv2/core.hpp>

#include "dvi/testing/test_ros_message.h"

namespace dvi::bags {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

class RosImages : public testing::TestWithParam<BagEncoding> {
 protected:
  // An image of 1x1 pixels.
  std::string message(const std::string& encoding, std::uint32_t step, const std::string& data,
                      bool is_big_endian = false) const {
    return MessageBytes(GetParam())
        .add_header(5, 6, "/optical")
        .add<std::uint32_t>(1)
        .add<std::uint32_t>(1)
        .add_text(encoding)
        .add<std::uint8_t>(is_big_endian ? 1 : 0)
        .add(step)
        .add_data(data)
        .text();
  }
};

TEST_P(RosImages, ConvertAllEncodingsToBgr) {
  const auto image = [&](const std::string& encoding, std::uint32_t step, const std::string& data) {
    const std::string message = this->message(encoding, step, data);
    EXPECT_EQ(parse_image(message, GetParam()).header.stamp_ns, 5'000'000'006);
    EXPECT_EQ(parse_image(message, GetParam()).header.frame, "optical");
    return cv::Vec3b(to_bgr(parse_image(message, GetParam()))(0, 0));
  };
  EXPECT_EQ(image("rgb8", 3, "\1\2\3"), cv::Vec3b(3, 2, 1));
  EXPECT_EQ(image("bgr8", 8, "\1\2\3     "), cv::Vec3b(1, 2, 3)) << "rows may be longer";
  EXPECT_EQ(image("rgba8", 4, "\1\2\3\4"), cv::Vec3b(3, 2, 1));
  EXPECT_EQ(image("mono8", 1, "\7"), cv::Vec3b(7, 7, 7));
  EXPECT_THAT([&] { image("32FC1", 4, "    "); }, ThrowsMessage<std::invalid_argument>(HasSubstr("32FC1")));
  EXPECT_THAT([&] { image("rgb8", 3, "\1\2"); }, ThrowsMessage<std::invalid_argument>(HasSubstr("2 bytes")));
}

// 16 bits per channel as in sensor_msgs/image_encodings.hpp, in the byte order that the message states.
TEST_P(RosImages, ScaleSixteenBitsByTheUsedBits) {
  const auto color = [&](const std::string& encoding, const std::string& data, int bits, bool is_big_endian = false) {
    const std::string bytes = message(encoding, static_cast<std::uint32_t>(data.size()), data, is_big_endian);
    return cv::Vec3b(to_bgr(parse_image(bytes, GetParam()), bits)(0, 0));
  };
  EXPECT_EQ(color("mono16", std::string("\x34\x12", 2), 16), cv::Vec3b(0x12, 0x12, 0x12));
  EXPECT_EQ(color("mono16", std::string("\x12\x34", 2), 16, true), cv::Vec3b(0x12, 0x12, 0x12));
  EXPECT_EQ(color("mono16", std::string("\x34\x0F", 2), 12), cv::Vec3b(0xF3, 0xF3, 0xF3));
  EXPECT_EQ(color("rgb16", std::string("\0\1\0\2\0\3", 6), 16), cv::Vec3b(3, 2, 1));
  EXPECT_EQ(color("bgra16", std::string("\0\1\0\2\0\3\0\4", 8), 16), cv::Vec3b(1, 2, 3));
  EXPECT_EQ(color("rgba16", std::string("\x10\0\x20\0\x30\0\xFF\xFF", 8), 8), cv::Vec3b(0x30, 0x20, 0x10)) << "opaque";
  EXPECT_THAT([&] { color("mono16", std::string("\0\x10", 2), 12); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("4096, but other images of the topic were read as 12-bit")));
  const auto depth = [&](bool is_big_endian) {
    const std::string bytes = message("16UC1", 2, std::string("\1\2", 2), is_big_endian);
    return to_depth(parse_image(bytes, GetParam()))(0, 0);
  };
  EXPECT_EQ(depth(false), 0x201);
  EXPECT_EQ(depth(true), 0x102);
}

TEST_P(RosImages, RoundUsedBitsUpToThoseOfCameras) {
  const std::string bytes = message("mono16", 2, std::string("\xF0\x0F", 2));
  EXPECT_TRUE(has_16_bits(parse_image(bytes, GetParam())));
  EXPECT_EQ(find_largest_value(parse_image(bytes, GetParam())), 0xFF0);
}

TEST_P(RosImages, RefuseOtherEncodings) {
  EXPECT_THAT([&] { to_bgr(parse_image(message("nv12", 1, "  "), GetParam())); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("'nv12' is not supported")));
  for (const char* encoding : {"uyvy", "yuyv"})
    EXPECT_THAT([&] { to_bgr(parse_image(message(encoding, 2, "  "), GetParam())); },
                ThrowsMessage<std::invalid_argument>(HasSubstr("a width of 1 is not possible")));
}

TEST_P(RosImages, RefuseCompressedFilesOfOtherFormats) {
  const auto file = [&](const std::string& format, const std::string& data) {
    const std::string bytes = MessageBytes(GetParam()).add_header(5, 6, "optical").add_text(format).add_data(data).text();
    return parse_image_file(bytes, GetParam()).file;
  };
  EXPECT_EQ(file("jpeg", "\xFF\xD8\xFF"), "\xFF\xD8\xFF");
  EXPECT_THAT([&] { file("webp", "RIFF....WEBP"); }, ThrowsMessage<std::invalid_argument>(HasSubstr("'webp'")));
  EXPECT_THAT([&] { file("jpeg", ""); }, ThrowsMessage<std::invalid_argument>(HasSubstr("0 bytes")));
}

// image_transport stores a Bayer pattern as a gray file and states it in the format.
TEST(RosImageFiles, ConvertBayerPatterns) {
  cv::Mat1b pattern(8, 8, uchar{0});
  for (int y = 0; y < 8; y += 2)
    for (int x = 0; x < 8; x += 2) pattern(y, x) = 200;  // red
  cv::Mat3b gray;
  cv::merge(std::vector<cv::Mat1b>{pattern, pattern, pattern}, gray);
  EXPECT_EQ(convert_bayer_file(gray, "bayer_rggb8; jpeg compressed ")(3, 3), cv::Vec3b(0, 0, 200));
  EXPECT_EQ(cv::norm(convert_bayer_file(gray, "mono8; jpeg compressed "), gray, cv::NORM_INF), 0);
  cv::Mat3b color = gray.clone();
  color(0, 0) = {1, 2, 3};
  EXPECT_EQ(cv::norm(convert_bayer_file(color, "bayer_rggb8; jpeg compressed bgr8"), color, cv::NORM_INF), 0);
}

TEST(RosImageFiles, ScaleSixteenBitsByTheUsedBits) {
  std::vector<uchar> bytes;
  cv::imencode(".png", cv::Mat1w(2, 2, ushort{0xF30}), bytes);
  const RosCompressedImage image{"mono16; png compressed ", std::string(bytes.begin(), bytes.end())};
  EXPECT_TRUE(has_16_bits(image));
  EXPECT_EQ(find_largest_value(image), 0xF30);
  EXPECT_EQ(to_bgr(image, 12)(1, 1), cv::Vec3b(0xF3, 0xF3, 0xF3));
  EXPECT_FALSE(has_16_bits({"jpeg", "\xFF\xD8"}));
}

TEST(RosImageFiles, RecognizeDepthByTheFormat) {
  EXPECT_TRUE((RosCompressedImage{"16UC1; compressedDepth", ""}.is_depth()));
  EXPECT_TRUE((RosCompressedImage{"16UC1; png compressed ", ""}.is_depth()));
  EXPECT_FALSE((RosCompressedImage{"rgb8; jpeg compressed bgr8", ""}.is_depth()));
}

INSTANTIATE_TEST_SUITE_P(Encodings, RosImages, testing::Values(BagEncoding::cdr, BagEncoding::ros1),
                         [](const auto& e) { return e.param == BagEncoding::cdr ? "Cdr" : "Ros1"; });

}  // namespace
}  // namespace dvi::bags
