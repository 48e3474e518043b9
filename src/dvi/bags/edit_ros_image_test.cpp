#include <opencv2/core.hpp>

#include "dvi/bags/ros_image.h"
#include "dvi/testing/test_ros_message.h"

namespace dvi::bags {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

// An image of 2x1 pixels, the second of which is replaced by (B, G, R) = (10, 20, 30).
class EditRosImage : public testing::TestWithParam<BagEncoding> {
 protected:
  std::string raw(const std::string& encoding, const std::string& data) const {
    return MessageBytes(GetParam())
        .add_header(5, 6, "/optical")
        .add<std::uint32_t>(1)
        .add<std::uint32_t>(2)
        .add_text(encoding)
        .add<std::uint8_t>(0)
        .add(static_cast<std::uint32_t>(data.size()))
        .add_data(data)
        .text();
  }
  std::string compressed(const std::string& format, const std::string& file) const {
    return MessageBytes(GetParam()).add_header(5, 6, "/optical").add_text(format).add_data(file).text();
  }
  static media::ImageEdit edit(const cv::Vec3b& kept, const cv::Vec3b& replaced = {10, 20, 30}) {
    return {(cv::Mat3b(1, 2) << kept, replaced), (cv::Mat1b(1, 2) << uchar{0}, uchar{1})};
  }
  static std::string encode(const std::string& ending, const cv::Mat& image) {
    std::vector<uchar> bytes;
    cv::imencode(ending, image, bytes);
    return {bytes.begin(), bytes.end()};
  }
};

TEST_P(EditRosImage, ChangesTheMaskedPixelsOfEachEncoding) {
  const auto expect = [&](const std::string& encoding, const std::string& data, const std::string& edited, cv::Vec3b kept) {
    EXPECT_EQ(edit_image(raw(encoding, data), GetParam(), edit(kept)), raw(encoding, edited)) << encoding;
    kept[1] = static_cast<uchar>(kept[1] + 1);
    EXPECT_EQ(edit_image(raw(encoding, data), GetParam(), edit(kept)), std::nullopt) << encoding << " of another image";
  };
  for (const char* bgr : {"bgr8", "8UC3"}) expect(bgr, "\1\2\3\4\5\6", "\1\2\3\x0A\x14\x1E", {1, 2, 3});
  expect("rgb8", "\1\2\3\4\5\6", "\1\2\3\x1E\x14\x0A", {3, 2, 1});
  expect("rgb8", "\1\2\3\4\5\6padding", "\1\2\3\x1E\x14\x0Apadding", {3, 2, 1});
  for (const char* bgra : {"bgra8", "8UC4"}) expect(bgra, "\1\2\3\4\5\6\7\x08", "\1\2\3\4\x0A\x14\x1E\x08", {1, 2, 3});
  expect("rgba8", "\1\2\3\4\5\6\7\x08", "\1\2\3\4\x1E\x14\x0A\x08", {3, 2, 1});
  const media::ImageEdit gray = edit({7, 7, 7}, {9, 9, 9});
  for (const char* mono : {"mono8", "8UC1"}) EXPECT_EQ(edit_image(raw(mono, "\7\x08"), GetParam(), gray), raw(mono, "\7\x09"));
}

TEST_P(EditRosImage, RefusesEncodingsThatCannotBeWrittenBack) {
  for (const char* encoding : {"bayer_rggb8", "mono16", "rgb16", "uyvy", "yuyv", "32FC1"})
    EXPECT_THAT([&] { edit_image(raw(encoding, std::string(16, '\1')), GetParam(), edit({1, 1, 1})); },
                ThrowsMessage<std::invalid_argument>(HasSubstr(std::string("in its encoding '") + encoding)));
}

TEST_P(EditRosImage, ReplacesTheFileOfACompressedImage) {
  const cv::Mat3b image = (cv::Mat3b(1, 2) << cv::Vec3b(1, 2, 3), cv::Vec3b(4, 5, 6));
  const std::string format = "rgb8; png compressed bgr8";
  const std::string message = compressed(format, encode(".png", image));
  const std::optional<std::string> edited = edit_compressed_image(message, GetParam(), edit({1, 2, 3}), 95);
  ASSERT_TRUE(edited);
  const RosCompressedImage file = parse_image_file(*edited, GetParam());
  EXPECT_EQ(*edited, compressed(format, file.file)) << "header and format";
  EXPECT_EQ(cv::norm(to_bgr(file, 16), edit({1, 2, 3}).colors, cv::NORM_INF), 0) << "without loss";
  EXPECT_EQ(edit_compressed_image(message, GetParam(), edit({1, 2, 4}), 95), std::nullopt) << "another image";
  media::ImageEdit none{image, cv::Mat1b(1, 2, uchar{0})};
  EXPECT_EQ(edit_compressed_image(message, GetParam(), none, 95), message);
}

TEST_P(EditRosImage, RefusesCompressedBayerPatternsAndWidePixels) {
  const auto refuse = [&](const std::string& format, const cv::Mat& image, const char* why) {
    EXPECT_THAT([&] { edit_compressed_image(compressed(format, encode(".png", image)), GetParam(), edit({1, 1, 1}), 95); },
                ThrowsMessage<std::invalid_argument>(HasSubstr(why)));
  };
  refuse("bayer_rggb8; png compressed ", cv::Mat1b(1, 2, uchar{1}), "a Bayer pattern");
  refuse("mono16; png compressed ", cv::Mat1w(1, 2, ushort{1}), "16 bits per color");
}

INSTANTIATE_TEST_SUITE_P(Encodings, EditRosImage, testing::Values(BagEncoding::cdr, BagEncoding::ros1));

}  // namespace
}  // namespace dvi::bags
