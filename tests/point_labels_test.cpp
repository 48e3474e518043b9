#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/media/image_file.h"
#include "program.h"

namespace dvi {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A drive with exact labels of its points.
class PointLabelsOption : public ProgramTest {
 protected:
  void SetUp() override { small_drive(); }

  nlohmann::json json(const fs::path& file) const { return nlohmann::json::parse(read_file(folder / file)); }
};

TEST_F(PointLabelsOption, MaskTheTrafficThatTheyShow) {
  const Result mask = dvi("mask drive -o masks --poses given --quiet --masks drive/truth_points");
  ASSERT_EQ(mask.code, 0) << mask.err;
  EXPECT_EQ(json("masks/masks.json").at("source"), "points");
  double covered = 0, traffic = 0, masked = 0;
  for (const fs::path& file : list_files(folder / "masks/masks/front", {".png"})) {
    const cv::Mat1b found = media::read_mask(file, kSize);
    const cv::Mat1b truth = media::read_mask(folder / "drive/masks/front" / file.filename(), kSize);
    covered += cv::countNonZero(found & truth);
    traffic += cv::countNonZero(truth);
    masked += cv::countNonZero(found);
  }
  EXPECT_GT(covered, 0.8 * traffic);
  EXPECT_LT(masked, 1.7 * traffic);
}

TEST_F(PointLabelsOption, ARunWithThemPassesTheAudit) {
  const Result run = dvi("run drive -o out --poses given --quiet --masks drive/truth_points --masks labels");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(json("out/report.json").at("drives")[0].at("masks"), "labels, points");
  const nlohmann::json objects = json("out/objects.json").at("objects");
  EXPECT_TRUE(std::any_of(objects.begin(), objects.end(), [](const nlohmann::json& object) {
    return object.at("evidence") == "points" && object.at("motion") == "moving" && object.at("class") == "car";
  })) << objects;
  EXPECT_EQ(dvi("audit out drive --quiet").code, 0);
  write_file(folder / "drive/truth_points/000000.label", std::string(8, '\0'));
  const Result changed = dvi("run --config out/dvi.toml --quiet");
  EXPECT_EQ(changed.code, 3);
  EXPECT_THAT(changed.err, AllOf(HasSubstr("has 2 labels, but its scan has"), HasSubstr("000000.label")));
}

TEST_F(PointLabelsOption, NeedScans) {
  fs::remove_all(folder / "drive/lidar");
  fs::remove(folder / "drive/poses.txt");
  const Result result = dvi("mask drive -o out --quiet --masks drive/truth_points");
  EXPECT_EQ(result.code, 3);
  EXPECT_THAT(result.err, HasSubstr("the drive has no scans"));
}

}  // namespace
}  // namespace dvi
