#include "dvi/io/image_file.h"

#include "dvi/io/test_folder.h"

namespace dvi::io {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(ImageFile, TellsTheSizeByTheHeader) {
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

TEST(ImageFile, RefusesWhatIsUnreadable) {
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

TEST(ImageFile, NamesBothSizes) {
  const TestFolder folder;
  const fs::path file = folder.write_image("a.png", cv::Mat3b(4, 6, cv::Vec3b()));
  EXPECT_THAT(input_error([&] { read_image(file, {6, 5}); }), HasSubstr("is 6x4 pixels instead of 6x5"));
  EXPECT_THAT(input_error([&] { read_mask(file, {7, 4}); }), HasSubstr("is 6x4 pixels instead of 7x4"));
}

}  // namespace
}  // namespace dvi::io
