#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/core/files.h"
#include "dvi/media/image_file.h"
#include "program.h"

namespace dvi {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// Runs on recordings without scans, or without image files.
class OtherSources : public ProgramTest {
 protected:
  void copy(const std::string& from, const std::string& to) const {
    make_folder((folder / to).parent_path());
    fs::copy(folder / from, folder / to, fs::copy_options::recursive);
  }
  /// Returns the mean difference of the frames of two results in gray levels.
  double difference(const std::string& a, const std::string& b) const {
    double sum = 0;
    const auto files = list_files(folder / a / "frames", {".png"});
    for (const fs::path& file : files)
      sum += cv::norm(media::read_image(file, kSize), media::read_image(folder / b / "frames" / file.filename(), kSize),
                      cv::NORM_L1) /
             (3 * kSize.area());
    return sum / static_cast<double>(files.size());
  }
};

TEST_F(OtherSources, AMapAndPosesReplaceScans) {
  small_drive();
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  ASSERT_EQ(dvi("export colmap out -o model --quiet").code, 0);
  ASSERT_EQ(dvi("export las out -o las --quiet").code, 0);
  copy("drive/images/front", "work/images");
  copy("model/sparse", "work/sparse");
  copy("las/map.las", "work/map.las");
  const Result unmasked = dvi("run work -o nothing --quiet");
  EXPECT_EQ(unmasked.code, 3);
  EXPECT_THAT(unmasked.err, AllOf(HasSubstr("no scans in which moving objects could be found"), HasSubstr("give --masks")));
  copy("drive/masks/front", "work/masks/camera");
  EXPECT_THAT(dvi("check work --quiet").out,
              AllOf(HasSubstr("colmap"), HasSubstr("points, instead of scans"), HasSubstr("  ready")));
  const Result run = dvi("run work -o out_of_model --quiet");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_LT(difference("out", "out_of_model"), 0.4);
  EXPECT_EQ(dvi("audit out_of_model work --quiet").code, 0);

  ASSERT_EQ(dvi("convert work -o plain --quiet").code, 0);
  EXPECT_TRUE(fs::exists(folder / "plain/map.las"));
  ASSERT_EQ(dvi("run plain -o out_of_plain --quiet").code, 0);
  EXPECT_TRUE(contents(folder / "out_of_model/frames") == contents(folder / "out_of_plain/frames"));

  write_file(folder / "far.txt", "0 99999 0 0 0 0 0 1\n0.5 99999 1 0 0 0 0 1\n");
  const Result far = dvi("run plain -o far --poses far.txt --quiet");
  EXPECT_EQ(far.code, 3);
  EXPECT_THAT(far.err, HasSubstr("is near the path"));
}

TEST_F(OtherSources, AVideoIsReadAsImages) {
  const fs::path drive = small_drive();
  ASSERT_EQ(dvi("run drive -o out --quiet --set video.crf=0").code, 0);
  fs::remove_all(drive / "images/front");
  fs::copy(folder / "out/video.mp4", drive / "images/front.mp4");
  const Result run = dvi("run drive -o out_of_video --quiet");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_LT(difference("out", "out_of_video"), 4) << "chroma has half the resolution";
  EXPECT_EQ(dvi("audit out_of_video drive --quiet").code, 0);
  EXPECT_EQ(dvi("export video out_of_video -o side --beside --quiet").code, 3);
}

}  // namespace
}  // namespace dvi
