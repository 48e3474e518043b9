#include "dvi/result/run_report.h"

#include <unistd.h>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "dvi/core/files.h"

namespace dvi::result {
namespace {

using nlohmann::json;
using testing::HasSubstr, testing::Not;

json whole_report() {
  const HoleReport hole{.pixels = 100, .copied = 60, .copied_elsewhere = 10, .interpolated = 25, .synthesized = 0, .empty = 5};
  const CostReport cost{{{"map", 2, 3}, {"fill", 5, 9}}, {{"depth", 1.5}}, 2, 123'000'000};
  return {{"schema", RunReport::kSchema},
          {"drives", {{{"path", "/a/sunday"}, {"registration", {{"overlap", 1}, {"bound_m", 0.029}, {"bound_deg", 0.08}}}}}},
          {"hole", hole},
          {"objects", {{"removed", 5}, {"completed", 2}, {"completed_frames", 1}}},
          {"stationary", {{"tracks", 5}, {"stationary", 4}, {"pixels", 80}}},
          {"cost", cost},
          {"frames", {{{"name", "0003"}, {"hole", hole}}}}};
}

class ReportFile : public testing::Test {
 protected:
  ReportFile() : file(fs::path(testing::TempDir()) / ("report_" + std::to_string(getpid()) + ".json")) {}
  ~ReportFile() override { fs::remove(file); }
  fs::path file;
};

TEST(HoleReport, SharesSumToOne) {
  const HoleReport hole{
      .pixels = 200, .copied = 100, .copied_elsewhere = 20, .interpolated = 50, .synthesized = 10, .empty = 20};
  const json share = json(hole).at("share");
  EXPECT_DOUBLE_EQ(share.at("copied"), 0.5);
  EXPECT_DOUBLE_EQ(share.at("unobserved"), 0.4);
  EXPECT_DOUBLE_EQ(
      share.at("copied").get<double>() + share.at("copied_elsewhere").get<double>() + share.at("unobserved").get<double>(), 1);
  HoleReport sum = hole;
  sum += hole;
  EXPECT_EQ(sum.pixels, 400U);
  EXPECT_DOUBLE_EQ(json(sum).at("share").at("empty"), share.at("empty"));
}

TEST(HoleReport, AFrameWithoutAHoleHasNoShares) { EXPECT_EQ(json(HoleReport{}).at("share").at("unobserved"), 0.0); }

TEST(HoleReport, CountsPixelsByKind) {
  const cv::Mat1b kind = (cv::Mat1b(2, 4) << 0, 0, 1, 1, 2, 3, 4, 5);
  const HoleReport hole = count_hole(kind);
  EXPECT_EQ(hole.pixels, 6U);
  EXPECT_EQ(hole.copied, 2U);
  EXPECT_EQ(hole.copied_elsewhere, 1U);
  EXPECT_EQ(hole.unobserved(), 3U);
}

TEST(HoleReport, NamesImportedPixelsOnlyIfThereAreAny) {
  const HoleReport hole = count_hole(cv::Mat1b((cv::Mat1b(1, 4) << 0, 1, 6, 6)));
  EXPECT_EQ(hole.imported, 2U);
  EXPECT_EQ(hole.unobserved(), 2U);
  EXPECT_EQ(json(hole).at("imported"), 2);
  EXPECT_DOUBLE_EQ(json(hole).at("share").at("imported"), 2.0 / 3);
  EXPECT_EQ(json(hole).get<HoleReport>().imported, 2U);
  EXPECT_FALSE(json(HoleReport{.pixels = 3, .copied = 3}).contains("imported"));
}

TEST(CostReport, IsReadBackAndSummed) {
  const CostReport cost{{{"map", 2, 3}, {"fill", 5, 9}}, {{"depth", 1.5}}, 2, 123'000'000};
  CostReport sum = json(cost).get<CostReport>();
  EXPECT_EQ(json(sum), json(cost));
  sum += cost;
  EXPECT_EQ(sum.frames_made, 4U);
  EXPECT_EQ(sum.stages.at(1).cpu_seconds, 18);
  EXPECT_EQ(sum.fill_cpu_seconds.at("depth"), 3);
  EXPECT_EQ(sum.peak_memory_bytes, 123'000'000U);
}

TEST_F(ReportFile, IsReadBackAsItWasWritten) {
  const RunReport report(whole_report());
  write_file(file, to_json(report));
  const std::optional<RunReport> read = read_run_report(file);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->document(), report.document());
  EXPECT_EQ(read->brief("out"), report.brief("out"));
  EXPECT_EQ(read->frame_names(), std::vector<std::string>{"0003"});
}

TEST_F(ReportFile, IsNoneIfMissingOrDamaged) {
  EXPECT_FALSE(read_run_report(file));
  json without_hole = whole_report(), of_another_version = whole_report();
  without_hole.erase("hole");
  of_another_version["schema"] = "dvi-report/0";
  for (const std::string& text : {std::string(), std::string("{"), std::string("[]"), std::string(R"({"frames": 3})"),
                                  without_hole.dump(), of_another_version.dump()}) {
    write_file(file, text);
    EXPECT_FALSE(read_run_report(file)) << text;
  }
}

TEST(RunReport, BriefStatesOriginsAndCost) {
  const std::string text = RunReport(whole_report()).brief("out");
  for (const char* part : {"1 frames, 100 hole pixels: 60.0 % copied, 10.0 % from other cameras or drives, 30.0 % unobserved "
                           "(25.0 % interpolated, 5.0 % left black)",
                           "2 of 5 removed objects were completed, in 1 frame whose masks lack parts of them (objects.json)",
                           "4 of 5 removed tracks are stationary; they are 80 % of the hole; --remove moving would keep them",
                           "sunday: 100 % of its scans overlap; placed to 2.9 cm and 0.08 degrees (95 %)",
                           "6.0 CPU s per frame, peak memory 123 MB", "out/compare.mp4"})
    EXPECT_THAT(text, HasSubstr(part));
}

TEST(RunReport, BriefNamesObjectsThatRemainVisible) {
  json document = whole_report();
  document["objects"]["residue"] = {"object 7 (car) remains visible in frame 3: most of it was not removed"};
  EXPECT_THAT(RunReport(document).brief("out"),
              HasSubstr("\nobject 7 (car) remains visible in frame 3: most of it was not removed\n"));
}

TEST(RunReport, BriefOmitsStationaryObjectsThatAreASmallPartOfTheHole) {
  json document = whole_report();
  document["stationary"]["pixels"] = 50;
  EXPECT_THAT(RunReport(document).brief("out"), Not(HasSubstr("stationary")));
}

TEST(CpuClock, TimeOfNestedStagesCountsOnce) {
  CpuClock clock;
  const auto spin = [](double seconds) {
    for (const double begun = thread_cpu_seconds(); thread_cpu_seconds() < begun + seconds;) {
    }
    return 7;
  };
  EXPECT_EQ(clock.time("outer", [&] { return clock.time("inner", spin, 0.02); }), 7);
  EXPECT_GE(clock.seconds().at("inner"), 0.02);
  EXPECT_LT(clock.seconds().at("outer"), clock.seconds().at("inner"));
}

TEST(CpuClock, WrappedStagesKeepTheirOptionsAndResults) {
  CpuClock clock;
  const int option = 3;
  const auto stage = clock.wrap("stage", [](int input, int bound) { return input * bound; }, option);
  EXPECT_EQ(stage(5), 15);
  EXPECT_EQ(clock.seconds().count("stage"), 1U);
}

}  // namespace
}  // namespace dvi::result
