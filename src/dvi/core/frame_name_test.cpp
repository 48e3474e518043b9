#include "dvi/core/frame_name.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/testing/temp_folder.h"

namespace dvi {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(FrameName, HasTheCameraIfThereAreSeveral) {
  EXPECT_EQ(join_frame_name("", "000012"), "000012");
  EXPECT_EQ(join_frame_name("front", "000012"), "front/000012");
  EXPECT_EQ(camera_of_frame("000012"), "");
  EXPECT_EQ(image_of_frame("000012"), "000012");
  EXPECT_EQ(camera_of_frame("front/000012"), "front");
  EXPECT_EQ(image_of_frame("front/000012"), "000012");
}

TEST(FrameName, LeadsToThePictures) {
  EXPECT_EQ(picture_file("kind", "000012"), "kind/000012.png");
  EXPECT_EQ(picture_file("kind", "front/000012"), "front/kind/000012.png");
}

TEST(FrameName, CamerasAreListedOnceInOrder) {
  EXPECT_THAT(list_cameras({"b/1", "b/2", "a/1"}), ElementsAre("b", "a"));
  EXPECT_THAT(list_cameras({"1", "2"}), ElementsAre(""));
  EXPECT_THAT(list_cameras({}), IsEmpty());
}

TEST(FrameName, FramesOfAResultAreListed) {
  const TempFolder temporary;
  const fs::path out = temporary.path;
  EXPECT_THAT(list_frames(out), IsEmpty());
  EXPECT_THAT(list_frames(out / "absent"), IsEmpty());
  for (const char* file : {"right/frames/2.png", "right/frames/10.png", "front/frames/1.png", "map/1.png"}) {
    make_folder((out / file).parent_path());
    write_file(out / file, "");
  }
  EXPECT_THAT(list_frames(out), ElementsAre("front/1", "right/2", "right/10"));
  make_folder(out / "frames");
  write_file(out / "frames/7.png", "");
  EXPECT_THAT(list_frames(out), ElementsAre("7"));
}

TEST(FrameName, ImagesOfOneCameraMayLieBesideTheFoldersOfTheOthers) {
  const TempFolder temporary;
  const fs::path truth = temporary.path;
  for (const char* file : {"1.png", "2.png", "right/1.png", "left/1.png"}) {
    make_folder((truth / file).parent_path());
    write_file(truth / file, "");
  }
  const FrameImages rig(truth, {"front/1", "left/1", "right/1"});
  EXPECT_EQ(rig.file("front/1"), truth / "1.png");
  EXPECT_EQ(rig.file("right/1"), truth / "right/1.png");
  EXPECT_THAT(rig.list(), ElementsAre("front/1", "front/2", "left/1", "right/1"));
  EXPECT_EQ(FrameImages(truth, {"1"}).file("1"), truth / "1.png");
  EXPECT_THAT(FrameImages(truth, {"1"}).list(), ElementsAre("1", "2"));
  const FrameImages unclear(truth, {"front/1", "rear/1", "right/1"});
  EXPECT_EQ(unclear.file("front/1"), truth / "front/1.png") << "two cameras have no folder";
}

}  // namespace
}  // namespace dvi
