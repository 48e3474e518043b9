#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/drive/outline.h"
#include "dvi/image/region.h"
#include "dvi/media/image_file.h"
#include "dvi/media/write_image.h"
#include "program.h"

namespace dvi {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// Runs with masks of other programs.
class GivenMasks : public ProgramTest {
 protected:
  GivenMasks() {
    small_drive();
    for (const fs::path& file : list_files(folder / "drive/masks/front", {".png"}))
      own.push_back(media::read_mask(file, kSize));
  }

  std::string name(std::size_t i) const { return fmt::format("{:06}", i); }

  cv::Mat1b result(const std::string& out, std::size_t i) const {
    const fs::path folders = fs::exists(folder / out / "masks/front") ? folder / out / "masks/front" : folder / out / "masks";
    return media::read_mask(folders / (name(i) + ".png"), kSize);
  }

  static int differing(const cv::Mat1b& a, const cv::Mat1b& b) { return cv::countNonZero(cv::Mat1b(a != b)); }

  /// Writes each of the drive's masks as a COCO annotation.
  fs::path coco() const {
    nlohmann::json images = nlohmann::json::array(), annotations = nlohmann::json::array();
    for (std::size_t i = 0; i < own.size(); ++i) {
      images.push_back({{"id", i}, {"file_name", "export/" + name(i) + ".jpg"}, {"width", 240}, {"height", 136}});
      annotations.push_back({{"id", 100 + i},
                             {"image_id", i},
                             {"category_id", 3},
                             {"iscrowd", 1},
                             {"segmentation", {{"size", {136, 240}}, {"counts", to_outline(own[i]).runs}}}});
    }
    write_file(folder / "coco.json",
               nlohmann::json{{"images", images}, {"categories", {{{"id", 3}, {"name", "car"}}}}, {"annotations", annotations}}
                   .dump());
    return folder / "coco.json";
  }

  std::vector<cv::Mat1b> own;
  const std::string exactly =
      " --quiet --poses given --set masks.shadows=false --set masks.dilate_px=0 --set objects.complete=false ";
};

TEST_F(GivenMasks, RunReadsCoco) {
  coco();
  EXPECT_THAT(dvi("check drive --masks coco.json --quiet").out, HasSubstr("from labels (6 car)"));
  const Result run = dvi("run drive -o out --masks coco.json" + exactly);
  ASSERT_EQ(run.code, 0) << run.err;
  for (std::size_t i = 0; i < own.size(); ++i) EXPECT_EQ(differing(result("out", i), own[i]), 0) << i;
  EXPECT_EQ(dvi("audit out drive --quiet").code, 0);
  EXPECT_EQ(dvi("mask drive -o cars --masks coco.json --classes car" + exactly).code, 0);
  EXPECT_EQ(differing(result("cars", 1), own[1]), 0);
  const Result trucks = dvi("mask drive -o none --masks coco.json --classes truck" + exactly);
  EXPECT_EQ(trucks.code, 2);
  EXPECT_THAT(trucks.err, HasSubstr("no label has the class 'truck'; the classes are car"));
}

TEST_F(GivenMasks, RunReadsCvat) {
  write_file(
      folder / "annotations.xml",
      "<annotations><meta><task><size>6</size></task></meta><track id=\"0\" label=\"car\">"
      "<box frame=\"1\" outside=\"0\" keyframe=\"1\" xtl=\"20\" ytl=\"40\" xbr=\"60\" ybr=\"80\"/>"
      "<box frame=\"5\" outside=\"0\" keyframe=\"1\" xtl=\"60\" ytl=\"44\" xbr=\"100\" ybr=\"84\"/></track></annotations>");
  const Result run = dvi("run drive -o out --masks annotations.xml" + exactly);
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(cv::countNonZero(result("out", 0)), 0);
  for (std::size_t i = 1; i < 6; ++i) {
    const int step = static_cast<int>(i) - 1;
    cv::Mat1b box(kSize, uchar{0});
    box(cv::Rect(20 + 10 * step, 40 + step, 40, 40)) = 255;
    EXPECT_EQ(differing(result("out", i), box), 0) << i;
  }
  EXPECT_EQ(dvi("audit out drive --quiet").code, 0);
}

TEST_F(GivenMasks, BlackCanMeanRemove) {
  make_folder(folder / "colmap");
  for (std::size_t i = 0; i < own.size(); ++i)
    media::write_png(folder / ("colmap/" + name(i) + ".jpg.png"), cv::Mat1b(~own[i]));
  const Result mask = dvi("mask drive -o masks --masks colmap --poses given --set masks.shadows=false");
  ASSERT_EQ(mask.code, 0) << mask.err;
  EXPECT_THAT(mask.err, AllOf(HasSubstr("black means remove"), HasSubstr("--polarity white")));
  for (std::size_t i = 0; i < own.size(); ++i) EXPECT_EQ(differing(result("masks", i), own[i]), 0) << i;
  ASSERT_EQ(dvi("mask drive -o white --masks colmap --polarity white" + exactly).code, 0);
  EXPECT_EQ(differing(result("white", 2), cv::Mat1b(~own[2])), 0);
}

TEST_F(GivenMasks, AnEgoMaskIsPartOfEveryMask) {
  cv::Mat1b ego(kSize, uchar{0});
  ego.rowRange(120, 136) = 255;
  media::write_png(folder / "ego.png", ego);
  const std::string run = "run drive -o out --ego-mask ego.png" + exactly;
  const Result first = dvi(run);
  ASSERT_EQ(first.code, 0) << first.err;
  for (std::size_t i = 0; i < own.size(); ++i) EXPECT_EQ(differing(result("out", i), cv::Mat1b(own[i] | ego)), 0) << i;
  const Result audit = dvi("audit out drive --quiet");
  EXPECT_EQ(audit.code, 0) << audit.out;
  ego.rowRange(110, 120) = 255;
  media::write_png(folder / "ego.png", ego);
  ASSERT_EQ(dvi(run).code, 0);
  EXPECT_EQ(differing(result("out", 3), cv::Mat1b(own[3] | ego)), 0) << "it is an input of the run";
  media::write_png(folder / "ego.png", cv::Mat1b(ego.rowRange(0, 100)));
  const Result small = dvi(run);
  EXPECT_EQ(small.code, 3);
  EXPECT_THAT(small.err, HasSubstr("ego.png: is 240x100 pixels instead of 240x136"));
}

TEST_F(GivenMasks, AFolderWithASubfolderPerCameraIsRead) {
  ASSERT_EQ(dvi("mask drive -o masks --masks drive/masks" + exactly).code, 0);
  for (std::size_t i = 0; i < own.size(); ++i) EXPECT_EQ(differing(result("masks", i), own[i]), 0) << i;
}

TEST_F(GivenMasks, ChangedNamesAreMatched) {
  make_folder(folder / "odm");
  make_folder(folder / "short");
  make_folder(folder / "from1");
  for (std::size_t i = 0; i < own.size(); ++i) {
    media::write_png(folder / ("odm/" + name(i) + "_mask.png"), own[i]);
    media::write_png(folder / fmt::format("short/{}.png", i), own[i]);
    media::write_png(folder / ("from1/" + name(i + 1) + ".png"), own[i]);
  }
  for (const char* masks : {"odm", "short"}) {
    const Result mask = dvi(fmt::format("mask drive -o of_{0} --masks {0} --poses given --set masks.shadows=false", masks));
    ASSERT_EQ(mask.code, 0) << mask.err;
    EXPECT_THAT(mask.err, HasSubstr("names are matched by"));
    for (std::size_t i = 0; i < own.size(); ++i) EXPECT_EQ(differing(result(fmt::format("of_{}", masks), i), own[i]), 0) << i;
  }
  const Result from1 = dvi("check drive --masks from1 --quiet");
  EXPECT_EQ(from1.code, 3);
  EXPECT_THAT(from1.err,
              AllOf(HasSubstr("its names are 000001 to 000006, but those of the drive's images are 000000 to 000005"),
                    HasSubstr("remove 000006")));
}

TEST_F(GivenMasks, MaskFilesAreDilatedIfRequested) {
  const Result mask =
      dvi("mask drive -o masks --masks drive/masks --poses given --set masks.shadows=false --set masks.dilate_px=3");
  ASSERT_EQ(mask.code, 0) << mask.err;
  EXPECT_THAT(mask.err, HasSubstr("mask files are dilated by 3 px"));
  EXPECT_EQ(nlohmann::json::parse(read_file(folder / "masks/masks.json"))["dilate_px"], 3);
  for (std::size_t i = 0; i < own.size(); ++i) EXPECT_EQ(differing(result("masks", i), grown(own[i], 3)), 0) << i;
  ASSERT_EQ(dvi("mask drive -o plain --masks drive/masks --quiet --poses given --set masks.shadows=false").code, 0);
  EXPECT_EQ(differing(result("plain", 0), own[0]), 0) << "not unless asked";
  EXPECT_EQ(dvi("mask drive -o half --masks drive/masks --set masks.dilate_px=2.5").code, 2);
}

TEST_F(GivenMasks, EmptyMasksCauseAWarning) {
  small_drive("long", "", 16);
  fs::remove(folder / "long/boxes.json");
  for (const fs::path& file : list_files(folder / "long/masks/front", {".png"}))
    media::write_png(file, cv::Mat1b(kSize, uchar{0}));
  const std::string nothing = "its 16 mask files are empty and remove nothing, but its scans show ";
  const Result check = dvi("check long --poses given");
  EXPECT_EQ(check.code, 0) << "a recording may have no traffic";
  EXPECT_THAT(check.out, AllOf(HasSubstr("warning  " + nothing), HasSubstr("give --masks found")));
  EXPECT_THAT(dvi("mask long -o masks --poses given").err, HasSubstr(nothing));
  EXPECT_THAT(dvi("run long -o out --poses given").err, HasSubstr(nothing));
  EXPECT_THAT(read_file(folder / "out/report.json"), HasSubstr(nothing));
  const Result found = dvi("mask long -o found --masks found --poses given --json --quiet");
  ASSERT_EQ(found.code, 0) << found.err;
  EXPECT_EQ(nlohmann::json::parse(found.out)["source"], "found");
  fs::remove_all(folder / "long/masks");
  write_file(folder / "long/boxes.json", R"({"version":1,"frames":{}})");
  EXPECT_THAT(dvi("check long --poses given --quiet").out,
              HasSubstr("warning  its labels (0 in 16 frames) remove nothing, but"));
}

TEST_F(GivenMasks, CheckFailsIfARunIsNotPossible) {
  for (const char* name : {"lidar", "masks", "times", "boxes.json"}) fs::remove_all(folder / "drive" / name);
  std::string poses,
      map = "ply\nformat ascii 1.0\nelement vertex 400\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  for (int i = 0; i < 6; ++i) poses += fmt::format("1 0 0 0 0 1 0 0 0 0 1 {}\n", 0.5 * i);
  for (int i = 0; i < 400; ++i) map += fmt::format("{} 1 {}\n", i % 20 - 10, 5 + i / 20);
  write_file(folder / "drive/poses.txt", poses);
  write_file(folder / "drive/map.ply", map);
  write_file(folder / "drive/dvi.toml",
             "[drive]\nversion = 1\n[camera.front]\nsize = [240, 136]\nK = [192, 0, 119.5, 0, 192, 67.5, 0, 0, 1]\n");
  const Result check = dvi("check drive --quiet");
  EXPECT_EQ(check.code, 3) << check.err;
  EXPECT_THAT(check.out,
              AllOf(HasSubstr("neither masks, labels, nor scans show the objects to remove"), HasSubstr("not ready")));
  EXPECT_THAT(check.err, HasSubstr("is not ready for dvi run"));
  const Result as_json = dvi("check drive --quiet --json");
  EXPECT_EQ(as_json.code, 3);
  EXPECT_EQ(nlohmann::json::parse(as_json.out)["ready"], false);
}

}  // namespace
}  // namespace dvi
