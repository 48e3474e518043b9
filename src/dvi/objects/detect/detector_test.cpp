#include "dvi/objects/detect/detector.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/core/threads.h"
#include "dvi/drive/outline.h"
#include "dvi/objects/detect/network.h"
#include "dvi/testing/test_models.h"

namespace dvi::objects {
namespace {

using testing::HasSubstr;
using testing::Not;

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

TEST_F(DetectorModels, OfAllLayoutsDetectTheObjects) {
  const cv::Rect car(8, 16, 16, 16), person(40, 32, 16, 16);
  for (const auto& [name, kind] : {std::pair{"semantic", "semantic"}, std::pair{"ids", "semantic"},
                                   std::pair{"yolov5", "yolov5-seg"}, std::pair{"yolov8", "yolov8-seg"}}) {
    const bool semantic = std::string(kind) == "semantic";
    const Detector detector(write_description(name, test_description(kind, "", semantic ? "" : "nms = 0.3")));
    Detections found = detector.detect({picture(car, person)}).front();
    ASSERT_EQ(found.size(), 2U) << name;
    if (found[0].type > found[1].type) std::swap(found[0], found[1]);
    EXPECT_EQ(detector.classes()[static_cast<std::size_t>(found[0].type)], "car");
    EXPECT_EQ(detector.classes()[static_cast<std::size_t>(found[1].type)], "person");
    EXPECT_EQ(found[0].box, car) << name;
    EXPECT_EQ(found[1].box, person) << name;
    EXPECT_GE(cv::countNonZero(found[0].mask), car.area() - 4) << "YOLO's outlines are coarse: corners may be missing";
  }
}

TEST_F(DetectorModels, DetectTheSameWithAnyNumberOfThreads) {
  const Detector detector(write_description("semantic", test_description("semantic")));
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
  const Detector detector(write_description("semantic", test_description("semantic")));
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

TEST_F(DetectorModels, ThatOpenCvCannotRunAreRejectedWithTheirNode) {
  const std::string text = load_error("topk", test_description("semantic"));
  EXPECT_THAT(text, HasSubstr("topk.onnx: OpenCV's dnn " CV_VERSION " cannot run node 'head/top' (TopK)"));
  EXPECT_THAT(text, HasSubstr("docs/detector.md"));
  EXPECT_THAT(text, Not(HasSubstr("onnx_node")));
  const std::string larger = "[input]\nsize = [128, 64]\n" + test_description("semantic").substr(25);
  EXPECT_THAT(load_error("fixed", larger), HasSubstr("cannot run node 'head/flatten' (Reshape) on an input of 1x3x64x128"));
}

TEST_F(DetectorModels, WithOtherShapesOrDamagedFilesAreRejected) {
  EXPECT_THAT(load_error("yolov8", test_description("semantic")),
              HasSubstr("kind \"semantic\" with 3 classes expects 1x3xHxW"));
  EXPECT_THAT(load_error("semantic", test_description("yolov5-seg")), HasSubstr("its outputs are 1x3x64x64, and kind"));
  EXPECT_THAT(load_error("semantic", test_description("semantic", "", "names = [\"ids\"]")),
              HasSubstr("has no output 'ids'; it has logits"));
  const std::string whole = read_file(folder.path / "semantic.onnx");
  folder.write("cut.onnx", whole.substr(0, whole.size() / 2));
  folder.write("text.onnx", "no network at all");
  folder.write("empty.onnx", "");
  for (const char* name : {"cut", "text", "empty"})
    EXPECT_THAT(load_error(name, test_description("semantic")), HasSubstr("is not an ONNX file, or is damaged")) << name;
  EXPECT_THAT(input_error([] { const Detector detector("nowhere.onnx"); }), HasSubstr("nowhere.onnx"));
  fs::remove(folder.path / "ids.toml");
  EXPECT_THAT(input_error([&] { const Detector detector(folder.path / "ids.onnx"); }), HasSubstr("ids.toml: does not exist"));
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
