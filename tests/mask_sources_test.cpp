#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/media/image_file.h"
#include "program.h"

namespace dvi {
namespace {

using testing::HasSubstr;

/// A drive with masks, labels, and scans.
class MaskSourcesOption : public ProgramTest {
 protected:
  void SetUp() override { small_drive(); }

  nlohmann::json json(const fs::path& file) const { return nlohmann::json::parse(read_file(folder / file)); }

  std::vector<cv::Mat1b> mask(const std::string& name, const std::string& options) const {
    const Result result = dvi("mask drive -o " + name + " --poses given --quiet " + options);
    EXPECT_EQ(result.code, 0) << result.err;
    std::vector<cv::Mat1b> out;
    for (const fs::path& file : list_files(folder / name / "masks/front", {".png"}))
      out.push_back(media::read_mask(file, kSize));
    EXPECT_EQ(out.size(), 6U);
    return out;
  }
};

TEST_F(MaskSourcesOption, TheUnionIsRemoved) {
  const std::string given = " --set objects.complete=false";
  const auto files = mask("files", "--masks auto" + given), labels = mask("labels", "--masks labels" + given);
  const auto found = mask("found", "--masks found" + given);
  const auto all = mask("all", "--masks found --masks auto --masks labels" + given);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const cv::Mat1b parts(files[i] | labels[i] | found[i]);
    EXPECT_EQ(cv::countNonZero(parts & ~all[i]), 0) << i;
    EXPECT_LT(cv::countNonZero(all[i] & ~parts), 0.01 * static_cast<double>(parts.total())) << i << ": shadows of united masks";
  }
  EXPECT_EQ(json("all/masks.json").at("source"), "files, labels, found");
  EXPECT_EQ(json("found/masks.json").at("source"), "found");
}

TEST_F(MaskSourcesOption, ARunStatesTheSourcesOfEachObjectAndPassesTheAudit) {
  const Result run = dvi("run drive -o out --poses given --masks labels --masks found");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(json("out/report.json").at("drives")[0].at("masks"), "labels, found");
  const nlohmann::json list = json("out/objects.json").at("objects");
  std::map<std::string, int> objects;
  for (const nlohmann::json& object : list) {
    ++objects[object.at("evidence").get<std::string>()];
    if (object.at("evidence") == "found") {
      EXPECT_EQ(object.at("motion"), "moving");
    }
  }
  EXPECT_GT(objects["labels"], 0);
  EXPECT_EQ(objects["labels"] + objects["found"], static_cast<int>(list.size()));
  EXPECT_EQ(dvi("audit out drive --quiet").code, 0);
  EXPECT_THAT(dvi("run --config out/dvi.toml").err, HasSubstr("nothing to do"));
}

TEST_F(MaskSourcesOption, BadSourcesAreRefusedWithOneLine) {
  for (const char* command : {"run", "mask"}) {
    const Result none = dvi(std::string(command) + " drive -o out --masks none --quiet");
    EXPECT_EQ(none.code, 2);
    EXPECT_THAT(none.err, HasSubstr("--masks none removes nothing: give --detector MODEL.onnx, or masks"));
  }
  const Result both = dvi("mask drive -o out --quiet --masks white:drive/masks --masks black:drive/masks");
  EXPECT_EQ(both.code, 2);
  EXPECT_THAT(both.err, HasSubstr("contradict each other"));
  EXPECT_THAT(dvi("check drive --quiet --masks labels --masks auto").out, HasSubstr("from files, labels"));
  EXPECT_THAT(dvi("check drive --quiet --masks labels --masks found").out, HasSubstr("dvi run also finds moving objects"));
}

}  // namespace
}  // namespace dvi
