#include "dvi/synth/synth.h"

#include <gtest/gtest.h>

#include <atomic>
#include <map>

#include <opencv2/imgcodecs.hpp>

#include "dvi/core/error.h"
#include "dvi/core/threads.h"
#include "dvi/testing/temp_folder.h"

namespace dvi::synth {
namespace {

class Synth : public testing::Test {
 protected:
  void SetUp() override {
    options_.frames = 3;
    options_.width = 160;
    options_.height = 90;
    options_.beams = 8;
    options_.columns = 360;
  }

  const TempFolder temporary_;
  const fs::path folder_ = temporary_.path / "drive";
  SynthOptions options_;
};

TEST_F(Synth, WritesTheSameBytesWithAnyNumberOfThreads) {
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    synthesize(options_, folder_ / std::to_string(threads));
  }
  const auto one = contents(folder_ / "1"), two = contents(folder_ / "2");
  ASSERT_EQ(one.size(), 6U * 3 + 7);
  EXPECT_TRUE(one == two);
}

TEST_F(Synth, FilesAgreeWithTheScene) {
  std::atomic<int> ticks = 0;
  synthesize(options_, folder_, [&] { ++ticks; });
  EXPECT_EQ(ticks, 3);
  const Scene scene(options_);
  const SynthFrame rendered = scene.render(1);
  const SynthScan scan = scene.scan(1);
  const auto image = [&](const char* path) { return cv::imread((folder_ / path).string(), cv::IMREAD_UNCHANGED); };
  EXPECT_EQ(cv::norm(image("truth/000001.png"), rendered.clean, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(image("masks/front/000001.png"), scene.mask(rendered), cv::NORM_INF), 0);
  const cv::Mat depth = image("truth_depth/000001.png");
  ASSERT_EQ(depth.type(), CV_16U);
  cv::Mat1f meters;
  depth.convertTo(meters, CV_32F, 1.0 / 256);
  EXPECT_LT(cv::norm(meters, rendered.depth, cv::NORM_INF), 1.0 / 512 + 1e-6);
  EXPECT_EQ(fs::file_size(folder_ / "lidar/000001.bin"), 16 * scan.scan.size());
  EXPECT_EQ(fs::file_size(folder_ / "truth_points/000001.label"), 4 * scan.scan.size());
  const double noise = cv::norm(image("images/front/000001.png"), rendered.image, cv::NORM_L2) / std::sqrt(3.0 * 160 * 90);
  EXPECT_NEAR(noise, 1.5, 0.15);
  const std::vector<std::string> times = read_lines(folder_ / "times/front.txt");
  ASSERT_EQ(times.size(), 3U);
  EXPECT_EQ(times[1], "000001 1000.150000000");
}

TEST_F(Synth, EachCameraHasItsTruth) {
  options_.side_cameras = true;
  synthesize(options_, folder_);
  const Scene scene(options_);
  const std::string other = scene.cameras()[2].name;
  EXPECT_EQ(other, "side-right");
  const cv::Mat truth = cv::imread((folder_ / "truth" / other / "000001.png").string());
  EXPECT_EQ(cv::norm(truth, scene.render(1, 2).clean, cv::NORM_INF), 0);
  EXPECT_EQ(read_lines(folder_ / ("truth_cameras_" + other + ".txt")).size(), 3U);
  for (const char* folder : {"images", "masks", "truth_depth"})
    EXPECT_TRUE(fs::exists(folder_ / folder / other / "000002.png")) << folder;
}

TEST_F(Synth, HasDepthImagesInsteadOfScansInARoom) {
  options_.room = true;
  synthesize(options_, folder_);
  EXPECT_FALSE(fs::exists(folder_ / "lidar"));
  const Scene scene(options_);
  const cv::Mat depth = cv::imread((folder_ / "depth/color/000001.png").string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(depth.type(), CV_16U);
  EXPECT_EQ(cv::norm(depth, scene.depth_image(1, scene.render(1)), cv::NORM_INF), 0);
}

TEST_F(Synth, RefusesBadOptionsAndFolders) {
  SynthOptions bad = options_;
  bad.rate_hz = 0;
  EXPECT_THROW(synthesize(bad, folder_), UsageError);
  EXPECT_FALSE(fs::exists(folder_));
  EXPECT_THROW(synthesize(options_, "/proc/nowhere"), InputError);
}

}  // namespace
}  // namespace dvi::synth
