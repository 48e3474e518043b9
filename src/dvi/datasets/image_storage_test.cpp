#include "dvi/media/image_storage.h"

#include "dvi/datasets/reader.h"
#include "dvi/datasets/test_foreign_images.h"
#include "dvi/labels/mask_folder.h"
#include "dvi/labels/mask_reading.h"
#include "dvi/media/image_file.h"
#include "dvi/media/video_reader.h"

namespace dvi::datasets {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class StoredImages : public testing::Test {
 protected:
  StoredImages() { folder.write("dvi.toml", kForeignImagesConfig); }
  // Adds a copy of a file of `kForeignImages` as frame `number`.
  void add(int number, const char* image) const {
    const std::string name = std::to_string(number);
    folder.write("images/front/" + name + fs::path(image).extension().string(), read_file(kForeignImages / image));
    folder.write_bin("lidar/" + name + ".bin", {1, 0, 0, 0, 0, 1, 0, 0});
  }
  void add_video(const char* video) const {
    folder.write("images/front.mp4", read_file(kForeignImages / video));
    for (const char* name : {"0", "1", "2"}) folder.write_bin(std::string("lidar/") + name + ".bin", {1, 0, 0, 0, 0, 1, 0, 0});
  }
  Drive read() const { return datasets::read_drive(folder.path); }
  std::string error() const {
    return input_error([&] { read(); });
  }
  TestFolder folder;
};

TEST_F(StoredImages, StateTheirOrientation) {
  EXPECT_EQ(media::read_exif_orientation(kForeignImages / "upright.jpg"), 1);
  EXPECT_EQ(media::read_exif_orientation(kForeignImages / "exif3.jpg"), 3);
  EXPECT_EQ(media::read_exif_orientation(kForeignImages / "exif6.jpg"), 6);
  EXPECT_EQ(media::read_exif_orientation(kForeignImages / "mask_exif8.png"), 8);
  EXPECT_EQ(media::read_exif_orientation(kForeignImages / "bits12.png"), 1);
}

TEST_F(StoredImages, InCmykAreReadAsColors) {
  const cv::Size size(64, 48);
  EXPECT_LE(cv::norm(media::read_image(kForeignImages / "cmyk.jpg", size),
                     media::read_image(kForeignImages / "upright.jpg", size), cv::NORM_INF),
            6);
}

// A file may be truncated or damaged at any byte.
TEST_F(StoredImages, MayBeDamaged) {
  for (const char* name : {"exif6.jpg", "mask_exif8.png"}) {
    const std::string bytes = read_file(kForeignImages / name);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const int cut = media::read_exif_orientation(folder.write("cut", bytes.substr(0, i)));
      std::string changed = bytes;
      changed[i] = static_cast<char>(~changed[i]);
      const int other = media::read_exif_orientation(folder.write("changed", changed));
      EXPECT_TRUE(cut >= 1 && cut <= 8 && other >= 1 && other <= 8) << name << " at byte " << i;
    }
  }
}

TEST_F(StoredImages, AreReadAsStoredWithAWarning) {
  add(0, "exif3.jpg"), add(1, "exif3.jpg");
  const Drive drive = read();
  EXPECT_THAT(drive.warnings,
              ElementsAre(AllOf(HasSubstr("0.jpg has EXIF orientation 3"), HasSubstr("rotate the image by 180 degrees"),
                                HasSubstr("as they are stored"), HasSubstr("exiftran"))));
  const cv::Mat3b stored = media::read_image(kForeignImages / "upright.jpg", {64, 48});
  EXPECT_EQ(cv::norm(*drive.images[0], stored, cv::NORM_INF), 0);
}

TEST_F(StoredImages, ThatDifferInOrientationFromTheirMasksAreRefused) {
  add(0, "exif6.jpg");
  folder.write_image("masks/front/0.png", cv::Mat1b(64, 48, uchar{1}));
  const Drive drive = read();
  EXPECT_THAT(drive.warnings, Contains(HasSubstr("rotate the image by 90 degrees clockwise")));
  EXPECT_THAT(input_error([&] { drive.masks[0]; }),
              AllOf(HasSubstr("0.png: is 48x64 pixels instead of 64x48"), HasSubstr("rotated by 90 degrees")));
}

TEST_F(StoredImages, CauseAWarningIfTheirMasksHaveAnOrientation) {
  add(0, "upright.jpg");
  folder.write("masks/front/0.png", read_file(kForeignImages / "mask_exif8.png"));
  Drive drive = read();
  EXPECT_THAT(drive.warnings, IsEmpty());
  labels::read_masks(drive, {});
  EXPECT_THAT(drive.warnings, Contains(AllOf(HasSubstr("the mask"), HasSubstr("0.png has EXIF orientation 8"))));
}

TEST_F(StoredImages, OfTwelveBitsAreScaledToEightBits) {
  add(0, "bits12.png"), add(1, "bits12.png");
  const Drive drive = read();
  EXPECT_THAT(drive.warnings, ElementsAre(AllOf(HasSubstr("16 bits, but no value above 4095"), HasSubstr("12-bit images"))));
  double low = 0, high = 0;
  cv::minMaxLoc(drive.images[1]->reshape(1), &low, &high);
  EXPECT_EQ(low, 0);
  EXPECT_EQ(high, 255);
  add(1, "bits16.png");
  EXPECT_THAT(read().warnings, IsEmpty()) << "one image with larger values shows that all are of 16 bits";
  EXPECT_EQ(cv::norm(*read().images[1], media::read_image(kForeignImages / "bits16.png", {64, 48}), cv::NORM_INF), 0);
}

TEST_F(StoredImages, MustNotExceedTheBitsOfTheSample) {
  EXPECT_THAT(input_error([&] { media::read_scaled_image(kForeignImages / "bits16.png", {64, 48}, 12); }),
              AllOf(HasSubstr("bits16.png: holds values up to 65535"), HasSubstr("12-bit images")));
  const cv::Mat3b image = media::read_image(kForeignImages / "upright.jpg", {64, 48});
  EXPECT_EQ(cv::norm(media::read_scaled_image(kForeignImages / "upright.jpg", {64, 48}, 12), image, cv::NORM_INF), 0)
      << "8 bits";
}

// ffmpeg turns the frames of rotate90.mp4 by 90 degrees counterclockwise, unless -noautorotate is given.
TEST_F(StoredImages, OfAVideoStateItsRotation) {
  EXPECT_EQ(media::VideoReader(kForeignImages / "plain.mp4").rotation_deg(), 0);
  EXPECT_EQ(media::VideoReader(kForeignImages / "rotate90.mp4").rotation_deg(), 270);
  EXPECT_EQ(media::VideoReader(kForeignImages / "rotate180.mp4").rotation_deg(), 180);
}

TEST_F(StoredImages, OfARotatedVideoAreReadAsStoredWithAWarning) {
  add_video("plain.mp4");
  fs::rename(folder.path / "images/front.mp4", folder.path / "images/front.MP4");
  EXPECT_THAT(read().warnings, IsEmpty());
  fs::remove(folder.path / "images/front.MP4");
  add_video("rotate90.mp4");
  const Drive drive = read();
  EXPECT_EQ(drive.camera.width, 64);
  EXPECT_THAT(drive.warnings,
              ElementsAre(AllOf(HasSubstr("front.mp4 has a rotation flag, by which players rotate it by 270 degrees"),
                                HasSubstr("as they are stored"), HasSubstr("rotate=0"))));
  folder.write("dvi.toml", std::string("[camera.front]\nsize = [48, 64]\n") + std::string(kForeignImagesConfig).substr(15));
  EXPECT_THAT(error(), AllOf(HasSubstr("is 64x48 pixels"), HasSubstr("rotate it by 270 degrees")));
}

TEST(ValueBits, AreRoundedUpToThoseOfCameras) {
  EXPECT_EQ(media::estimate_value_bits(0), 8);
  EXPECT_EQ(media::estimate_value_bits(255), 8);
  EXPECT_EQ(media::estimate_value_bits(256), 10);
  EXPECT_EQ(media::estimate_value_bits(4080), 12);
  EXPECT_EQ(media::estimate_value_bits(5000), 14);
  EXPECT_EQ(media::estimate_value_bits(65535), 16);
}

}  // namespace
}  // namespace dvi::datasets
