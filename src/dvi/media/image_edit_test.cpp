#include "dvi/media/image_edit.h"

#include <libdeflate.h>

#include "dvi/media/image_file.h"
#include "dvi/testing/image_folder.h"

namespace dvi::media {
namespace {

using testing::HasSubstr;

std::string encode(const std::string& ending, const cv::Mat& image, const std::vector<int>& options = {}) {
  std::vector<uchar> bytes;
  cv::imencode(ending, image, bytes, options);
  return {bytes.begin(), bytes.end()};
}

// A smooth picture of 64 x 48 pixels, whose left half is replaced.
cv::Mat make_picture(int type) {
  cv::Mat picture(48, 64, type);
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x)
      for (int c = 0; c < picture.channels(); ++c)
        picture.ptr(y)[x * picture.channels() + c] = static_cast<uchar>(x + y + 10 * c);
  return picture;
}

ImageEdit make_edit(const std::string& file, bool is_gray = false) {
  ImageEdit edit{decode_image("a", file, {64, 48}).clone(), cv::Mat1b(48, 64, uchar{0})};
  edit.is_changed.colRange(0, 32).setTo(1);
  edit.colors.colRange(0, 32).setTo(is_gray ? cv::Scalar(90, 90, 90) : cv::Scalar(90, 100, 110));
  return edit;
}

TEST(ImageEdit, KeepsFormatAndOtherPixelsOfAPng) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4}) {
    const std::string file = encode(".png", make_picture(type));
    const ImageEdit edit = make_edit(file, type == CV_8UC1);
    const std::optional<std::string> edited = edit_image_file("a.png", file, edit, 1);
    ASSERT_TRUE(edited);
    const cv::Mat before = decode_unchanged("a", file, {64, 48}), after = decode_unchanged("a", *edited, {64, 48});
    ASSERT_EQ(after.type(), type);
    EXPECT_EQ(cv::norm(before.colRange(32, 64), after.colRange(32, 64), cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(decode_image("a", *edited, {64, 48}), edit.colors, cv::NORM_INF), 0);
    if (type == CV_8UC4) {
      cv::Mat1b alpha, alpha_before;
      cv::extractChannel(after, alpha, 3);
      cv::extractChannel(before, alpha_before, 3);
      EXPECT_EQ(cv::norm(alpha, alpha_before, cv::NORM_INF), 0);
    }
  }
}

TEST(ImageEdit, ReturnsTheFileIfNoPixelChanges) {
  const std::string file = encode(".jpg", make_picture(CV_8UC3));
  ImageEdit edit = make_edit(file);
  EXPECT_FALSE(edit.is_empty());
  edit.is_changed.setTo(0);
  EXPECT_EQ(edit_image_file("a.jpg", file, edit, 50), std::nullopt) << "the colors are of another image";
  edit.colors = decode_image("a", file, {64, 48});
  EXPECT_EQ(edit_image_file("a.jpg", file, edit, 50), file);
  edit.colors = edit.colors.colRange(0, 63).clone();
  EXPECT_EQ(edit_image_file("a.jpg", file, edit, 50), std::nullopt) << "the images differ in size";
}

TEST(ImageEdit, CompressesJpegByQualityAndKeepsGray) {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    const std::string file = encode(".jpg", make_picture(type));
    const ImageEdit edit = make_edit(file, type == CV_8UC1);
    const std::string good = edit_image_file("a.jpg", file, edit, 98).value(),
                      bad = edit_image_file("a.jpg", file, edit, 5).value();
    EXPECT_LT(bad.size(), good.size());
    EXPECT_EQ(decode_unchanged("a", good, {64, 48}).type(), type);
    const cv::Mat3b right = decode_image("a", good, {64, 48}).colRange(40, 64);
    EXPECT_LE(cv::norm(right, edit.colors.colRange(40, 64), cv::NORM_INF), 4);
  }
}

std::string png_chunk(const std::string& type, const std::string& content) {
  const auto number = [](std::uint32_t value) {
    std::string out;
    for (const int shift : {24, 16, 8, 0}) out += static_cast<char>(value >> shift);
    return out;
  };
  const std::string summed = type + content;
  return number(static_cast<std::uint32_t>(content.size())) + summed +
         number(libdeflate_crc32(0, summed.data(), summed.size()));
}

// Viewers apply the EXIF orientation, so that an image without it would be shown otherwise.
TEST(ImageEdit, KeepsMetadata) {
  std::string png = encode(".png", make_picture(CV_8UC3));
  const std::string text = png_chunk("tEXt", std::string("Title\0a street", 14)), exif = png_chunk("eXIf", "MM exif");
  png.insert(33, text);
  png.insert(png.size() - 12, exif);
  const std::string edited = edit_image_file("a.png", png, make_edit(png), 95).value();
  EXPECT_THAT(edited, HasSubstr(text));
  EXPECT_THAT(edited, HasSubstr(exif));
  EXPECT_NO_THROW(decode_image("a", edited, {64, 48}));

  std::string jpeg = encode(".jpg", make_picture(CV_8UC3));
  const std::string segment = std::string("\xFF\xE1\x00\x10", 4) + std::string("Exif\0\0MM\0*1234", 14);
  const std::string adobe = std::string("\xFF\xEE\x00\x04", 4) + "ad";
  jpeg.insert(20, segment + adobe);
  const std::string other = edit_image_file("a.jpg", jpeg, make_edit(jpeg), 95).value();
  EXPECT_EQ(other.substr(20, segment.size()), segment);
  EXPECT_THAT(other, testing::Not(HasSubstr(adobe))) << "it describes the colors of the old file";
  EXPECT_NO_THROW(decode_image("a", other, {64, 48}));
}

TEST(ImageEdit, RefusesFilesThatCannotBeWrittenBack) {
  const auto refusal = [](const std::string& file) {
    return input_error([&] { edit_image_file("a.png", file, make_edit(file), 95); });
  };
  EXPECT_THAT(refusal(encode(".png", cv::Mat1w(48, 64, ushort{7}))),
              HasSubstr("16 bits per color, which cannot be written back"));
  EXPECT_THAT(refusal(encode(".png", make_picture(CV_8UC1), {cv::IMWRITE_PNG_BILEVEL, 1})), HasSubstr("1 bits per color"));
  std::string transparent = encode(".png", make_picture(CV_8UC3));
  transparent.insert(33, png_chunk("tRNS", std::string(6, '\1')));
  EXPECT_THAT(refusal(transparent), HasSubstr("a transparent color"));
}

}  // namespace
}  // namespace dvi::media
