// Bad input causes one message with the file and the remedy, and exit code 3. No result is written.

#include <sys/mount.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/media/write_image.h"
#include "program.h"

namespace dvi {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class BadInput : public ProgramTest {
 protected:
  BadInput() { small_drive(); }

  /// Expects that `dvi run` refuses the drive with a message that contains all these words.
  void expect_refused(const std::vector<std::string>& words, const std::string& arguments = "run drive -o out --quiet") const {
    const Result result = dvi(arguments);
    EXPECT_EQ(result.code, 3) << result.err;
    EXPECT_THAT(result.err, testing::StartsWith("dvi: "));
    for (const std::string& word : words) EXPECT_THAT(result.err, HasSubstr(word));
    EXPECT_FALSE(fs::exists(folder / "out")) << "no result is left";
  }

  void truncate(const fs::path& file, std::uintmax_t size) const { fs::resize_file(file, size); }

  std::string replaced(std::string text, const std::string& from, const std::string& to) const {
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  }

  fs::path scan() const { return folder / "drive/lidar/000002.bin"; }
  fs::path image() const { return folder / "drive/images/front/000002.png"; }
  fs::path mask() const { return folder / "drive/masks/front/000002.png"; }
};

TEST_F(BadInput, NoDrive) {
  expect_refused({"nowhere"}, "run nowhere -o out --quiet");
  make_folder(folder / "empty");
  expect_refused({"empty", "kitti-raw"}, "run empty -o out --quiet");
}

TEST_F(BadInput, ImagesOfAnotherClock) {
  const fs::path times = folder / "drive/times/front.txt";
  std::string text;
  for (const std::string& line : read_lines(times)) {
    const std::size_t blank = line.find(' ');
    text += line.substr(0, blank) + " " + std::to_string(std::stod(line.substr(blank)) + 37) + "\n";
  }
  write_file(times, text);
  for (const char* command : {"run drive -o out --quiet", "check drive --quiet", "map drive -o out --quiet"})
    expect_refused(
        {"no scan belongs to any image", "37.00 s ahead (TAI against UTC)", "add -37.00 to offset_s of [camera.front]"},
        command);
  const fs::path config = folder / "drive/dvi.toml";
  write_file(config, replaced(read_file(config), "[camera.front]\n", "[camera.front]\noffset_s = -37\n"));
  EXPECT_EQ(dvi("check drive --quiet").code, 0);
}

TEST_F(BadInput, NoStaticPointRemains) {
  for (int i = 0; i < 6; ++i)
    media::write_png(folder / "drive/masks/front" / ("00000" + std::to_string(i) + ".png"), cv::Mat1b(kSize, uchar{255}));
  for (const char* command : {"run", "plan", "map"}) {
    const Result result = dvi(std::string(command) + " drive -o out --quiet --masks drive/masks/front --polarity white");
    EXPECT_EQ(result.code, 3) << command;
    EXPECT_THAT(result.err, AllOf(HasSubstr("no static points remain of"), HasSubstr("are covered by masks of removed objects"),
                                  HasSubstr("were not observed by the camera"), HasSubstr("check the masks")))
        << command;
  }
}

TEST_F(BadInput, ScanOfHalfAPoint) {
  truncate(scan(), fs::file_size(scan()) - 6);
  expect_refused({"000002.bin"});
}

TEST_F(BadInput, ScanWithoutPoints) {
  truncate(scan(), 0);
  expect_refused({"000002.bin"});
}

TEST_F(BadInput, ScanWithoutReturns) {
  write_file(scan(), std::string(fs::file_size(scan()), '\xff'));  // NaN
  expect_refused({"000002.bin", "none of its", "is a return"});
}

TEST_F(BadInput, UnreadableImage) {
  truncate(image(), 200);
  expect_refused({"000002.png"});
  write_file(image(), "no picture at all");
  expect_refused({"000002.png"});
}

TEST_F(BadInput, ImageWhoseSizeDiffers) {
  media::write_png(image(), cv::Mat3b(100, 200, cv::Vec3b(1, 2, 3)));
  expect_refused({"000002.png", "200", "240"});
}

TEST_F(BadInput, MaskWhoseSizeDiffers) {
  media::write_png(mask(), cv::Mat1b(100, 200, uchar{0}));
  expect_refused({"000002.png", "200", "240"});
}

TEST_F(BadInput, MasksForNoFrame) {
  make_folder(folder / "masks");
  media::write_png(folder / "masks/holiday.png", cv::Mat1b(136, 240, uchar{255}));
  expect_refused({"masks"}, "run drive -o out --quiet --masks masks");
  expect_refused({"absent"}, "run drive -o out --quiet --masks absent");
}

TEST_F(BadInput, MalformedPoses) {
  const fs::path poses = folder / "drive/poses.txt";
  const std::string good = read_file(poses);
  write_file(poses, replaced(good, "000003 ", "000003 seven "));
  expect_refused({"poses.txt", "4"});
  write_file(poses, replaced(good, "000003", "\n000003"));
  expect_refused({"poses.txt"});
}

TEST_F(BadInput, NeitherPosesNorScans) {
  fs::remove(folder / "drive/poses.txt");
  fs::remove_all(folder / "drive/lidar");
  fs::remove(folder / "drive/poses.txt");
  expect_refused({"drive", "--poses"});
}

TEST_F(BadInput, NoFrameAtTheTimeOfAPose) {
  std::string times;
  for (const fs::path& image : list_files(folder / "drive/images/front", {".png"}))
    times += image.stem().string() + " 9" + image.stem().string().substr(2) + "\n";  // hours after the scans
  write_file(folder / "drive/times/front.txt", times);
  for (const char* command : {"run", "map", "mask", "forecast", "holdout"})
    expect_refused({"drive: the images are from", "no scan belongs to any image", "offset_s"},
                   std::string(command) + " drive -o out --quiet");
}

TEST_F(BadInput, NeitherMasksNorLabelsNorScans) {
  fs::remove_all(folder / "drive/masks");
  fs::remove(folder / "drive/boxes.json");
  fs::remove_all(folder / "drive/lidar");
  fs::remove(folder / "drive/poses.txt");
  expect_refused({"--masks"});
}

TEST_F(BadInput, MalformedCalibration) {
  const fs::path toml = folder / "drive/dvi.toml";
  const std::string good = read_file(toml);
  write_file(toml, good + "\n[camera.front\n");
  expect_refused({"dvi.toml"});
  write_file(toml, replaced(good, "size", "seize"));
  expect_refused({"dvi.toml", "size"});
}

TEST_F(BadInput, FramesOutsideTheDrive) { expect_refused({"5"}, "run drive -o out --quiet --frames 40:50"); }

TEST_F(BadInput, UnknownCamera) { expect_refused({"rear", "front"}, "run drive -o out --quiet --camera rear"); }

TEST_F(BadInput, ReadOnlyFolder) {
  const Result result = dvi("run drive -o /proc/dvi-out --quiet");
  EXPECT_EQ(result.code, 3) << result.err;
  EXPECT_THAT(result.err, HasSubstr("/proc/dvi-out"));
}

TEST_F(BadInput, DiskFull) {
  const fs::path tiny = folder / "tiny";
  make_folder(tiny);
  if (mount("tmpfs", tiny.c_str(), "tmpfs", 0, "size=400k") != 0) GTEST_SKIP() << "needs the right to mount a tmpfs";
  const Result result = dvi("run drive -o tiny/out --quiet");
  EXPECT_EQ(result.code, 3) << result.err;
  EXPECT_THAT(result.err, HasSubstr("tiny/out"));
  for (const auto& entry : fs::recursive_directory_iterator(tiny))
    EXPECT_THAT(entry.path().filename().string(), testing::Not(HasSubstr(".part"))) << "a partial file is left";
  umount(tiny.c_str());
}

/// Gaps that can be bridged cause a warning, also in the report, and not an error.
class ScanGap : public BadInput {
 protected:
  void expect_warned(const std::string& word) const {
    const Result result = dvi("run drive -o out");
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_THAT(result.err, AllOf(HasSubstr("warning"), HasSubstr(word)));
    const nlohmann::json report = nlohmann::json::parse(read_file(folder / "out/report.json"));
    EXPECT_THAT(report["warnings"].dump(), HasSubstr(word));
  }
};

TEST_F(ScanGap, FrameWithoutScan) {
  fs::remove(scan());
  expect_warned("no scan for frames 2");
}

TEST_F(ScanGap, MissingImageNumber) {
  fs::remove(image());
  expect_warned("frames 2");
  EXPECT_FALSE(fs::exists(folder / "out/frames/000002.png"));
  EXPECT_TRUE(fs::exists(folder / "out/frames/000003.png"));
}

TEST_F(ScanGap, FrameWithoutPoseBetweenTwoWithPoses) {
  const fs::path poses = folder / "drive/poses.txt";
  std::string kept;
  for (const std::string& line : read_lines(poses))
    if (!line.starts_with("000002 ")) kept += line + "\n";
  write_file(poses, kept);
  expect_warned("no pose for the scans of frames 2");
  EXPECT_TRUE(fs::exists(folder / "out/frames/000002.png"));
}

}  // namespace
}  // namespace dvi
