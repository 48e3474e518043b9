#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/media/image_file.h"
#include "dvi/media/write_image.h"
#include "program.h"

namespace dvi {
namespace {

using testing::HasSubstr;

class AuditCommand : public ProgramTest {
 protected:
  AuditCommand() {
    small_drive("drive", "--exposure-drift 0.12");
    EXPECT_EQ(dvi("run drive -o out --quiet").code, 0);
    name = list_files(folder / "out/frames", {".png"})[2].stem().string();
  }

  fs::path picture(const std::string& kind) const { return folder / "out" / kind / (name + ".png"); }

  cv::Point first_of_kind(int kind) const {
    const cv::Mat1b kinds = media::read_png_gray(picture("kind"), kSize);
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x)
        if (kinds(y, x) == kind) return {x, y};
    ADD_FAILURE() << "no pixel of kind " << kind;
    return {};
  }

  /// Expects that the audit fails with exit code 3, and finds `breach` in this number of pixels.
  void expect_breach(const std::string& breach, std::size_t pixels, const std::string& arguments = "out drive") const {
    const Result result = dvi("audit " + arguments + " --json --quiet");
    EXPECT_EQ(result.code, 3);
    EXPECT_THAT(result.err, HasSubstr("fails the audit"));
    const nlohmann::json report = nlohmann::json::parse(result.out);
    EXPECT_FALSE(report["passed"].get<bool>());
    EXPECT_EQ(report["findings"][breach]["pixels"], pixels) << report["findings"].dump(1);
  }

  std::string name;
};

TEST_F(AuditCommand, PassesTheResultOfARun) {
  const Result result = dvi("audit out drive --json --quiet");
  ASSERT_EQ(result.code, 0) << result.out << result.err;
  const nlohmann::json report = nlohmann::json::parse(result.out);
  EXPECT_TRUE(report["passed"].get<bool>());
  EXPECT_EQ(report["frames"], 6);
  const nlohmann::json hole = nlohmann::json::parse(read_file(folder / "out/report.json"))["hole"];
  EXPECT_EQ(report["removed_pixels"], hole["pixels"]);
  EXPECT_EQ(report["copied_pixels"], hole["copied"]);
  EXPECT_GT(report["copied_pixels"], 0);
  EXPECT_EQ(dvi("audit out drive --json --quiet --threads 1").out, result.out);
}

TEST_F(AuditCommand, PassesTheResultOfARunThatCompletedObjects) {
  media::write_png(folder / "drive/masks/front" / (name + ".png"), cv::Mat1b(kSize, uchar{0}));
  ASSERT_EQ(dvi("run drive -o completed --set masks.shadows=false --quiet").code, 0);
  const cv::Mat1b mask = media::read_mask(folder / "completed/masks" / (name + ".png"), kSize);
  ASSERT_GT(cv::countNonZero(mask), 0);
  const Result result = dvi("audit completed drive --json --quiet");
  EXPECT_EQ(result.code, 0) << result.out << result.err;
}

TEST_F(AuditCommand, FindsOneChangedPixel) {
  cv::Mat3b frame = media::read_image(picture("frames"), kSize);
  const cv::Point copied = first_of_kind(1), kept = first_of_kind(0);
  frame(copied)[1] = static_cast<uchar>(frame(copied)[1] ^ 1);
  media::write_png(picture("frames"), frame);
  expect_breach("color", 1);
  frame(kept)[0] = static_cast<uchar>(frame(kept)[0] ^ 1);
  media::write_png(picture("frames"), frame);
  expect_breach("outside", 1);
}

TEST_F(AuditCommand, FindsASmallerMask) {
  cv::Mat1b mask = media::read_png_gray(picture("masks"), kSize);
  mask(first_of_kind(1)) = 0;
  media::write_png(picture("masks"), mask);
  expect_breach("mask", 1);
  expect_breach("receipt", 1);
}

TEST_F(AuditCommand, FindsARunWithSmallerMasksThanTheGivenOnes) {
  // The given mask has one pixel more than that of the run.
  const fs::path wanted = folder / "wanted";
  fs::copy(folder / "drive/masks/front", wanted, fs::copy_options::recursive);
  cv::Mat1b mask = media::read_mask(wanted / (name + ".png"), kSize);
  mask(first_of_kind(0)) = 255;
  media::write_png(wanted / (name + ".png"), mask);
  expect_breach("mask", 1, "out drive --masks " + wanted.string());
}

TEST_F(AuditCommand, FindsACopyFromInsideAMask) {
  cv::Mat_<cv::Vec3w> provenance = media::read_png_triples(picture("provenance"), kSize);
  const cv::Point p = first_of_kind(1);
  const std::size_t source = provenance(p)[0] - 1U;
  const nlohmann::json sources = nlohmann::json::parse(read_file(folder / "out/sources.json"))["sources"];
  const std::string other = sources[source]["frame"];
  const cv::Mat1b mask = media::read_mask(folder / "drive/masks/front" / (other + ".png"), kSize);
  std::vector<cv::Point> masked;
  cv::findNonZero(mask, masked);
  ASSERT_FALSE(masked.empty());
  provenance(p)[1] = static_cast<ushort>(masked.front().x * 16);
  provenance(p)[2] = static_cast<ushort>(masked.front().y * 16);
  media::write_png(picture("provenance"), provenance);
  expect_breach("masked_source", 1);
}

TEST_F(AuditCommand, FindsProvenanceOfMissingSources) {
  cv::Mat_<cv::Vec3w> provenance = media::read_png_triples(picture("provenance"), kSize);
  provenance(first_of_kind(1))[0] = 999;
  media::write_png(picture("provenance"), provenance);
  expect_breach("receipt", 1);
}

TEST_F(AuditCommand, RefusesFoldersThatAreNotAResultOfThisDrive) {
  const auto error = [&](const std::string& arguments) {
    const Result result = dvi("audit " + arguments + " --quiet");
    EXPECT_EQ(result.code, 3) << arguments;
    return result.err;
  };
  EXPECT_THAT(error("drive drive"), HasSubstr("is not a result"));
  EXPECT_THAT(error("out nowhere"), HasSubstr("nowhere"));
  EXPECT_THAT(error("out drive drive"), HasSubstr("was made from 1 drive"));
  ASSERT_EQ(dvi("synth -o longer --frames 3 --width 240 --height 136 --beams 16 --columns 300 --quiet").code, 0);
  EXPECT_THAT(error("out longer"), HasSubstr("has no frame"));

  const std::string whole = read_file(picture("provenance"));
  write_file(picture("provenance"), whole.substr(0, whole.size() / 2));
  EXPECT_THAT(error("out drive"), HasSubstr(picture("provenance").filename().string()));
  fs::remove(picture("provenance"));
  EXPECT_THAT(error("out drive"), HasSubstr(picture("provenance").filename().string()));
  write_file(folder / "out/sources.json", "{\"sources\": [");
  EXPECT_THAT(error("out drive"), HasSubstr("sources.json"));
}

TEST_F(AuditCommand, DetectsAnotherDriveWithTheSameFrameNames) {
  ASSERT_EQ(dvi("synth -o other --seed 5 --frames 6 --width 240 --height 136 --beams 16 --columns 300 --quiet").code, 0);
  const Result result = dvi("audit out other --quiet");
  EXPECT_EQ(result.code, 3);
  EXPECT_THAT(result.err, HasSubstr("differs from the image of the drive"));
}

TEST_F(AuditCommand, ChecksResultsOfSourceDrivesAndBaselines) {
  small_drive("second", "--day 2");
  ASSERT_EQ(dvi("run drive second -o both --quiet").code, 0);
  EXPECT_EQ(dvi("audit both drive second --quiet").code, 0);
  EXPECT_EQ(dvi("audit both second drive --quiet").code, 3);
  ASSERT_EQ(dvi("run drive -o flow --method flow --quiet").code, 0);
  EXPECT_EQ(dvi("audit flow drive --quiet").code, 0);
  ASSERT_EQ(dvi("run drive second -o telea --method telea --quiet").code, 0);
  EXPECT_EQ(dvi("audit telea drive second --quiet").code, 0);
  EXPECT_EQ(dvi("audit telea drive --quiet").code, 3);
}

}  // namespace
}  // namespace dvi
