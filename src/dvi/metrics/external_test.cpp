#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "dvi/core/error.h"
#include "dvi/metrics/test_result.h"

namespace dvi::metrics {
namespace {

using testing::HasSubstr;

class External : public ResultFixture {
 protected:
  External() {
    make_folder(folder / "net");
    for (int i = 0; i < 3; ++i)
      add(std::to_string(i), {make_scene(kSize, i), make_scene(kSize, i + 0.5), box(kHole), box({30, 20, 20, 30}, 1)});
  }
  void add_external(const cv::Mat3b& (*change)(cv::Mat3b&)) const {
    for (int i = 0; i < 3; ++i) {
      cv::Mat3b image = make_scene(kSize, i + 0.5);
      media::write_png(folder / "net" / (std::to_string(i) + ".png"), change(image));
    }
  }
  EvaluationFolders with_net() const { return {folder / "out", folder / "truth", {}, {{"net", folder / "net"}}}; }
};

TEST_F(External, TheSameFramesHaveTheSameFigures) {
  add_external([](cv::Mat3b& image) -> const cv::Mat3b& { return image; });
  const nlohmann::json json = evaluate(with_net());
  nlohmann::json own = json;
  own["external"] = nlohmann::json::object();
  EXPECT_GT(own["all"]["mae"], 1);
  EXPECT_EQ(json["external"]["net"].dump(), own.dump());
}

TEST_F(External, AreReplacedByTheInputOutsideTheMasks) {
  add_external([](cv::Mat3b& image) -> const cv::Mat3b& {
    const cv::Mat3b inside = image(kHole).clone();
    image = cv::Mat3b(kSize, cv::Vec3b(0, 0, 255));
    inside.copyTo(image(kHole));
    return image;
  });
  const Evaluation e = evaluate(with_net());
  EXPECT_EQ(nlohmann::json(e.external[0].evaluation)["all"].dump(), nlohmann::json(e)["all"].dump());
  EXPECT_EQ(e.external[0].evaluation.whole_frame.ssim, e.whole_frame.ssim);
}

TEST_F(External, AreScoredInsideTheGivenMasks) {
  add_external([](cv::Mat3b& image) -> const cv::Mat3b& { return image = cv::Mat3b(kSize, cv::Vec3b(0, 0, 255)); });
  make_folder(folder / "scored");
  for (const char* name : {"0.png", "1.png", "2.png"}) media::write_png(folder / "scored" / name, box({0, 0, 10, 10}));
  EvaluationFolders given = with_net();
  given.masks = folder / "scored";
  const Evaluation e = evaluate(given);
  EXPECT_EQ(e.external[0].evaluation.total[Origin::all].pixels, 300U);
  EXPECT_GT(e.external[0].evaluation.total[Origin::all].mae, 10);
}

TEST_F(External, HaveRowsButNoConfidence) {
  make_folder(folder / "out/confidence");
  for (int i = 0; i < 3; ++i) {
    const std::string name = std::to_string(i);
    media::write_png(folder / "out/confidence" / (name + ".png"), cv::Mat1b(kSize, uchar{200}));
    cv::imwrite((folder / "net" / (name + ".jpg")).string(), make_scene(kSize, i));  // nearly the truth
  }
  const Evaluation e = evaluate(with_net());
  EXPECT_TRUE(e.confidence[0]);
  const Evaluation& net = e.external.at(0).evaluation;
  EXPECT_FALSE(net.confidence[0]);
  EXPECT_LT(net.total[Origin::all].mae, 0.5 * e.total[Origin::all].mae);
  EXPECT_EQ(net.total[Origin::copied].pixels, e.total[Origin::copied].pixels);
  EXPECT_THAT(format_table(e), testing::ContainsRegex("whole frame(.|\n)*\nnet\n(.|\n)*whole frame"));
}

TEST_F(External, ReportErrors) {
  add_external([](cv::Mat3b& image) -> const cv::Mat3b& { return image; });
  fs::remove(folder / "net/0.png");
  EXPECT_THAT(error(with_net()), HasSubstr("net/0.png: is missing"));
  media::write_png(folder / "net/0.png", cv::Mat3b(10, 20, cv::Vec3b(0, 0, 0)));
  EXPECT_THAT(error(with_net()), HasSubstr("net/0.png: is 20x10 pixels instead of 96x72"));
  fs::remove_all(folder / "net");
  EXPECT_THAT(error(with_net()), HasSubstr("net: is not a folder"));

  EXPECT_EQ(parse_external({"a=b=c"})[0].folder, "b=c");
  for (const char* wrong : {"net", "=net", "net="}) EXPECT_THROW(parse_external({wrong}), UsageError) << wrong;
  EXPECT_THROW(parse_external({"a=b", "a=c"}), UsageError);
}

}  // namespace
}  // namespace dvi::metrics
