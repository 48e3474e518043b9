#include "dvi/report/report.h"

#include <array>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/geometry/camera_json.h"
#include "dvi/harmonize/provenance.h"
#include "dvi/media/image_file.h"
#include "dvi/media/write_image.h"
#include "dvi/report/inspect.h"
#include "dvi/report/page_files.h"
#include "dvi/report/top_view.h"
#include "dvi/report/uncertainty.h"
#include "dvi/report/unobserved_cells.h"
#include "dvi/testing/temp_folder.h"

namespace dvi::report {
namespace {

using testing::HasSubstr;

/// A result with one frame, "a", whose pixel 5, 3 was copied from frame "b" and whose pixel 6, 3 was interpolated.
class SmallResult : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* pictures_of :
         {"frames", "masks", "kind", "confidence", "depth", "provenance", "harmonization", "sources_used"})
      make_folder(out / pictures_of);
    pictures.kind = cv::Mat1b(8, 12, uchar{0});
    pictures.confidence = cv::Mat1b(8, 12, uchar{0});
    pictures.depth = cv::Mat1w(8, 12, ushort{512});
    pictures.provenance = cv::Mat_<cv::Vec3w>(8, 12, cv::Vec3w());
    pictures.harmonization = cv::Mat_<cv::Vec3w>(8, 12, cv::Vec3w());
    pictures.used = cv::Mat3b(8, 12, cv::Vec3b());
    pictures.kind(3, 5) = 1;
    pictures.kind(3, 6) = 3;
    pictures.confidence(3, 5) = 204;
    pictures.provenance(3, 5) = {2, 5 * 16 + 3, 4 * 16};
    pictures.harmonization(3, 5) = {harmonize::kNoChange - 2, harmonize::kNoChange, harmonize::kNoChange + 7};
    pictures.used(3, 5) = {1, 2, 3};
    media::write_png(out / "frames/a.png", cv::Mat3b(8, 12, cv::Vec3b(30, 20, 10)));
    media::write_png(out / "kind/a.png", pictures.kind);
    media::write_png(out / "confidence/a.png", pictures.confidence);
    media::write_png(out / "depth/a.png", pictures.depth);
    media::write_png(out / "provenance/a.png", pictures.provenance);
    media::write_png(out / "harmonization/a.png", pictures.harmonization);
    media::write_png(out / "sources_used/a.png", pictures.used);
    media::write_png(folder / "b.png", cv::Mat3b(8, 12, cv::Vec3b(1, 2, 3)));
    nlohmann::json sources = nlohmann::json::array();
    for (const char* name : {"a", "b"})
      sources.push_back({{"drive", "/d"}, {"camera", "front"}, {"frame", name}, {"file", (folder / "b.png").string()}});
    write_file(out / "sources.json", nlohmann::json{{"sources", sources}}.dump());
    write_file(out / "report.json", run);
  }

  void write() const {
    write_report({.out = out, .names = {"a"}, .run = [&] { return run; }, .options = "[]", .evaluation = "null"});
  }

  const TempFolder temporary;
  const fs::path folder = temporary.path, out = folder / "out";
  const std::string run = R"({"frames": [{"name": "a", "number": 7}]})";
  FramePictures pictures;
};

TEST_F(SmallResult, APixelRecordHasTheValuesOfTheImages) {
  const PixelRecord record = read_pixel_record(out, "a", {5, 3});
  EXPECT_EQ(record.kind, "copied");
  EXPECT_EQ(record.color, (std::array{10, 20, 30}));
  EXPECT_DOUBLE_EQ(record.depth_m.value_or(0), 2);
  EXPECT_DOUBLE_EQ(record.confidence.value_or(0), 0.8);
  ASSERT_TRUE(record.source);
  EXPECT_EQ(record.source->frame, "b");
  EXPECT_EQ(record.source->position, cv::Point2f(5 + 3 / 16.0F, 4));
  EXPECT_EQ(record.source->footprint, cv::Vec2i(2, 1));
  EXPECT_EQ(record.source->averaged, 3);
  EXPECT_EQ(record.source->change, (std::array{-2, 0, 7}));
  EXPECT_EQ(record.source->frames_apart, 1);
  EXPECT_EQ(nlohmann::json::parse(to_json(record)).at("source").at("x"), 5 + 3 / 16.0);
  EXPECT_THAT(to_text(record), HasSubstr("frame b"));
  EXPECT_EQ(read_pixel_record(out, "7", {5, 3}).frame, "a") << "by the number in the drive";
}

TEST_F(SmallResult, OtherPixelsHaveNoSource) {
  EXPECT_EQ(read_pixel_record(out, "a", {0, 0}).kind, "original");
  EXPECT_FALSE(read_pixel_record(out, "a", {0, 0}).confidence);
  EXPECT_EQ(read_pixel_record(out, "a", {6, 3}).kind, "interpolated");
  EXPECT_FALSE(read_pixel_record(out, "a", {6, 3}).source);
}

TEST_F(SmallResult, MissingDataIsAnInputError) {
  EXPECT_THROW(read_pixel_record(out, "c", {0, 0}), InputError);
  EXPECT_THROW(read_pixel_record(out, "a", {12, 0}), InputError);
  EXPECT_THROW(read_pixel_record(out, "a", {0, -1}), InputError);
  fs::remove(out / "provenance/a.png");
  EXPECT_THROW(read_pixel_record(out, "a", {5, 3}), InputError);
  write_file(out / "report.json", R"({"frames": 3})");
  EXPECT_THROW(read_pixel_record(out, "c", {0, 0}), InputError);
}

TEST_F(SmallResult, CropsShowBothPositions) {
  write_crops(folder / "crops", out, read_pixel_record(out, "a", {5, 3}));
  EXPECT_EQ(media::image_size(folder / "crops/result.png"), cv::Size(36, 24)) << "three times the whole image";
  EXPECT_TRUE(fs::exists(folder / "crops/source.png"));
}

TEST_F(SmallResult, AReportShowsItsFramesAndHoles) {
  EXPECT_TRUE(list_frame_files(out, 0).empty());
  write();
  EXPECT_EQ(list_frame_files(out, 0), (std::vector<std::string>{"report/data_000000.js", "report/before/000000.png"}));
  EXPECT_THAT(read_file(out / "report/index.js"), HasSubstr(R"("picture":"frames/a.png")"));
  EXPECT_EQ(media::image_size(out / "report/before/000000.png"), cv::Size(12, 8));
}

TEST_F(SmallResult, TheRunAndTheReportWriteTheSameFiles) {
  write_frame(out, 0, pictures, cv::Mat3b(8, 12, cv::Vec3b(1, 2, 3)));
  const std::string block = read_file(out / "report/data_000000.js"), before = read_file(out / "report/before/000000.png");
  write();
  EXPECT_EQ(read_file(out / "report/data_000000.js"), block);
  EXPECT_EQ(read_file(out / "report/before/000000.png"), before);
}

TEST_F(SmallResult, RemovesFilesOfLongerResults) {
  make_folder(out / "report/before");
  write_file(out / "report/data_000001.js", "x");
  write_file(out / "report/before/000001.png", "x");
  write_file(out / "report/notes.txt", "mine");
  write();
  EXPECT_FALSE(fs::exists(out / "report/data_000001.js"));
  EXPECT_FALSE(fs::exists(out / "report/before/000001.png"));
  EXPECT_TRUE(fs::exists(out / "report/notes.txt"));
}

TEST_F(SmallResult, TheReportListsRemovedObjects) {
  write();
  EXPECT_THAT(read_file(out / "report/index.js"), HasSubstr(R"("objects":null)")) << "a result of an earlier version";
  write_file(out / "objects.json", R"({"objects": [{"object": 7}]})");
  write();
  EXPECT_THAT(read_file(out / "report/index.js"), HasSubstr(R"("objects":[{"object":7}])"));
  write_file(out / "objects.json", "[");
  write();
  EXPECT_THAT(read_file(out / "report/index.js"), HasSubstr("objects.json is damaged"));
}

TEST_F(SmallResult, TheReportShowsDamage) {
  fs::remove(out / "kind/a.png");
  write_file(out / "sources.json", "[");
  write();
  const std::string index = read_file(out / "report/index.js");
  EXPECT_THAT(index, HasSubstr("sources.json is damaged"));
  EXPECT_THAT(index, HasSubstr("kind/a.png"));
  EXPECT_THAT(index, HasSubstr("pictures of 1 of 1 frames are missing"));
}

TEST(Uncertainty, FindsTheWorstPart) {
  cv::Mat1b kind(90, 160, uchar{0}), confidence(90, 160, uchar{0});
  kind(cv::Rect(10, 10, 10, 10)) = 1;
  confidence(cv::Rect(10, 10, 10, 10)) = 255;
  kind(cv::Rect(100, 60, 10, 10)) = 3;
  const Uncertainty found = estimate_uncertainty(kind, confidence);
  EXPECT_DOUBLE_EQ(found.within, 0.5);
  EXPECT_DOUBLE_EQ(found.pixels, 100);
  EXPECT_DOUBLE_EQ(found.in_worst, 100);
  EXPECT_EQ(found.worst & cv::Rect(100, 60, 10, 10), cv::Rect(100, 60, 10, 10));
  EXPECT_TRUE(estimate_uncertainty(cv::Mat1b(90, 160, uchar{0}), confidence).worst.empty());
}

TEST(UnobservedCells, AreAtThePositionsOfTheirPixels) {
  FramePictures pictures;
  pictures.kind = cv::Mat1b(9, 9, uchar{0});
  pictures.depth = cv::Mat1w(9, 9, ushort{256 * 4});
  pictures.kind(4, 4) = 3;
  pictures.kind(4, 8) = 1;
  const nlohmann::json above{{"camera", dvi::to_json(Camera{9, 9, 8, 8, 4, 4})},
                             {"world_from_camera", {{0, 0, 1, 10.25, -1, 0, 0, 0.25, 0, -1, 0, 0}}}};
  const UnobservedCells cells = find_unobserved_cells(pictures, 0, above);
  ASSERT_EQ(cells.size(), 1U);
  EXPECT_EQ(cells.begin()->first, std::pair(28, 0)) << "4 m ahead of 10.25, 0.25, in half meters";
  EXPECT_TRUE(find_unobserved_cells(pictures, 5, above).empty()) << "no pose";
}

TEST(TopView, HasThePointsOfTheMap) {
  const TempFolder temporary;
  map::StaticMap map;
  map.scans.push_back({});
  map::MapPoint road, roof;
  road.position = {10, 5, -1};
  roof.position = {-10, 5, 30};
  map.points.push_back(road);
  map.points.push_back(roof);
  write_top_view(temporary.path, {.map = map,
                                  .color = [](std::size_t) { return cv::Vec3b(1, 2, 3); },
                                  .camera = {.width = 4, .height = 4, .fx = 1, .fy = 1},
                                  .world_from_camera = {SE3{}},
                                  .tracks = {{3, "car", {{1, 2}}, {0}}}});
  const nlohmann::json above = nlohmann::json::parse(read_file(temporary.path / "above.json"));
  const double meters = above.at("meters_per_px");
  const auto pixel = [&](double x, double y) {
    return cv::Point(static_cast<int>((x - above.at("left_m").get<double>()) / meters + 1e-6),
                     static_cast<int>((above.at("top_m").get<double>() - y) / meters + 1e-6));
  };
  const cv::Mat3b picture = media::read_image(temporary.path / "map.png", {above.at("width"), above.at("height")});
  EXPECT_EQ(picture(pixel(10, 5)), cv::Vec3b(1, 2, 3));
  EXPECT_EQ(picture(pixel(-10, 5)), cv::Vec3b(0, 0, 0)) << "far above the sensor";
  EXPECT_EQ(above.at("tracks")[0].at("points")[0], (nlohmann::json{1.0, 2.0, 0}));
}

TEST(PageFiles, ContainThePage) {
  std::set<std::string_view> names;
  for (const PageFile& file : get_page_files()) {
    names.insert(file.name);
    EXPECT_FALSE(file.bytes.empty()) << file.name;
  }
  EXPECT_TRUE(names.contains("report.html"));
  EXPECT_TRUE(names.contains("app.js"));
}

}  // namespace
}  // namespace dvi::report
