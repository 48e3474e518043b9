#include "dvi/objects/detect/detector.h"

#include <algorithm>
#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/core/threads.h"
#include "dvi/drive/outline.h"
#include "dvi/objects/detect/network.h"
#include "dvi/objects/detect/onnx_runtime.h"
#include "dvi/testing/test_models.h"

namespace dvi::objects {
namespace {

using testing::HasSubstr;
using testing::Not;

// Chooses the engine while it lives, by the value of DVI_ONNXRUNTIME.
class EngineChoice {
 public:
  explicit EngineChoice(const char* value) {
    if (const char* set = std::getenv(kVariable)) before_ = set;
    setenv(kVariable, value, 1);
  }
  ~EngineChoice() { before_.empty() ? unsetenv(kVariable) : setenv(kVariable, before_.c_str(), 1); }
  EngineChoice(const EngineChoice&) = delete;
  EngineChoice& operator=(const EngineChoice&) = delete;

 private:
  static constexpr const char* kVariable = "DVI_ONNXRUNTIME";
  std::string before_;
};

const cv::Vec3b kMagenta(255, 0, 255), kCyan(255, 255, 0);

class DetectorModels : public testing::Test {
 protected:
  void SetUp() override {
    if (!make_test_models(folder.path)) GTEST_SKIP() << "needs Python with onnx (Debian's python3-onnx)";
  }
  fs::path write_description(const std::string& name, const std::string& text) const {
    folder.write(name + ".toml", text);
    return folder.path / (name + ".onnx");
  }
  std::string load_error(const std::string& name, const std::string& text) const {
    const fs::path model = write_description(name, text);
    return input_error([&] { const Detector detector(model); });
  }

  const TempFolder folder;
};

cv::Mat3b picture(cv::Rect car, cv::Rect person) {
  cv::Mat3b image(64, 64, cv::Vec3b(90, 100, 80));
  image(car) = kMagenta;
  image(person) = kCyan;
  return image;
}

// A head, and whether it shows masks or boxes.
struct TestModel {
  const char* name;
  bool has_background = false, has_metadata = false, is_box = false;
  int tolerance_px = 0;  // for the sides of boxes, whose logits or masks are coarse
};
constexpr TestModel kModels[] = {{"semantic", true},
                                 {"ids", true},
                                 {"segformer", true, false, false, 1},
                                 {"yolov5", false, false, true},
                                 {"yolov5-seg"},
                                 {"yolov8", false, true, true},
                                 {"yolov8-seg", false, true},
                                 {"yolov8-cut"},
                                 {"yolo26-cut"},
                                 {"yolo26", false, true, true},
                                 {"yolo26-seg", false, true},
                                 {"rtdetr", false, true, true},
                                 {"rtdetr-hf", false, false, true},
                                 {"rtdetr-scaled", false, false, true},
                                 {"fasterrcnn", true, false, true},
                                 {"maskrcnn", true, false, false, 2}};
const cv::Rect kCar(16, 16, 16, 16), kPerson(48, 32, 16, 16);

void expect_objects(Detections found, const Detector& detector, const TestModel& head) {
  ASSERT_EQ(found.size(), 2U);
  if (found[0].type > found[1].type) std::swap(found[0], found[1]);
  EXPECT_EQ(detector.classes()[static_cast<std::size_t>(found[0].type)], "car");
  EXPECT_EQ(detector.classes()[static_cast<std::size_t>(found[1].type)], "person");
  const auto differ = [](cv::Rect a, cv::Rect b) {
    return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.br().x - b.br().x), std::abs(a.br().y - b.br().y)});
  };
  EXPECT_LE(differ(found[0].box, kCar), head.tolerance_px) << found[0].box;
  EXPECT_LE(differ(found[1].box, kPerson), head.tolerance_px) << found[1].box;
  for (const Detection& object : found) {
    EXPECT_EQ(object.is_box, head.is_box);
    EXPECT_GE(cv::countNonZero(object.mask), object.box.area() - 4) << "outlines are coarse: corners may be missing";
  }
}

// The version of the operators for which exporters write the networks.
class DetectorHeads : public testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    if (!make_test_models(folder.path, GetParam())) GTEST_SKIP() << "needs Python with onnx (Debian's python3-onnx)";
    for (const TestModel& head : kModels)
      if (!head.has_metadata)
        folder.write(std::string(head.name) + ".toml", test_description(head.has_background, "size = [64, 64]\n"));
  }
  const TempFolder folder;
};

TEST_P(DetectorHeads, AreRecognizedByOnnxRuntime) {
  if (!OnnxRuntime::of_process()) GTEST_SKIP() << "needs ONNX Runtime (DVI_ONNXRUNTIME=FILE)";
  for (const TestModel& head : kModels) {
    SCOPED_TRACE(head.name);
    const Detector detector(folder.path / (std::string(head.name) + ".onnx"));
    EXPECT_THAT(detector.engine(), HasSubstr("ONNX Runtime"));
    expect_objects(detector.detect({picture(kCar, kPerson)}).front(), detector, head);
  }
}

TEST_P(DetectorHeads, GiveTheSameMasksWithBothEngines) {
  if (!OnnxRuntime::of_process()) GTEST_SKIP() << "needs ONNX Runtime (DVI_ONNXRUNTIME=FILE)";
  std::vector<std::string> loaded;
  for (const TestModel& head : kModels) {
    SCOPED_TRACE(head.name);
    const fs::path model = folder.path / (std::string(head.name) + ".onnx");
    std::vector<Detections> with_opencv;
    try {
      const EngineChoice opencv("off");
      const Detector detector(model);
      with_opencv = detector.detect({picture(kCar, kPerson)});
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr("install ONNX Runtime"));
      continue;
    }
    loaded.emplace_back(head.name);
    const Detections found = Detector(model).detect({picture(kCar, kPerson)}).front();
    ASSERT_EQ(found.size(), with_opencv.front().size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].box, with_opencv.front()[i].box);
      EXPECT_EQ(cv::norm(found[i].mask, with_opencv.front()[i].mask), 0);
    }
  }
  for (const char* name : {"semantic", "yolov5", "yolov5-seg", "yolov8-cut", "rtdetr"})
    EXPECT_THAT(loaded, testing::Contains(name));
  RecordProperty("loaded_by_opencv", ::testing::PrintToString(loaded));
}

INSTANTIATE_TEST_SUITE_P(Opsets, DetectorHeads, testing::Values(11, 12, 13, 17, 18, 20));

TEST_F(DetectorModels, DetectTheSameWithAnyNumberOfThreads) {
  const Detector detector(write_description("semantic", test_description(true)));
  cv::Mat3b noise(200, 300);
  for (int y = 0; y < noise.rows; ++y)
    for (int x = 0; x < noise.cols; ++x)
      noise(y, x) =
          (x / 20 + y / 20) % 3 == 0 ? kMagenta : cv::Vec3b(cv::saturate_cast<uchar>(x % 256), cv::saturate_cast<uchar>(y), 90);
  const auto detect = [&](int threads) {
    const ThreadLimit limit(threads);
    return detector.detect({noise, noise, noise});
  };
  const std::vector<Detections> one = detect(1), many = detect(4);
  ASSERT_FALSE(one.front().empty());
  for (std::size_t i = 0; i < one.size(); ++i) {
    ASSERT_EQ(one[i].size(), many[i].size());
    for (std::size_t k = 0; k < one[i].size(); ++k) {
      EXPECT_EQ(one[i][k].box, many[i][k].box);
      EXPECT_EQ(cv::norm(one[i][k].mask, many[i][k].mask), 0);
    }
  }
}

TEST_F(DetectorModels, MissAFrameThatIsInterpolated) {
  const Detector detector(write_description("semantic", test_description(true)));
  Drive drive;
  for (int i = 0; i < 5; ++i) {
    Frame frame;
    frame.time_ns = i * 100'000'000;
    drive.frames.push_back(frame);
  }
  const auto at = [](std::size_t i) { return cv::Rect(4 + 6 * static_cast<int>(i), 20, 12, 10); };
  drive.images = {5, [&](std::size_t i) { return i == 2 ? picture({}, {}) : picture(at(i), {}); }};
  std::size_t ticks = 0;
  const FrameLabels labels = detect_objects(drive, detector, [&] { ++ticks; });
  EXPECT_EQ(ticks, 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    ASSERT_EQ(labels[i].size(), 1U) << i;
    EXPECT_EQ(labels[i][0].type, "car");
    EXPECT_EQ(labels[i][0].track, 0);
    cv::Mat1b mask(64, 64, uchar{0}), truth(64, 64, uchar{0});
    draw(labels[i][0].instance.value(), mask);
    truth(at(i)) = 255;
    EXPECT_EQ(cv::norm(mask, truth), 0) << i;
  }
}

TEST_F(DetectorModels, DetectTheChosenClasses) {
  Detector detector(write_description("semantic", test_description(true)));
  detector.choose({"person"});
  const Detections found = detector.detect({picture(kCar, kPerson)}).front();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].box, kPerson);
  EXPECT_THAT(input_error([&] { detector.choose({"bus"}); }),
              HasSubstr("none of its classes is removed; it has street, car, person"));
}

TEST_F(DetectorModels, ThatOpenCvCannotRunAreRejectedWithTheirNode) {
  const EngineChoice opencv("off");
  const std::string text = load_error("topk", test_description(true));
  EXPECT_THAT(text, HasSubstr("topk.onnx: OpenCV's dnn " CV_VERSION " cannot run node 'head/top' (TopK)"));
  EXPECT_THAT(text, HasSubstr("install ONNX Runtime"));
  EXPECT_THAT(text, HasSubstr("--masks"));
  EXPECT_THAT(text, Not(HasSubstr("onnx_node")));
  EXPECT_THAT(load_error("fixed", test_description(true, "size = [128, 64]\n")),
              HasSubstr("cannot run node 'head/flatten' (Reshape) on an input of 1x3x64x128"));
}

TEST_F(DetectorModels, NeedAllOfTheirFiles) {
  const fs::path model = write_description("separate", test_description(true));
  {
    const EngineChoice opencv("off");
    EXPECT_THAT(input_error([&] { const Detector detector(model); }), HasSubstr("its weights are in another file"));
  }
  if (OnnxRuntime::of_process()) {
    const Detector detector(model);
    EXPECT_EQ(detector.files().size(), 3U) << "network, weights, description";
    EXPECT_EQ(detector.detect({picture(kCar, kPerson)}).front().size(), 2U);
  }
  fs::remove(folder.path / "separate.data");
  EXPECT_THAT(input_error([&] { const Detector detector(model); }), HasSubstr("separate.data, which does not exist"));
}

TEST_F(DetectorModels, WithOtherShapesOrDamagedFilesAreRejected) {
  EXPECT_THAT(load_error("yolov8-cut", test_description(true)), HasSubstr("its outputs are unknown: boxes 1x64x4x4"));
  EXPECT_THAT(load_error("semantic", test_description(false, "", "kind = \"yolov5\"\n")),
              HasSubstr("its outputs are logits 1x3x64x64, and kind \"yolov5\" with 2 classes expects 1xNx7"));
  EXPECT_THAT(load_error("semantic", test_description(true, "", "names = [\"ids\"]\n")),
              HasSubstr("has no output 'ids'; it has logits"));
  EXPECT_THAT(load_error("semantic", test_description(true, "size = [32, 64]\n")),
              HasSubstr("[input] 'size' is 32x64, but the network takes images of 64x64"));
  EXPECT_THAT(load_error("classifier", test_description(false)), HasSubstr("is a classifier"));
  const std::string whole = read_file(folder.path / "semantic.onnx");
  folder.write("cut.onnx", whole.substr(0, whole.size() / 2));
  folder.write("text.onnx", "no network at all");
  folder.write("empty.onnx", "");
  for (const char* name : {"cut", "text", "empty"})
    EXPECT_THAT(load_error(name, test_description(true)), HasSubstr("is not an ONNX file, or is damaged")) << name;
  EXPECT_THAT(input_error([] { const Detector detector("nowhere.onnx"); }), HasSubstr("nowhere.onnx"));
  fs::remove(folder.path / "ids.toml");
  EXPECT_THAT(input_error([&] { const Detector detector(folder.path / "ids.onnx"); }),
              HasSubstr("has no names of its classes in its metadata; its outputs are ids 1x64x64"));
}

TEST(ImporterError, NamesTheNode) {
  EXPECT_EQ(summarize_importer_error(
                "OpenCV(4.6.0) ./a.cpp:1040: error: (-2:Unspecified error) in function 'handleNode'\n> Node "
                "[TopK@ai.onnx]:(onnx_node!best) parse error: OpenCV(4.6.0) ./b.hpp:110: error: (-2:Unspecified error) Can't "
                "create layer \"onnx_node!best\" of type \"TopK\" in function 'getLayerInstance'\n> "),
            "node 'best' (TopK): Can't create layer \"best\" of type \"TopK\"");
  EXPECT_EQ(summarize_importer_error(
                "OpenCV(4.6.0) ./a.cpp:1: error: (-2:Unspecified error) in function 'f'\n> Node "
                "[X@ai.onnx]:(onnx_node_output_0!y) parse error: OpenCV(4.6.0) ./b.hpp:1: error: (-215:Assertion failed) a > 0 "
                "in function 'g'\n"),
            "node 'y' (X): a > 0");
  EXPECT_EQ(summarize_importer_error("something else"), "something else");
}

}  // namespace
}  // namespace dvi::objects
