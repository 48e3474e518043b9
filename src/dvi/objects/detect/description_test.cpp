#include "dvi/objects/detect/description.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/testing/temp_folder.h"

namespace dvi::objects {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kInput = "[input]\nsize = [640, 384]\n";
const std::string kOutput = "[output]\nkind = \"yolov5-seg\"\n";
const std::string kClasses = "[classes]\nnames = [\"person\", \"Traffic Light\", \"Car\"]\n";

Description read(const std::string& text) {
  const TempFolder folder;
  folder.write("net.toml", text);
  return read_description(folder.path / "net.onnx");
}

std::string complaint(const std::string& text) {
  return input_error([&] { read(text); });
}

TEST(Description, HasDefaultsForAllButSizeKindAndClasses) {
  const Description d = read(kInput + kOutput + kClasses);
  EXPECT_EQ(d.input, cv::Size(640, 384));
  EXPECT_EQ(d.fit, Fit::letterbox);
  EXPECT_EQ(d.channels, Channels::rgb);
  EXPECT_THAT(d.mean, ElementsAre(0, 0, 0));
  EXPECT_THAT(d.sigma, ElementsAre(255, 255, 255));
  EXPECT_EQ(d.layout, Layout::yolov5_seg);
  EXPECT_TRUE(d.outputs.empty());
  EXPECT_THAT(d.classes, ElementsAre("person", "traffic light", "car"));
  EXPECT_THAT(d.removed, ElementsAre(1, 0, 1)) << "vehicles, people and animals";
}

TEST(Description, ReadsEveryKey) {
  const Description d = read(
      "[input]\nsize = [32, 16]\nfit = \"letterbox\"\npad = 0\nchannels = \"BGR\"\nmean = [1, 2, 3]\nstd = [4, 5, 6.5]\n"
      "[output]\nkind = \"yolov8-seg\"\nnames = [\"a\", \"b\"]\nscore = 0.5\nnms = 0.7\nleast_pixels = 9\n"
      "[classes]\nnames = [\"x\", \"y\", \"car\"]\nremove = [\"Y\"]\n");
  EXPECT_EQ(d.pad, 0);
  EXPECT_EQ(d.channels, Channels::bgr);
  EXPECT_THAT(d.mean, ElementsAre(1, 2, 3));
  EXPECT_THAT(d.sigma, ElementsAre(4, 5, 6.5));
  EXPECT_EQ(d.layout, Layout::yolov8_seg);
  EXPECT_THAT(d.outputs, ElementsAre("a", "b"));
  EXPECT_EQ(d.score, 0.5);
  EXPECT_EQ(d.nms, 0.7);
  EXPECT_EQ(d.least_pixels, 9);
  EXPECT_THAT(d.removed, ElementsAre(0, 1, 0));
}

TEST(Description, NamesFileLineAndRemedy) {
  EXPECT_THAT(complaint(kOutput + kClasses), HasSubstr("has no section [input]; docs/detector.md has a template"));
  EXPECT_THAT(complaint("[input]\n" + kOutput + kClasses), HasSubstr("net.toml:1: [input] lacks 'size'"));
  EXPECT_THAT(complaint(kInput + "size_px = 1\n" + kOutput + kClasses), HasSubstr("net.toml:3: [input] has no key 'size_px'"));
  EXPECT_THAT(complaint("[input]\nsize = [0, 64]\n" + kOutput + kClasses), HasSubstr("8 to 8192"));
  EXPECT_THAT(complaint("[input]\nsize = [8192, 8192]\n" + kOutput + kClasses), HasSubstr("2^24"));
  EXPECT_THAT(complaint("[input]\nsize = 64\n" + kOutput + kClasses), HasSubstr("is not a list of 2 numbers"));
  EXPECT_THAT(complaint(kInput + "std = [1, 0, 1]\n" + kOutput + kClasses), HasSubstr("is not positive"));
  EXPECT_THAT(complaint(kInput + "fit = \"stretch\"\npad = 3\n" + kOutput + kClasses), HasSubstr("no meaning"));
  EXPECT_THAT(complaint(kInput + "[output]\nkind = \"rcnn\"\n" + kClasses), HasSubstr("semantic"));
  EXPECT_THAT(complaint(kInput + "[output]\nkind = 3\n" + kClasses), HasSubstr("yolov8-seg"));
  EXPECT_THAT(complaint(kInput + "[output]\nkind = \"semantic\"\nscore = 0.5\n" + kClasses), HasSubstr("no meaning"));
  EXPECT_THAT(complaint(kInput + kOutput + "score = nan\n" + kClasses), HasSubstr("is not a number from 0.001 to 1"));
  EXPECT_THAT(complaint(kInput + kOutput + "[classes]\nnames = [\"sky\"]\n"), HasSubstr("'remove'"));
  EXPECT_THAT(complaint(kInput + kOutput + "[classes]\nnames = [1]\n"), HasSubstr("is not a list of names"));
  EXPECT_THAT(complaint(kInput + kOutput + kClasses + "remove = [\"bus\"]\n"), HasSubstr("has 'bus'"));
  EXPECT_THAT(complaint(kInput + kOutput + kClasses + "[more]\n"), HasSubstr("[more] is not one of"));
  EXPECT_THAT(complaint("[input\n"), HasSubstr("net.toml:1"));
  EXPECT_THAT(input_error([] { read_description("nowhere/net.onnx"); }), HasSubstr("docs/detector.md has a template"));
}

}  // namespace
}  // namespace dvi::objects
