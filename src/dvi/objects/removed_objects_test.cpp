#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <optional>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/drive/outline.h"
#include "dvi/objects/removed_objects.h"

namespace dvi::objects {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Label outline(int track, const cv::Rect& part) {
  cv::Mat1b mask(60, 80, uchar{0});
  mask(part) = 255;
  Label label;
  label.track = track;
  label.type = track == 7 ? "car" : "";
  label.instance = to_outline(mask);
  return label;
}

// Frames 10 to 14. The masks show object 7 in frames 12 and 14, and object 9 in all frames.
struct Scene {
  Drive drive;
  Trajectory poses;
  CameraObjects objects;

  Scene() {
    drive.camera = {80, 60, 50, 50, 39.5, 29.5, {}};
    for (int i = 0; i < 5; ++i) drive.frames.push_back({10 + i, std::to_string(10 + i), i * 100'000'000, {}, {}});
    FrameLabels shown(5), completed(5);
    for (std::size_t i = 0; i < 5; ++i) {
      shown[i].push_back(outline(9, {40, 40, 10, 10}));
      (i == 2 || i == 4 ? shown : completed)[i].push_back(outline(7, {10, 10, 20, 10}));
    }
    objects = CameraObjects(shared(FrameLabels(5)));
    objects.shown = shared(shown);
    objects.completed = shared(completed);
    objects.motions = {{7, MotionState::stationary}};
  }
  std::vector<RemovedObject> list(MaskSource source, const ReadResult& read_result = {}) const {
    return list_removed_objects({drive, poses, "drive", {source}}, objects, {}, read_result);
  }
};

cv::Mat3b make_noise(std::uint64_t seed) {
  cv::Mat3b out(60, 80);
  cv::RNG(seed * 0x9e3779b97f4a7c15U).fill(out, cv::RNG::UNIFORM, 0, 256);
  return out;
}

// Returns a result in which the objects are visible in the given frames, removed from the others, and missing in the last one.
ReadResult show_objects_in(const std::vector<std::size_t>& frames, const cv::Mat1b& removed) {
  return [frames, removed](std::size_t frame) -> std::optional<ResultImages> {
    if (frame == 4) return std::nullopt;
    const bool is_visible = std::find(frames.begin(), frames.end(), frame) != frames.end();
    return ResultImages{make_noise(1), make_noise(is_visible ? 1 : 2), removed, cv::Mat1b(60, 80, uchar{255})};
  };
}

TEST(RemovedObjects, ListTheFramesInWhichTheyWereCompleted) {
  const std::vector<RemovedObject> list = Scene().list(MaskSource::files);
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0].number, 7);
  EXPECT_EQ(list[0].type, "car");
  EXPECT_EQ(list[0].motion, MotionState::stationary);
  EXPECT_THAT(list[0].frames, ElementsAre(10, 11, 12, 13, 14));
  EXPECT_THAT(list[0].completed, ElementsAre(10, 11, 13));
  EXPECT_EQ(list[0].pixels, 5 * 200U);
  EXPECT_THAT(list[1].completed, IsEmpty());
  const nlohmann::json json = objects_json(list);
  EXPECT_EQ(json["objects"][0]["motion"], "static");
  EXPECT_EQ(json["objects"][0]["completed_frames"], nlohmann::json({10, 11, 13}));
  EXPECT_TRUE(json["objects"][1]["class"].is_null());
}

TEST(RemovedObjects, AreCountedAndDescribed) {
  const ObjectCounts counts = count_objects(Scene().list(MaskSource::files));
  EXPECT_EQ(counts.removed, 2U);
  EXPECT_EQ(counts.completed, 1U);
  EXPECT_EQ(counts.completed_frames, 3U);
  EXPECT_EQ(counts.late, 1U);
  EXPECT_EQ(counts.with_gaps, 1U);
  EXPECT_THAT(describe_incomplete(counts, "files"),
              ElementsAre(HasSubstr("1 of 2 objects are visible before the first frame that shows them (files)"),
                          HasSubstr("1 of 2 objects are missing in frames between others that show them (files)")));
  EXPECT_THAT(describe_incomplete({.removed = 2}, "files"), IsEmpty());
}

TEST(RemovedObjects, ListTheFramesThatStillShowThem) {
  const std::vector<RemovedObject> list =
      Scene().list(MaskSource::files, show_objects_in({0, 1, 3}, cv::Mat1b(60, 80, uchar{255})));
  ASSERT_TRUE(list[0].residue);
  EXPECT_THAT(list[0].residue->frames, ElementsAre(10, 11, 13));
  EXPECT_EQ(list[0].residue->unmasked_frames, 0U);
  EXPECT_EQ(list[0].residue->highest_frame, 10);
  EXPECT_GT(list[0].residue->highest_score, 0.8);
  EXPECT_EQ(count_objects(list).visible, 2U);
  EXPECT_THAT(describe_visible(list),
              ElementsAre("object 7 (car) remains visible in frames 10-11, 13: its pixels in other frames were used as sources",
                          "object 9 remains visible in frames 10-11, 13: its pixels in other frames were used as sources"));
  const nlohmann::json json = objects_json(list);
  EXPECT_EQ(json["objects"][0]["residue"]["visible_frames"], nlohmann::json({10, 11, 13}));
  EXPECT_EQ(json["objects"][0]["residue"]["highest_score_frame"], 10);
  const cv::Rect& box = list[0].residue->highest_box;
  EXPECT_EQ(json["objects"][0]["residue"]["highest_score_box"], nlohmann::json({box.x, box.y, box.width, box.height}));
  EXPECT_EQ(box.area(), 200) << "the extent of its label";
}

TEST(RemovedObjects, AreATableWithTheMostDoubtfulFirst) {
  std::vector<RemovedObject> list(3);
  for (int i = 0; i < 3; ++i) list[i].number = i, list[i].frames = {4, 5, 6}, list[i].pixels = 100;
  list[0].type = "car, \"parked\"";
  list[0].residue = ObjectResidue{.frames = {}, .highest_score = 0.3, .highest_frame = 5, .highest_box = {1, 2, 3, 4}};
  list[2].residue = ObjectResidue{.frames = {5, 6}, .highest_score = 0.25, .highest_frame = 6, .highest_box = {5, 6, 7, 8}};
  list[2].completed = {4, 6};
  const std::string table = objects_csv(list);
  EXPECT_THAT(table, testing::StartsWith("object,camera,class,"));
  const std::size_t columns = static_cast<std::size_t>(std::count(table.begin(), table.begin() + table.find('\n'), ','));
  EXPECT_EQ(columns, 18U);
  EXPECT_THAT(table, HasSubstr("\n2,,,none,unknown,4,6,3,4 6,100,yes,5 6,0,0.250,6,5,6,7,8\r\n0,,\"car, "
                               "\"\"parked\"\"\",none,unknown,4,6,3,,100,no,,0,"
                               "0.300,5,1,2,3,4\r\n1,,,none,unknown,4,6,3,,100,not measured,,,,,,,,\r\n"));
}

TEST(RemovedObjects, InSingleFramesAreNotNamed) {
  const std::vector<RemovedObject> list =
      Scene().list(MaskSource::files, show_objects_in({0, 2}, cv::Mat1b(60, 80, uchar{255})));
  EXPECT_THAT(list[0].residue->frames, ElementsAre(10, 12));
  EXPECT_EQ(count_objects(list).visible, 0U);
  EXPECT_THAT(describe_visible(list), IsEmpty());
  EXPECT_EQ(objects_json(list)["objects"][0]["residue"]["remains_visible"], false);
}

TEST(RemovedObjects, OfACorrectResultAreNotVisible) {
  const std::vector<RemovedObject> list = Scene().list(MaskSource::files, show_objects_in({}, cv::Mat1b(60, 80, uchar{255})));
  ASSERT_TRUE(list[0].residue);
  EXPECT_LT(list[0].residue->highest_score, 0.1);
  EXPECT_THAT(describe_visible(list), IsEmpty());
  EXPECT_EQ(objects_json(list)["objects"][0]["residue"]["visible_frames"], nlohmann::json::array());
  EXPECT_TRUE(objects_json(Scene().list(MaskSource::files))["objects"][0]["residue"].is_null()) << "not measured";
}

TEST(RemovedObjects, ThatAreNotMaskedRemainVisible) {
  cv::Mat1b removed(60, 80, uchar{255});
  removed(cv::Rect(10, 10, 20, 10)) = 0;
  const std::vector<RemovedObject> list = Scene().list(MaskSource::files, show_objects_in({}, removed));
  EXPECT_EQ(list[0].residue->unmasked_frames, 4U);
  EXPECT_THAT(describe_visible(list),
              ElementsAre("object 7 (car) remains visible in frames 10-13: most of it was not removed"));
}

TEST(RemovedObjects, AreNamedIfTheyAreLarge) {
  std::vector<RemovedObject> list(8);
  for (int i = 0; i < 8; ++i) {
    list[static_cast<std::size_t>(i)].number = i;
    list[static_cast<std::size_t>(i)].pixels = static_cast<std::size_t>(100 * i);
    list[static_cast<std::size_t>(i)].frames = {3};
    list[static_cast<std::size_t>(i)].residue = ObjectResidue{{3}, 0, 0.5, 3, {}};
  }
  const std::vector<std::string> sentences = describe_visible(list);
  ASSERT_EQ(sentences.size(), 6U);
  EXPECT_THAT(sentences.front(), HasSubstr("object 7 remains visible in frame 3:"));
  EXPECT_EQ(sentences.back(), "3 other objects remain visible, see objects.json");
}

TEST(RemovedObjects, OfLabelsAreThoseOfTheLabels) {
  Scene scene;
  FrameLabels labels(5);
  labels[1].push_back(outline(3, {5, 5, 10, 10}));
  labels[3].push_back(outline(-1, {5, 5, 10, 10}));
  for (std::vector<Label>& frame : labels)
    for (Label& label : frame) label.source = MaskSource::found;
  scene.objects = CameraObjects(shared(labels));
  const std::vector<RemovedObject> list = scene.list(MaskSource::found);
  ASSERT_EQ(list.size(), 1U) << "a label without a track belongs to no object";
  EXPECT_EQ(list[0].number, 3);
  EXPECT_EQ(list[0].motion, MotionState::moving);
  EXPECT_THAT(list[0].frames, ElementsAre(11));
}

TEST(RemovedObjects, StateTheSourcesThatShowThem) {
  Scene scene;
  FrameLabels labels(5);
  labels[0].push_back(outline(7, {10, 10, 20, 10}));
  labels[1].push_back(outline(12, {5, 5, 10, 10}));
  labels[1].back().source = MaskSource::found;
  labels[2].push_back(outline(13, {5, 5, 10, 10}));
  labels[2].back().source = MaskSource::detected;
  scene.objects.labels = shared(labels);
  const MaskSources sources{MaskSource::files, MaskSource::labels, MaskSource::found};
  const nlohmann::json json =
      objects_json(list_removed_objects({scene.drive, scene.poses, "drive", sources}, scene.objects, {}))["objects"];
  ASSERT_EQ(json.size(), 3U) << "the detector is not a source";
  EXPECT_EQ(json[0]["evidence"], "files, labels");
  EXPECT_EQ(json[1]["evidence"], "files");
  EXPECT_EQ(json[2]["object"], 12);
  EXPECT_EQ(json[2]["evidence"], "found");
  EXPECT_EQ(json[2]["motion"], "moving");
}

}  // namespace
}  // namespace dvi::objects
