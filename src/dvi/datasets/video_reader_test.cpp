#include "dvi/media/video_reader.h"

#include <algorithm>
#include <vector>

#include "dvi/core/threads.h"
#include "dvi/datasets/reader.h"
#include "dvi/media/video.h"
#include "dvi/testing/image_folder.h"

namespace dvi::datasets {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr int kFrames = 40;  // more than one group of pictures of the encoder

// Returns the color of frame i, which differs from that of all others.
cv::Vec3b color_of(int i) { return {static_cast<uchar>(20 + 5 * i), static_cast<uchar>(230 - 5 * i), 120}; }

fs::path write_video(const fs::path& file, int frames = kFrames) {
  const media::VideoTarget target{file, {64, 48}, {.crf = 1, .encoder = "mpeg4"}};
  media::VideoWriter writer(target);
  media::SegmentEncoder segment(target);
  for (int i = 0; i < frames; ++i) segment.push(cv::Mat3b(48, 64, color_of(i)));
  writer.append(segment.finish());
  writer.finish();
  return file;
}

double off(const cv::Mat3b& image, int i) { return cv::norm(image - cv::Mat3b(image.size(), color_of(i)), cv::NORM_INF); }

TEST(VideoReader, DecodesFramesIdenticallyInAnyOrder) {
  const TestFolder folder;
  const media::VideoReader video(write_video(folder.path / "a.mp4"));
  EXPECT_EQ(video.size(), cv::Size(64, 48));
  ASSERT_EQ(video.times_ns().size(), static_cast<std::size_t>(kFrames));
  EXPECT_EQ(video.times_ns()[0], 0);
  EXPECT_EQ(video.times_ns()[3], 300'000'000);
  std::vector<cv::Mat3b> forward;
  for (int i = 0; i < kFrames; ++i) {
    forward.push_back(video[static_cast<std::size_t>(i)]);
    EXPECT_LE(off(forward.back(), i), 4) << i;
  }
  for (const int i : {39, 0, 25, 24, 13, 14, 1})
    EXPECT_EQ(cv::norm(video[static_cast<std::size_t>(i)], forward[static_cast<std::size_t>(i)], cv::NORM_INF), 0) << i;
  std::vector<double> differs(kFrames);
  parallel_for(differs.size(), [&](std::size_t i) {
    const std::size_t at = (17 * i) % kFrames;
    differs[at] = cv::norm(video[at], forward[at], cv::NORM_INF);
  });
  EXPECT_EQ(*std::max_element(differs.begin(), differs.end()), 0);
}

TEST(VideoReader, RefusesTruncatedFilesAndOtherFiles) {
  const TestFolder folder;
  const std::string bytes = read_file(write_video(folder.path / "a.mp4"));
  const auto error = [&](const std::string& content) {
    return input_error([&] { media::VideoReader{folder.write("b.mp4", content)}; });
  };
  EXPECT_THAT(error("no video"), HasSubstr("is not a video that can be read"));
  EXPECT_THAT(error(""), HasSubstr("b.mp4"));
  EXPECT_THAT(error(bytes.substr(0, bytes.size() * 3 / 4)), AllOf(HasSubstr("of its 40 frames"), HasSubstr("is truncated")));
}

class FolderWithVideo : public testing::Test {
 protected:
  FolderWithVideo() {
    folder.write("dvi.toml",
                 "[drive]\nversion = 1\n[camera.front]\nK = [60, 0, 32, 0, 60, 24, 0, 0, 1]\n"
                 "camera_from_lidar = [0, -1, 0, 0,  0, 0, -1, 0,  1, 0, 0, 0]\n");
    make_folder(folder.path / "images");
    write_video(folder.path / "images/front.mp4", 3);
    for (const char* name : {"0", "1", "2"}) folder.write_bin(std::string("lidar/") + name + ".bin", {1, 0, 0, 0});
  }
  std::string error() const {
    return input_error([&] { datasets::read_drive(folder.path); });
  }
  TestFolder folder;
};

TEST_F(FolderWithVideo, HasTimesOfTheContainerOrOfAFile) {
  folder.write_image("masks/front/000001.png", cv::Mat1b(48, 64, uchar{1}));
  const Drive drive = datasets::read_drive(folder.path);
  ASSERT_EQ(drive.frames.size(), 3U);
  EXPECT_EQ(drive.frames[2].name, "000002");
  EXPECT_EQ(drive.frames[2].time_ns, 200'000'000);
  EXPECT_EQ(drive.scan_headers[2].time_ns, 200'000'000);
  EXPECT_LE(off(*drive.images[1], 1), 4);
  EXPECT_EQ((*drive.masks[1])(0, 0), 255);
  EXPECT_TRUE(drive.warnings.empty());
  folder.write("times/front.txt", "0\n0.125\n0.2\n");
  EXPECT_EQ(datasets::read_drive(folder.path).frames[1].time_ns, 125'000'000);
  folder.write("times/front.txt", "000000 0\n000001 0.25\n000002 0.5\n");
  EXPECT_EQ(datasets::read_drive(folder.path, {.frames = FrameRange{1, 2}}).frames[0].time_ns, 250'000'000);
}

TEST_F(FolderWithVideo, RefusesInconsistentTimesAndImages) {
  folder.write("times/front.txt", "5\n6\n");
  EXPECT_THAT(error(), HasSubstr("has 2 times, but front.mp4 has 3 frames"));
  fs::remove(folder.path / "times/front.txt");
  folder.write_image("images/front/000000.png", cv::Mat3b(48, 64, cv::Vec3b()));
  EXPECT_THAT(error(), HasSubstr("lies beside a folder of images"));
}

}  // namespace
}  // namespace dvi::datasets
