#include "dvi/datasets/file_names.h"

#include <fmt/format.h>

#include "dvi/datasets/reader.h"
#include "dvi/datasets/test_foreign_images.h"

namespace dvi::datasets {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

class NamedFiles : public testing::Test {
 protected:
  NamedFiles() { folder.write("dvi.toml", kForeignImagesConfig); }
  void add_image(const std::string& name) const {
    const fs::path original = kForeignImages / ("picture" + fs::path(name).extension().string());
    const fs::path source = fs::exists(original) ? original : kForeignImages / "upright.jpg";
    folder.write("images/front/" + name, read_file(source));
  }
  void add_scan(const std::string& name) const { folder.write_bin("lidar/" + name, {1, 0, 0, 0, 0, 1, 0, 0}); }
  Drive read() const { return read_drive(folder.path); }
  std::string error() const {
    return input_error([&] { read(); });
  }
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const Frame& frame : read().frames) names.push_back(frame.name);
    return names;
  }
  TestFolder folder;
};

TEST_F(NamedFiles, AreOrderedByTheNumbersInTheirNames) {
  for (const int i : {1, 2, 9, 10, 11}) {
    add_image("frame" + std::to_string(i) + ".jpg");
    add_scan("frame" + std::to_string(i) + ".bin");
  }
  folder.write_image("masks/front/frame10.png", cv::Mat1b(48, 64, uchar{1}));
  EXPECT_THAT(names(), ElementsAre("frame1", "frame2", "frame9", "frame10", "frame11"));
  const Drive drive = read();
  EXPECT_THAT(drive.warnings,
              ElementsAre(AllOf(HasSubstr("by the numbers in their names"), HasSubstr("frame2 comes before frame10"))));
  EXPECT_EQ(drive.scan_headers[3].name, "frame10");
  EXPECT_EQ(drive.scan_headers[3].time_ns, drive.frames[3].time_ns);
  EXPECT_EQ((*drive.masks[3])(0, 0), 255);
}

TEST_F(NamedFiles, OfEqualLengthCauseNoWarning) {
  for (const char* name : {"frame01", "frame02", "frame10"})
    add_image(name + std::string(".jpg")), add_scan(name + std::string(".bin"));
  EXPECT_THAT(names(), ElementsAre("frame01", "frame02", "frame10"));
  EXPECT_TRUE(read().warnings.empty());
}

TEST_F(NamedFiles, AreMatchedByTheirNumbersWithoutLeadingZeros) {
  for (const int i : {0, 5, 10}) {
    add_image(fmt::format("{:06}.jpg", i));
    add_scan(fmt::format("{}.bin", i));
  }
  Drive drive = read();
  ASSERT_EQ(drive.frames.size(), 3U);
  EXPECT_EQ(drive.frames[2].time_ns, 1'000'000'000);
  EXPECT_EQ(drive.scan_headers[2].time_ns, 1'000'000'000);
  folder.write("times/front.txt", "0 1.0\n5 2.0e+00\n10 3.25\n");
  folder.write("poses.txt", "000000 1 0 0 0 0 1 0 0 0 0 1 0\n000010 1 0 0 2 0 1 0 0 0 0 1 0\n");
  drive = read();
  EXPECT_EQ(drive.frames[2].time_ns, 3'250'000'000);
  EXPECT_EQ(drive.scan_headers[1].time_ns, 2'000'000'000);
  ASSERT_EQ(drive.poses.poses().size(), 2U);
  EXPECT_EQ(drive.poses.poses()[1].time_ns, 3'250'000'000);
}

TEST_F(NamedFiles, MustBeUnique) {
  add_scan("000000.bin");
  add_image("000000.jpg"), add_image("000000.png");
  EXPECT_THAT(error(),
              AllOf(HasSubstr("000000.png: has the name or number of 000000.jpg"), HasSubstr("remove one of the two")));
  fs::remove(folder.path / "images/front/000000.png");
  add_image("0.JPG");
  EXPECT_THAT(error(), HasSubstr("has the name or number of"));
}

TEST_F(NamedFiles, OfImagesAndScansMustMatch) {
  add_image("img_1.jpg"), add_scan("cloud_1.bin");
  EXPECT_THAT(error(), AllOf(HasSubstr("img_1.jpg: has no scan of the same name"), HasSubstr("the first scan is cloud_1.bin"),
                             HasSubstr("add times/CAMERA.txt")));
  folder.write("times/front.txt", "img_1 1\n");
  folder.write("times/lidar.txt", "cloud_1 1.01\n");
  EXPECT_EQ(read().frames.size(), 1U);
}

TEST_F(NamedFiles, MayEndInUpperCase) {
  for (const char* name : {"0.JPG", "1.Jpeg", "2.JPEG"}) add_image(name);
  for (const char* name : {"0.BIN", "1.bin", "2.bin"}) add_scan(name);
  folder.write_image("masks/front/1.png", cv::Mat1b(48, 64, uchar{1}));
  fs::rename(folder.path / "masks/front/1.png", folder.path / "masks/front/1.PNG");
  const Drive drive = read();
  ASSERT_EQ(drive.frames.size(), 3U);
  EXPECT_EQ(drive.images[0]->size(), cv::Size(64, 48));
  EXPECT_EQ((*drive.masks[1])(0, 0), 255);
}

TEST_F(NamedFiles, InOtherFormatsAreReported) {
  for (const char* name : {"0.tif", "1.TIF", "2.webp", "3.bmp"}) add_image(name);
  add_scan("0.bin");
  EXPECT_THAT(error(), AllOf(HasSubstr("images/front: holds no images in a supported format"),
                             HasSubstr("1 file .bmp, 2 files .tif, 1 file .webp"),
                             HasSubstr("supported formats are .png, .jpg, .jpeg"), HasSubstr("mogrify")));
  add_image("0.jpg");
  EXPECT_THAT(read().warnings, Contains(AllOf(HasSubstr("2 files .tif"), HasSubstr("are not read"))));
}

}  // namespace
}  // namespace dvi::datasets
