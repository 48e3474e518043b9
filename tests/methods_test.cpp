// Runs the baselines and the coverage estimate of the program.

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/media/image_file.h"
#include "dvi/media/write_image.h"
#include "program.h"

namespace dvi {
namespace {

using testing::HasSubstr;

class Methods : public ProgramTest {
 protected:
  nlohmann::json json(const std::string& file) const { return nlohmann::json::parse(read_file(folder / file)); }

  void expect_whole_result(const std::string& out) const {
    for (const fs::path& input : list_files(folder / "drive/images/front", {".png"})) {
      const std::string name = input.filename();
      const cv::Mat1b kind = media::read_png_gray(folder / out / "kind" / name, kSize);
      const cv::Mat1b mask = media::read_png_gray(folder / out / "masks" / name, kSize);
      const cv::Mat3b original = media::read_image(input, kSize),
                      filled = media::read_image(folder / out / "frames" / name, kSize);
      EXPECT_EQ(cv::countNonZero(media::read_png_depth(folder / out / "depth" / name, kSize)), 0);
      const cv::Mat_<cv::Vec3w> provenance = media::read_png_triples(folder / out / "provenance" / name, kSize);
      for (int y = 0; y < kSize.height; ++y)
        for (int x = 0; x < kSize.width; ++x) {
          ASSERT_EQ(kind(y, x) == 0, mask(y, x) == 0);
          if (mask(y, x) == 0) {
            ASSERT_EQ(filled(y, x), original(y, x));
          }
          ASSERT_TRUE(kind(y, x) == 0 || kind(y, x) == 1 || kind(y, x) == 3);
          ASSERT_EQ(provenance(y, x)[0] > 0, kind(y, x) == 1);
        }
    }
    for (const char* file : {"sources.json", "video.mp4", "compare.mp4", "contact.png", "report.json", "dvi.toml"})
      EXPECT_TRUE(fs::exists(folder / out / file)) << file;
    EXPECT_FALSE(fs::exists(folder / out / "map"));
  }
};

TEST_F(Methods, BaselinesFillADriveWithoutPosesAndScans) {
  small_drive();
  fs::remove(folder / "drive/poses.txt");
  fs::remove_all(folder / "drive/lidar");
  for (const std::string method : {"telea", "ns", "flow"}) {
    const Result result = dvi("run drive -o " + method + " --quiet --method " + method);
    ASSERT_EQ(result.code, 0) << result.err;
    expect_whole_result(method);
    const nlohmann::json report = json(method + "/report.json");
    EXPECT_EQ(report["method"], method);
    EXPECT_EQ(report["baseline"], true);
    EXPECT_TRUE(report["map"].is_null());
    EXPECT_EQ(report["hole"]["share"]["copied"] > 0, method == "flow");
    EXPECT_EQ(dvi("eval " + method + " --truth drive/truth --quiet").code, 0);
  }
}

TEST_F(Methods, BaselinesWriteTheSameBytesWithAnyNumberOfThreads) {
  small_drive();
  ASSERT_EQ(dvi("run drive -o one --method flow --threads 1 --quiet").code, 0);
  ASSERT_EQ(dvi("run drive -o two --method flow --threads 2 --quiet").code, 0);
  EXPECT_TRUE(contents(folder / "one") == contents(folder / "two"));
}

TEST_F(Methods, AFolderCanBeRunWithAnotherMethod) {
  small_drive();
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  EXPECT_EQ(json("out/report.json")["baseline"], false);
  ASSERT_EQ(dvi("run drive -o out --quiet --method telea").code, 0);
  expect_whole_result("out");
  EXPECT_THAT(dvi("run drive -o out --method telea").err, HasSubstr("nothing to do"));
  ASSERT_EQ(dvi("run --config out/dvi.toml -o again --quiet").code, 0);
  EXPECT_TRUE(contents(folder / "out") == contents(folder / "again"));
}

TEST_F(Methods, BaselinesDoNotUseSourceDrives) {
  small_drive();
  small_drive("other", "--day 2");
  const Result result = dvi("run drive other -o out --method flow");
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("source drives"));
  EXPECT_EQ(json("out/report.json")["drives"].size(), 1);
}

TEST_F(Methods, RemovingMovingObjectsNeedsPosesAndLabels) {
  small_drive();
  fs::remove(folder / "drive/poses.txt");
  const std::string run = "run drive --method telea --remove moving ";
  EXPECT_THAT(dvi(run + "--masks labels -o unposed").err,
              HasSubstr("without poses it is unknown which objects are stationary"));
  EXPECT_THAT(dvi(run + "--masks drive/masks/front -o files").err,
              HasSubstr("mask files do not show which objects are stationary"));
  small_drive("posed");
  EXPECT_THAT(dvi("run posed --method telea --remove moving --masks labels -o out").err,
              testing::Not(HasSubstr("which objects are stationary")));
}

TEST_F(Methods, AnUnknownMethodIsRefusedWithTheList) {
  small_drive();
  const Result result = dvi("run drive -o out --method magic");
  EXPECT_EQ(result.code, 2);
  for (const char* method : {"dvi", "paper", "flow", "telea", "ns"}) EXPECT_THAT(result.err, HasSubstr(method));
}

TEST_F(Methods, OnlyBaselinesRunWithoutPosesAndScans) {
  small_drive();
  fs::remove(folder / "drive/poses.txt");
  fs::remove_all(folder / "drive/lidar");
  const Result check = dvi("check drive --quiet");
  EXPECT_EQ(check.code, 3);
  EXPECT_THAT(check.out, testing::AllOf(HasSubstr("unknown: no poses"), HasSubstr("--method flow, telea, and ns only need")));
  EXPECT_EQ(dvi("check drive --method telea --quiet").code, 0) << "ready for a baseline";
  EXPECT_EQ(dvi("check drive --method telea --masks none --quiet").code, 3) << "without masks";
  for (const char* command : {"run drive -o out --method paper", "map drive -o out --method telea", "forecast drive -o out"}) {
    const Result result = dvi(std::string(command) + " --quiet");
    EXPECT_EQ(result.code, 3) << command;
    EXPECT_THAT(result.err, HasSubstr("--poses"));
    EXPECT_FALSE(fs::exists(folder / "out")) << command;
  }
}

TEST_F(Methods, ForecastAgreesWithTheRun) {
  small_drive("one", "--truck");
  small_drive("two", "--truck --day 2");
  for (const std::string drives : {"one", "one two"}) {
    const Result result = dvi("forecast " + drives + " -o chart --json --quiet");
    ASSERT_EQ(result.code, 0) << result.err;
    const nlohmann::json forecast = nlohmann::json::parse(result.out);
    ASSERT_EQ(dvi("run " + drives + " -o out --force --quiet").code, 0);
    const nlohmann::json report = json("out/report.json");
    EXPECT_NEAR(forecast["hole"]["unobserved"].get<double>(), report["hole"]["share"]["unobserved"].get<double>(), 0.03)
        << drives;
    EXPECT_NEAR(forecast["hole"]["copied_elsewhere"].get<double>(), report["hole"]["share"]["copied_elsewhere"].get<double>(),
                0.03);
    ASSERT_EQ(forecast["frames"].size(), report["frames"].size());
    for (std::size_t i = 0; i < forecast["frames"].size(); ++i)
      EXPECT_EQ(forecast["frames"][i]["name"], report["frames"][i]["name"]);
    EXPECT_TRUE(fs::exists(folder / "chart/forecast.png"));
  }
  EXPECT_THAT(dvi("forecast one --quiet").out, HasSubstr("unobserved"));
}

TEST_F(Methods, CheckEstimatesTheCoverage) {
  small_drive();
  EXPECT_THAT(dvi("check drive --coverage --quiet").out, HasSubstr("of the hole is observed by sources"));
  const nlohmann::json checked = nlohmann::json::parse(dvi("check drive --coverage --quiet --json").out);
  EXPECT_EQ(checked["coverage"], nlohmann::json::parse(dvi("forecast drive --quiet --json").out));
  fs::remove(folder / "drive/poses.txt");
  fs::remove_all(folder / "drive/lidar");
  const Result unposed = dvi("check drive --coverage --quiet");
  EXPECT_EQ(unposed.code, 3) << "it is not ready";
  EXPECT_THAT(unposed.out, testing::Not(HasSubstr("coverage")));
}

}  // namespace
}  // namespace dvi
