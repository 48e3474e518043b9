#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/media/image_file.h"
#include "dvi/media/write_image.h"
#include "dvi/testing/test_models.h"
#include "program.h"

namespace dvi {
namespace {

using testing::HasSubstr;

/// A drive without masks and labels, with a magenta rectangle in its frames.
class DetectorOption : public ProgramTest {
 protected:
  void SetUp() override {
    if (!make_test_models(folder)) GTEST_SKIP() << "takes a Python with onnx (Debian's python3-onnx)";
    write_file(folder / "semantic.toml", test_description(true));
    write_file(folder / "classifier.toml", test_description(false));
    paint("drive");
  }
  static cv::Rect at(std::size_t frame) { return {30 + 8 * static_cast<int>(frame), 60, 40, 30}; }

  void paint(const std::string& name, const std::string& options = "") const {
    const fs::path drive = small_drive(name, options);
    fs::remove_all(drive / "masks");
    fs::remove(drive / "boxes.json");
    const std::vector<fs::path> images = list_files(drive / "images/front", {".png"});
    ASSERT_EQ(images.size(), 6U);
    for (std::size_t i = 0; i < images.size(); ++i) {
      if (i == 3) continue;  // a missed detection
      cv::Mat3b image = media::read_image(images[i], kSize);
      image(at(i)) = cv::Vec3b(255, 0, 255);
      media::write_png(images[i], image);
    }
  }
  nlohmann::json json(const fs::path& file) const { return nlohmann::json::parse(read_file(folder / file)); }
};

TEST_F(DetectorOption, MasksDetectedObjectsInEveryFrame) {
  const Result mask =
      dvi("mask drive -o masks --detector semantic.onnx --masks none --poses given --quiet --set masks.shadows=false");
  ASSERT_EQ(mask.code, 0) << mask.err;
  const nlohmann::json masks = json("masks/masks.json");
  EXPECT_EQ(masks.at("source"), "detector");
  ASSERT_EQ(masks.at("tracks").size(), 1U) << masks.at("tracks");
  EXPECT_EQ(masks.at("tracks")[0].at("type"), "car");
  EXPECT_EQ(masks.at("tracks")[0].at("frames"), 6);
  const std::vector<fs::path> files = list_files(folder / "masks/masks/front", {".png"});
  ASSERT_EQ(files.size(), 6U);
  for (std::size_t i = 0; i < files.size(); ++i) {
    const cv::Mat1b detected = media::read_mask(files[i], kSize);
    EXPECT_EQ(cv::countNonZero(detected(at(i))), at(i).area()) << i;
    EXPECT_LT(cv::countNonZero(detected), 3 * at(i).area()) << i;
  }
}

TEST_F(DetectorOption, ARunPassesTheAudit) {
  const std::string arguments = "run drive -o out --detector semantic.onnx --poses given --quiet --threads ";
  const Result run = dvi(arguments + "1");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_GE(json("out/report.json").at("hole").at("pixels").get<int>(), 6 * at(0).area());
  const auto first = contents(folder / "out/frames");
  fs::remove_all(folder / "out");
  ASSERT_EQ(dvi(arguments + "4").code, 0);
  EXPECT_EQ(contents(folder / "out/frames"), first);
  EXPECT_THAT(dvi("run --config out/dvi.toml").err, HasSubstr("nothing to do"));

  fs::rename(folder / "semantic.onnx", folder / "moved.onnx");
  EXPECT_EQ(dvi("audit out drive --quiet").code, 0) << "takes no network";
  fs::rename(folder / "moved.onnx", folder / "semantic.onnx");
  write_file(folder / "semantic.toml", test_description(true) + "remove = [\"person\"]\n");
  const Result other = dvi("run drive -o out --detector semantic.onnx --poses given");
  EXPECT_EQ(other.code, 0) << other.err;
  EXPECT_THAT(other.err, HasSubstr("the detector finds no object to remove")) << "its description is an input, too";
}

TEST_F(DetectorOption, WorksWithoutScansAndWithSourceDrives) {
  paint("second");
  fs::remove_all(folder / "drive/lidar");
  fs::remove(folder / "drive/poses.txt");
  const Result telea = dvi("run drive -o telea --method telea --detector semantic.onnx --quiet");
  EXPECT_EQ(telea.code, 0) << telea.err;
  EXPECT_EQ(dvi("audit telea drive --quiet").code, 0);
  paint("third", "--day 2");
  const Result both = dvi("run second third -o both --detector semantic.onnx --poses given --remove moving");
  EXPECT_EQ(both.code, 0) << both.err;
  EXPECT_THAT(both.err, HasSubstr("third: --remove moving: a detector does not show which objects are stationary"));
  EXPECT_EQ(dvi("audit both second third --quiet").code, 0);
  EXPECT_THAT(dvi("check second --detector semantic.onnx --poses given --quiet").out, HasSubstr("from detector"));
}

TEST_F(DetectorOption, RefusesBadModelsWithOneLine) {
  const auto refused = [&](const std::string& arguments, int code) {
    const Result result = dvi("mask drive -o masks --quiet " + arguments);
    EXPECT_EQ(result.code, code) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    return result.err;
  };
  EXPECT_THAT(refused("--detector classifier.onnx", 3), HasSubstr("is a classifier"));
  EXPECT_THAT(refused("--detector ids.onnx", 3), HasSubstr("has no names of its classes in its metadata"));
  EXPECT_THAT(refused("--detector nowhere.onnx", 3), HasSubstr("nowhere.onnx"));
  EXPECT_THAT(refused("--detector semantic.toml", 3), HasSubstr("is not an ONNX file"));
  EXPECT_THAT(refused("--masks none", 2), HasSubstr("--masks none removes nothing: give --detector MODEL.onnx, or masks"));
}

}  // namespace
}  // namespace dvi
