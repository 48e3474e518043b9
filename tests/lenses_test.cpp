#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/core/files.h"
#include "dvi/media/image_file.h"
#include "program.h"

namespace dvi {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Cleans drives of cameras with other lenses than a pinhole.
class Lenses : public ProgramTest {
 protected:
  fs::path drive_of(const std::string& lens) const {
    if (lens != "panorama") return small_drive("drive", "--lens " + lens);
    const Result made =
        dvi("synth -o drive --frames 6 --width 480 --height 240 --beams 32 --columns 900 --lens panorama --quiet");
    EXPECT_EQ(made.code, 0) << made.err;
    return folder / "drive";
  }
  nlohmann::json evaluate(const std::string& out) const {
    const Result scored = dvi("eval " + out + " --truth drive/truth --json");
    EXPECT_EQ(scored.code, 0) << scored.err;
    return nlohmann::json::parse(scored.out);
  }
};

class EachLens : public Lenses, public testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(, EachLens, testing::Values("fisheye", "unified", "panorama"),
                         [](const auto& each) { return std::string(each.param); });

TEST_P(EachLens, IsFilledWithTheTruth) {
  drive_of(GetParam());
  const Result run = dvi("run drive -o out --quiet");
  ASSERT_EQ(run.code, 0) << run.err;
  const nlohmann::json scores = evaluate("out"), copied = scores.at("copied");
  EXPECT_GT(copied.at("psnr").get<double>(), 26) << copied;
  EXPECT_GT(copied.at("share").get<double>(), 0.05);
  EXPECT_EQ(dvi("audit out drive").code, 0);
}

TEST_P(EachLens, GivesTheSameBytesWithAnyNumberOfThreads) {
  drive_of(GetParam());
  for (const char* threads : {"1", "2"})
    ASSERT_EQ(dvi(fmt::format("run drive -o out{0} --threads {0} --quiet", threads)).code, 0);
  EXPECT_TRUE(contents(folder / "out1/frames") == contents(folder / "out2/frames"));
  EXPECT_TRUE(contents(folder / "out1/provenance") == contents(folder / "out2/provenance"));
}

TEST_P(EachLens, IsConvertedAndReadAgain) {
  drive_of(GetParam());
  ASSERT_EQ(dvi("convert drive -o copy --quiet").code, 0);
  EXPECT_THAT(read_file(folder / "copy/dvi.toml"),
              HasSubstr(fmt::format("model = \"{}\"", GetParam() == std::string("panorama") ? "equirectangular" : GetParam())));
  for (const char* drive : {"drive", "copy"})
    ASSERT_EQ(dvi(fmt::format("run {0} --frames 0:2 --poses given -o out-{0} --quiet", drive)).code, 0);
  EXPECT_TRUE(contents(folder / "out-drive/frames") == contents(folder / "out-copy/frames"));
}

TEST_F(Lenses, RemoveBoxesBehindTheImagePlane) {
  drive_of("panorama");
  fs::remove_all(folder / "drive/masks");
  // A car right behind the camera is at both edges of the panorama.
  std::string boxes;
  for (int i = 0; i < 6; ++i)
    boxes += fmt::format(R"({}"{:06}":[{{"track":1,"class":"car","center":[-9,0,-1],"size":[4,1.8,1.5],"yaw":0}}])",
                         i == 0 ? "" : ",", i);
  write_file(folder / "drive/boxes.json", R"({"version":1,"frames":{)" + boxes + "}}");
  ASSERT_EQ(dvi("run drive -o out --masks labels --set masks.shadows=false --quiet").code, 0);
  const cv::Mat1b mask = media::read_png_gray(folder / "out/masks/000003.png", {480, 240});
  EXPECT_GT(cv::countNonZero(mask.colRange(0, 20)), 100);
  EXPECT_GT(cv::countNonZero(mask.colRange(460, 480)), 100);
  EXPECT_EQ(cv::countNonZero(mask.colRange(60, 420)), 0);
}

TEST_F(Lenses, AreExportedInTheTermsOfTheFormat) {
  drive_of("fisheye");
  ASSERT_EQ(dvi("run drive --frames 0:2 --poses given -o out --quiet").code, 0);
  for (const char* format : {"colmap", "nerfstudio", "mcap"})
    ASSERT_EQ(dvi(fmt::format("export {0} out -o {0}", format)).code, 0) << format;
  EXPECT_THAT(read_file(folder / "colmap/sparse/0/cameras.txt"), HasSubstr("1 OPENCV_FISHEYE 240 136"));
  EXPECT_THAT(read_file(folder / "nerfstudio/transforms.json"), HasSubstr("\"OPENCV_FISHEYE\""));
  EXPECT_THAT(read_file(folder / "mcap/drive.mcap"), HasSubstr("equidistant"));
}

TEST_F(Lenses, WithoutAModelInTheFormatAreRefused) {
  drive_of("unified");
  ASSERT_EQ(dvi("run drive --frames 0:2 --poses given -o out --quiet").code, 0);
  for (const char* format : {"colmap", "nerfstudio"}) {
    const Result refused = dvi(fmt::format("export {0} out -o {0}", format));
    EXPECT_EQ(refused.code, 3);
    EXPECT_FALSE(fs::exists(folder / format));
  }
  EXPECT_THAT(dvi("export colmap out -o colmap").err, HasSubstr("COLMAP has no unified cameras, as front is"));
}

}  // namespace
}  // namespace dvi
