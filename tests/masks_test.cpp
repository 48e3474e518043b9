#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <map>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/media/image_file.h"
#include "dvi/media/write_image.h"
#include "program.h"

namespace dvi {
namespace {

using testing::HasSubstr;

class MasksOfDrives : public ProgramTest {
 protected:
  /// Makes a drive without masks and labels.
  fs::path unlabeled(const std::string& name) const {
    const fs::path drive = small_drive(name, "", 12);
    fs::remove_all(drive / "masks");
    fs::remove(drive / "boxes.json");
    return drive;
  }
  nlohmann::json json(const fs::path& file) const { return nlohmann::json::parse(read_file(folder / file)); }

  struct Overlap {
    double both = 0, wanted = 0, found = 0, pixels = 0;
  };
  /// Compares the masks that `dvi mask` wrote with the true masks, over all frames.
  Overlap overlap_with(const fs::path& truth) const {
    Overlap sum;
    for (const fs::directory_entry& file : fs::directory_iterator(truth)) {
      const cv::Mat1b wanted = media::read_mask(file.path(), kSize);
      const cv::Mat1b found = media::read_mask(folder / "masks/masks/front" / file.path().filename(), kSize);
      sum.both += cv::countNonZero(wanted & found);
      sum.wanted += cv::countNonZero(wanted);
      sum.found += cv::countNonZero(found);
      sum.pixels += static_cast<double>(found.total());
    }
    return sum;
  }
};

TEST_F(MasksOfDrives, ADriveWithoutMasksAndLabelsRuns) {
  unlabeled("drive");
  const Result check = dvi("check drive --quiet");
  EXPECT_EQ(check.code, 0) << check.err;
  EXPECT_THAT(check.out, HasSubstr("dvi run finds moving objects"));
  const Result run = dvi("run drive -o out --poses given --quiet");
  ASSERT_EQ(run.code, 0) << run.err;
  const nlohmann::json report = json("out/report.json");
  EXPECT_GT(report.at("hole").at("pixels").get<std::size_t>(), 0U);
  EXPECT_EQ(dvi("audit out drive --quiet").code, 0);
}

TEST_F(MasksOfDrives, LittleTrafficIsCopiedFromAnUnlabeledSourceDrive) {
  small_drive("drive", "--truck", 12);
  const fs::path source = small_drive("source", "--day 2", 12);
  fs::remove_all(source / "masks");
  fs::remove(source / "boxes.json");
  const Result run = dvi("run drive source -o out --poses given --quiet");
  ASSERT_EQ(run.code, 0) << run.err;
  const nlohmann::json sources = json("out/sources.json").at("sources");
  struct Picture {
    cv::Mat3b with_traffic, without;
  };
  std::map<std::string, Picture> pictures;
  std::size_t copied = 0, traffic = 0;
  for (const fs::directory_entry& file : fs::directory_iterator(folder / "out/provenance")) {
    const cv::Mat_<cv::Vec3w> provenance = media::read_unchanged(file.path(), kSize);
    for (const cv::Vec3w& bgr : provenance) {  // B y * 16, G x * 16, R source number + 1
      if (bgr[2] == 0) continue;
      const nlohmann::json& from = sources.at(bgr[2] - 1U);
      if (fs::path(from.at("drive").get<std::string>()).filename() != "source") continue;
      const std::string name = from.at("frame").get<std::string>() + ".png";
      Picture& picture = pictures[name];
      if (picture.without.empty())
        picture = {media::read_image(source / "images/front" / name, kSize), media::read_image(source / "truth" / name, kSize)};
      const cv::Point at(cvRound(bgr[1] / 16.0), cvRound(bgr[0] / 16.0));
      ++copied;
      traffic += cv::norm(picture.with_traffic(at), picture.without(at), cv::NORM_INF) > 15 ? 1 : 0;  // six sigma of its noise
    }
  }
  EXPECT_GT(copied, 1000U);
  EXPECT_LT(static_cast<double>(traffic), 0.05 * static_cast<double>(copied));
}

TEST_F(MasksOfDrives, CheckFailsWithoutScansMasksAndLabels) {
  const fs::path drive = unlabeled("drive");
  fs::remove_all(drive / "lidar");
  fs::remove(drive / "poses.txt");
  const Result check = dvi("check drive --quiet");
  EXPECT_EQ(check.code, 3) << "run refuses it, too";
  EXPECT_THAT(check.out, testing::Not(HasSubstr("finds moving objects")));
  EXPECT_THAT(check.out, HasSubstr("warning  neither masks, labels, nor scans show the objects to remove"));
  EXPECT_EQ(dvi("run drive -o out --quiet").code, 3);
}

TEST_F(MasksOfDrives, RunReadsTheMasksOfMask) {
  unlabeled("drive");
  const Result mask = dvi("mask drive -o masks --poses given --quiet");
  ASSERT_EQ(mask.code, 0) << mask.err;
  const nlohmann::json masks = json("masks/masks.json");
  EXPECT_EQ(masks.at("source"), "found");
  EXPECT_EQ(masks.at("frames").size(), 12U);
  ASSERT_FALSE(masks.at("tracks").empty());
  for (const nlohmann::json& track : masks.at("tracks")) EXPECT_TRUE(track.at("removed").get<bool>());
  ASSERT_EQ(dvi("run drive -o found --poses given --quiet").code, 0);
  ASSERT_EQ(dvi("run drive -o given --poses given --quiet --masks masks --set masks.shadows=false").code, 0);
  EXPECT_EQ(::dvi::contents(folder / "found/masks"), ::dvi::contents(folder / "given/masks"));
}

TEST_F(MasksOfDrives, PolygonsOfMaskAreItsMasks) {
  small_drive();
  for (const char* given : {"--masks labels", "--masks drive/masks/front"}) {
    fs::remove_all(folder / "masks");
    ASSERT_EQ(dvi(std::string("mask drive -o masks --poses given --quiet ") + given).code, 0);
    for (const char* file : {"masks/coco.json", "masks/annotations.xml"}) {
      fs::remove_all(folder / "back");
      const Result back = dvi(std::string("mask drive -o back --poses given --quiet --set masks.dilate_px=0 --set "
                                          "masks.shadows=false --set objects.complete=false --masks ") +
                              file);
      ASSERT_EQ(back.code, 0) << back.err;
      for (const auto& entry : fs::directory_iterator(folder / "masks/masks/front")) {
        const cv::Mat1b mask = media::read_mask(entry.path(), kSize);
        const cv::Mat1b read = media::read_mask(folder / "back/masks/front" / entry.path().filename(), kSize);
        EXPECT_GE(cv::countNonZero(mask & read), 0.99 * cv::countNonZero(mask | read)) << file << " " << entry.path();
      }
    }
  }
}

TEST_F(MasksOfDrives, MotionSegmentationCoversMovingObjects) {
  const fs::path truth = small_drive("labeled", "", 12) / "masks/front";
  unlabeled("drive");
  ASSERT_EQ(dvi("mask drive -o masks --poses given --quiet").code, 0);
  const Overlap overlap = overlap_with(truth);
  EXPECT_GT(overlap.both / overlap.wanted, 0.95);
  EXPECT_GT(overlap.both / overlap.found, 0.75);
}

TEST_F(MasksOfDrives, MaskOverwritesNoFile) {
  small_drive();
  const std::string call = "mask drive --masks labels --poses given --quiet -o ";
  make_folder(folder / "empty");
  ASSERT_EQ(dvi(call + "empty").code, 0);
  write_file(folder / "empty/masks/front/000002.png", "corrected");
  make_folder(folder / "mine");
  write_file(folder / "mine/thesis.tex", "years of work");
  const auto present = [&] {
    return std::array{::dvi::contents(folder / "drive"), ::dvi::contents(folder / "empty"), ::dvi::contents(folder / "mine")};
  };
  const auto before = present();
  const auto expect_refused = [&](const std::string& arguments, const std::string& word) {
    const Result result = dvi(arguments);
    EXPECT_EQ(result.code, 3) << arguments;
    EXPECT_THAT(result.err, HasSubstr(word)) << arguments;
  };
  for (const char* full : {"empty", "mine", "mine/thesis.tex"}) expect_refused(call + full, "not an empty folder");
  for (const char* input : {"drive", ".", "drive/new", "mine/../drive/images/front"})
    expect_refused(call + input, "input of the run");
  expect_refused("mask drive --quiet --masks empty/masks/front -o empty/masks/front/new", "input of the run");
  EXPECT_TRUE(present() == before);
}

TEST_F(MasksOfDrives, MovingLabelsAreRemovedAndOneFrameShowsNoMotion) {
  small_drive("labeled", "", 12);
  ASSERT_EQ(dvi("mask labeled -o masks --masks labels --poses given --remove moving --quiet").code, 0);
  const nlohmann::json masks = json("masks/masks.json");
  EXPECT_EQ(masks.at("source"), "labels");
  for (const nlohmann::json& track : masks.at("tracks")) EXPECT_EQ(track.at("moves"), track.at("removed"));
  unlabeled("drive");
  const Result one = dvi("mask drive -o one --poses given --frames 3");
  EXPECT_EQ(one.code, 0) << one.err;
  EXPECT_THAT(one.err, HasSubstr("its scans show no moving objects"));
}

TEST_F(MasksOfDrives, WithoutMovingObjectsTheResultIsTheInput) {
  const fs::path drive = small_drive("drive", "--speed-mps 0", 12);  // a van ahead is stationary, too
  fs::remove_all(drive / "masks");
  fs::remove(drive / "boxes.json");
  const Result run = dvi("run drive -o out");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("its scans show no moving objects"));
  EXPECT_EQ(json("out/report.json").at("hole").at("pixels"), 0);
  for (const fs::directory_entry& file : fs::directory_iterator(drive / "images/front"))
    EXPECT_EQ(cv::norm(media::read_image(file.path(), kSize),
                       media::read_image(folder / "out/frames" / file.path().filename(), kSize), cv::NORM_INF),
              0);
}

TEST_F(MasksOfDrives, TrafficIsFoundInTheScansAtNight) {
  const fs::path truth = small_drive("labeled", "", 12) / "masks/front";
  const fs::path drive = unlabeled("drive");
  for (const fs::directory_entry& file : fs::directory_iterator(drive / "images/front"))
    media::write_png(file.path(), cv::Mat3b(media::read_image(file.path(), kSize) * 0.02));
  ASSERT_EQ(dvi("mask drive -o masks --poses given --quiet").code, 0);
  const Overlap overlap = overlap_with(truth);
  EXPECT_GT(overlap.both / overlap.wanted, 0.8);
  EXPECT_LT(overlap.found / overlap.pixels, 0.3) << "not the whole road";
}

TEST_F(MasksOfDrives, ABaselineNeedsMasks) {
  unlabeled("drive");
  const Result run = dvi("run drive -o out --method telea --quiet");
  EXPECT_EQ(run.code, 3);
  EXPECT_THAT(run.err, HasSubstr("dvi mask"));
  EXPECT_FALSE(fs::exists(folder / "out"));
}

}  // namespace
}  // namespace dvi
