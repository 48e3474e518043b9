// Runs on frames and masks with little information: the run succeeds, the colors are plausible, and the summary states how the
// holes are filled.

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/media/image_file.h"
#include "dvi/media/write_image.h"
#include "program.h"

namespace dvi {
namespace {

using testing::HasSubstr;

class OddFrames : public ProgramTest {
 protected:
  fs::path file(const std::string& kind, int frame) const { return folder / kind / ("00000" + std::to_string(frame) + ".png"); }
  cv::Mat3b image(int frame) const { return media::read_image(file("drive/images/front", frame), kSize); }
  cv::Mat1b mask(int frame) const { return media::read_png_gray(file("drive/masks/front", frame), kSize); }

  /// Returns the mean of the filled pixels over all channels.
  double filled_mean(int frame) const {
    const cv::Mat3b filled = media::read_image(file("out/frames", frame), kSize);
    const cv::Mat1b kind = media::read_png_gray(file("out/kind", frame), kSize);
    EXPECT_EQ(cv::countNonZero(kind), cv::countNonZero(mask(frame))) << "frame " << frame << ": every pixel is filled";
    const cv::Scalar mean = cv::mean(filled, cv::Mat1b(kind > 0));
    return (mean[0] + mean[1] + mean[2]) / 3;
  }
};

TEST_F(OddFrames, FramesAreBlackWhiteOrDarkAndMasksWholeOrInStripes) {
  small_drive();
  media::write_png(file("drive/images/front", 0), cv::Mat3b(kSize, cv::Vec3b(0, 0, 0)));
  media::write_png(file("drive/images/front", 1), cv::Mat3b(kSize, cv::Vec3b(255, 255, 255)));
  media::write_png(file("drive/images/front", 2), cv::Mat3b(image(2) / 12));
  media::write_png(file("drive/masks/front", 3), cv::Mat1b(kSize, uchar{255}));
  cv::Mat1b cut = mask(4);
  for (int x = 0; x < cut.cols; x += 16) cut.colRange(x, x + 8).setTo(0);
  media::write_png(file("drive/masks/front", 4), cut);
  const Result run =
      dvi("run drive -o out --poses given --masks drive/masks/front --set masks.shadows=false "
          "--set objects.complete=false");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("% unobserved ("));
  EXPECT_THAT(run.out, HasSubstr("% synthesized"));
  EXPECT_LT(filled_mean(0), 60);
  EXPECT_GT(filled_mean(1), 195);
  EXPECT_LT(filled_mean(2), 60);
  EXPECT_GT(filled_mean(3), 30);
  EXPECT_LT(filled_mean(3), 225);
  EXPECT_GT(filled_mean(4), 30);
  EXPECT_LT(filled_mean(4), 225);
}

// Without other frames, the holes are unobserved, and the summary states it.
TEST_F(OddFrames, ADriveOfOneOrTwoFramesRuns) {
  small_drive();
  for (const int last : {0, 1}) {
    const std::string out = "out" + std::to_string(last);
    const Result run = dvi("run drive -o " + out + " --frames 0:" + std::to_string(last));
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("% unobserved ("));
    EXPECT_EQ(list_files(folder / out / "frames", {".png"}).size(), static_cast<std::size_t>(last) + 1);
    EXPECT_EQ(dvi("audit " + out + " drive").code, 0);
  }
}

}  // namespace
}  // namespace dvi
