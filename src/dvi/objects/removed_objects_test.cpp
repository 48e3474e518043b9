#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
  std::vector<RemovedObject> list(MaskSource source) const {
    return list_removed_objects({drive, poses, "drive", source}, objects, {});
  }
};

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
  const nlohmann::json json = objects_json(list, "files");
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

TEST(RemovedObjects, OfLabelsAreThoseOfTheLabels) {
  Scene scene;
  FrameLabels labels(5);
  labels[1].push_back(outline(3, {5, 5, 10, 10}));
  labels[3].push_back(outline(-1, {5, 5, 10, 10}));
  scene.objects = CameraObjects(shared(labels));
  const std::vector<RemovedObject> list = scene.list(MaskSource::found);
  ASSERT_EQ(list.size(), 1U) << "a label without a track belongs to no object";
  EXPECT_EQ(list[0].number, 3);
  EXPECT_EQ(list[0].motion, MotionState::moving);
  EXPECT_THAT(list[0].frames, ElementsAre(11));
}

}  // namespace
}  // namespace dvi::objects
