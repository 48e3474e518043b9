#include "dvi/objects/detect/description.h"

#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/testing/temp_folder.h"

namespace dvi::objects {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kInput = "[input]\nsize = [640, 384]\n";
const std::string kOutput = "[output]\nkind = \"yolov5\"\n";
const std::string kClasses = "[classes]\nnames = [\"person\", \"Traffic Light\", \"Car\"]\n";

// A network with an image of this shape as its input.
OnnxFile network(std::vector<std::int64_t> shape = {1, 3, -1, -1}) {
  return {"net.onnx", {{"images", ElementType::float32, std::move(shape)}}, {}, {}, {}};
}

// The description of a network with files beside it, by name.
Description describe(OnnxFile file, const std::map<std::string, std::string>& files) {
  const TempFolder folder;
  for (const auto& [name, text] : files) folder.write(name, text);
  file.path = folder.path / "net.onnx";
  return describe_network(file);
}
Description read(const std::string& toml) { return describe(network(), {{"net.toml", toml}}); }

std::string complaint(const std::string& text) {
  return input_error([&] { read(text); });
}

TEST(Description, HasDefaultsForAllButTheClasses) {
  const Description d = read(kInput + kOutput + kClasses);
  EXPECT_EQ(d.input, cv::Size(640, 384));
  EXPECT_EQ(d.fit, Fit::letterbox);
  EXPECT_EQ(d.channels, Channels::rgb);
  EXPECT_THAT(d.mean, ElementsAre(0, 0, 0));
  EXPECT_THAT(d.sigma, ElementsAre(255, 255, 255));
  EXPECT_EQ(d.layout, Layout::yolov5);
  EXPECT_TRUE(d.outputs.empty());
  EXPECT_THAT(d.classes, ElementsAre("person", "traffic light", "car"));
  EXPECT_THAT(d.removed, ElementsAre(1, 0, 1)) << "vehicles, people and animals";
}

TEST(Description, ReadsEveryKey) {
  const Description d = read(
      "[input]\nsize = [32, 16]\nfit = \"letterbox\"\npad = 0\nchannels = \"BGR\"\nmean = [1, 2, 3]\nstd = [4, 5, 6.5]\n"
      "[output]\nkind = \"yolov8\"\nnames = [\"a\", \"b\"]\nscore = 0.5\nnms = 0.7\nleast_pixels = 9\n"
      "[classes]\nnames = [\"x\", \"y\", \"car\"]\nremove = [\"Y\"]\n");
  EXPECT_EQ(d.pad, 0);
  EXPECT_EQ(d.channels, Channels::bgr);
  EXPECT_THAT(d.mean, ElementsAre(1, 2, 3));
  EXPECT_THAT(d.sigma, ElementsAre(4, 5, 6.5));
  EXPECT_EQ(d.layout, Layout::yolov8);
  EXPECT_THAT(d.outputs, ElementsAre("a", "b"));
  EXPECT_EQ(d.score, 0.5);
  EXPECT_EQ(d.nms, 0.7);
  EXPECT_EQ(d.least_pixels, 9);
  EXPECT_THAT(d.removed, ElementsAre(0, 1, 0));
}

TEST(Description, NamesFileLineAndRemedy) {
  EXPECT_THAT(complaint(kInput + "size_px = 1\n" + kOutput + kClasses), HasSubstr("net.toml:3: [input] has no key 'size_px'"));
  EXPECT_THAT(complaint("[input]\nsize = [0, 64]\n" + kOutput + kClasses), HasSubstr("8 to 8192"));
  EXPECT_THAT(complaint("[input]\nsize = [8192, 8192]\n" + kOutput + kClasses), HasSubstr("2^24"));
  EXPECT_THAT(complaint("[input]\nsize = 64\n" + kOutput + kClasses), HasSubstr("is not a list of 2 numbers"));
  EXPECT_THAT(complaint(kInput + "std = [1, 0, 1]\n" + kOutput + kClasses), HasSubstr("is not positive"));
  EXPECT_THAT(complaint(kInput + "fit = \"stretch\"\npad = 3\n" + kOutput + kClasses), HasSubstr("no meaning"));
  EXPECT_THAT(complaint(kInput + "[output]\nkind = \"other\"\n" + kClasses), HasSubstr("semantic"));
  EXPECT_THAT(complaint(kInput + "[output]\nkind = 3\n" + kClasses), HasSubstr("yolov8"));
  EXPECT_THAT(complaint(kInput + "[output]\nkind = \"semantic\"\nscore = 0.5\n" + kClasses), HasSubstr("no meaning"));
  EXPECT_THAT(complaint(kInput + kOutput + "score = nan\n" + kClasses), HasSubstr("is not a number from 0.001 to 1"));
  EXPECT_THAT(complaint(kInput + kOutput + "[classes]\nnames = [\"sky\"]\n"), HasSubstr("it has sky; choose some"));
  EXPECT_THAT(complaint(kInput + kOutput + "[classes]\nnames = [1]\n"), HasSubstr("is not a list of names"));
  EXPECT_THAT(complaint(kInput + kOutput + "[classes]\nnames = \"ImageNet\"\n"), HasSubstr("COCO, COCO-91, or Cityscapes"));
  EXPECT_THAT(complaint(kInput + kOutput + kClasses + "remove = [\"bus\"]\n"), HasSubstr("has 'bus'"));
  EXPECT_THAT(complaint(kInput + kOutput + kClasses + "[more]\n"), HasSubstr("[more] is not one of"));
  EXPECT_THAT(complaint("[input\n"), HasSubstr("net.toml:1"));
}

TEST(Description, KnowsTheClassesOfCommonDataSets) {
  const auto names = [](const char* set) { return read("[classes]\nnames = \"" + std::string(set) + "\"\n").classes; };
  EXPECT_EQ(names("COCO").size(), 80U);
  EXPECT_EQ(names("COCO")[2], "car");
  EXPECT_EQ(names("COCO")[79], "toothbrush");
  EXPECT_EQ(names("COCO-91").size(), 91U);
  EXPECT_EQ(names("COCO-91")[3], "car");
  EXPECT_EQ(names("COCO-91")[90], "toothbrush");
  EXPECT_EQ(names("Cityscapes")[13], "car");
}

TEST(Description, TakesTheSizeThatTheNetworkDeclares) {
  EXPECT_EQ(describe(network({1, 3, 384, 640}), {{"net.toml", kClasses}}).input, cv::Size(640, 384));
  EXPECT_EQ(describe(network({3, 384, 640}), {{"net.toml", kClasses}}).input, cv::Size(640, 384));
  EXPECT_TRUE(describe(network(), {{"net.toml", kClasses}}).input.empty());
  EXPECT_THAT(input_error([] { describe(network({1, 3, 64, 64}), {{"net.toml", kInput + kClasses}}); }),
              HasSubstr("'size' is 640x384, but the network takes images of 64x64"));
  EXPECT_THAT(input_error([] { describe(network({1, 768}), {{"net.toml", kClasses}}); }),
              HasSubstr("takes images float32 1x768, which is not an image"));
  OnnxFile two = network();
  two.inputs.push_back({"orig_target_sizes", ElementType::int64, {1, 2}});
  EXPECT_EQ(describe(two, {{"net.toml", kClasses}}).class_count(), 3) << "the size to which boxes are scaled";
  two.inputs.push_back({"tokens", ElementType::float32, {1, 768}});
  EXPECT_THAT(input_error([&] { describe(two, {{"net.toml", kClasses}}); }), HasSubstr("is not an image"));
}

TEST(Description, ReadsTheMetadataOfUltralytics) {
  OnnxFile file = network();
  file.metadata = {{"names", "{0: 'Person', 1: \"driver's cab\", 2: 'it\\'s'}"}, {"imgsz", "[384, 640]"}, {"task", "segment"}};
  const Description d = describe(file, {});
  EXPECT_THAT(d.classes, ElementsAre("person", "driver's cab", "it's"));
  EXPECT_EQ(d.input, cv::Size(640, 384));
  EXPECT_EQ(d.fit, Fit::letterbox);
  EXPECT_THAT(d.removed, ElementsAre(1, 0, 0));
  file.metadata["description"] = "Ultralytics RT-DETR-l model trained on coco.yaml";
  EXPECT_EQ(describe(file, {}).fit, Fit::stretch);
  file.metadata["names"] = "{0: 'face', 1: 'license_plate'}";
  EXPECT_THAT(describe(file, {}).removed, ElementsAre(1, 1));
  file.metadata["names"] = "{0: 'person', 2: 'car'}";
  EXPECT_TRUE(describe(file, {}).classes.empty()) << "a number is missing";
  EXPECT_THAT(describe(file, {{"net.toml", kClasses}}).removed, ElementsAre(1, 0, 1)) << "MODEL.toml comes last";
}

TEST(Description, ReadsTheFilesOfHuggingFace) {
  const std::string config = R"({"id2label": {"0": "road", "1": "Car", "2": "person"}})";
  const std::string preparation = R"({"do_normalize": true, "image_mean": [0.5, 0.4, 0.3], "image_std": [0.2, 0.2, 0.1],
                                      "size": {"height": 512, "width": 1024}})";
  const Description d = describe(network(), {{"config.json", config}, {"preprocessor_config.json", preparation}});
  EXPECT_THAT(d.classes, ElementsAre("road", "car", "person"));
  EXPECT_EQ(d.input, cv::Size(1024, 512));
  EXPECT_EQ(d.fit, Fit::stretch);
  EXPECT_THAT(d.mean, ElementsAre(127.5, 102, 76.5));
  EXPECT_THAT(d.sigma, ElementsAre(51, 51, 25.5));
  EXPECT_EQ(d.files.size(), 3U) << "all are inputs of a run";
  EXPECT_THAT(input_error([&] { describe(network(), {{"config.json", "[]"}}); }),
              HasSubstr("config.json: is not a JSON object"));
}

}  // namespace
}  // namespace dvi::objects
