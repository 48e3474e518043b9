#include <algorithm>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/core/files.h"
#include "dvi/media/image_file.h"
#include "dvi/media/write_image.h"
#include "program.h"

namespace dvi {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr uchar kOtherCamera = 2;

class Rig : public ProgramTest {
 protected:
  fs::path stereo_drive() const { return small_drive("drive", "--stereo-m 0.5 --truck"); }
  /// Returns the provenance of a frame, and its first pixel that was copied from another camera.
  std::pair<fs::path, cv::Point> first_copied_elsewhere(const std::string& out) const {
    for (const fs::path& file : frames(out)) {
      const cv::Mat1b kind = read(folder / out / "kind" / file.filename());
      for (int y = 0; y < kind.rows; ++y)
        for (int x = 0; x < kind.cols; ++x)
          if (kind(y, x) == kOtherCamera) return {folder / out / "provenance" / file.filename(), {x, y}};
    }
    ADD_FAILURE() << "no pixel was copied from another camera";
    return {};
  }
  nlohmann::json cameras_of(const std::string& out) const {
    return nlohmann::json::parse(read_file(folder / out / "report.json")).at("drives").at(0).at("other_cameras");
  }
  std::vector<fs::path> frames(const std::string& out) const { return list_files(folder / out / "frames", {".png"}); }
  cv::Mat read(const fs::path& file) const { return cv::imread(file.string(), cv::IMREAD_UNCHANGED); }

  struct CopiedElsewhere {
    int pixels = 0;
    double error = 0;  ///< mean, in gray levels
  };
  /// Compares the pixels copied from the other camera with the true background.
  CopiedElsewhere score_copied_elsewhere(const std::string& out) const {
    CopiedElsewhere sum;
    for (const fs::path& file : frames(out)) {
      const cv::Mat1b kind = read(folder / out / "kind" / file.filename());
      const cv::Mat3b frame = read(file), truth = read(folder / "drive/truth" / file.filename());
      for (int y = 0; y < kind.rows; ++y)
        for (int x = 0; x < kind.cols; ++x)
          if (kind(y, x) == kOtherCamera) {
            ++sum.pixels;
            sum.error += cv::norm(frame(y, x) - truth(y, x), cv::NORM_L1) / 3;
          }
    }
    sum.error /= std::max(1, sum.pixels);
    return sum;
  }

  /// Makes a drive with labels for the view of the first camera only. `change` edits the label of the truck in each frame.
  template <class Change>
  void label_truck_by(const Change& change) const {
    stereo_drive();
    const fs::path file = folder / "drive/boxes.json";
    nlohmann::json boxes = nlohmann::json::parse(read_file(file));
    boxes["camera"] = "front";
    for (auto& [name, labels] : boxes["frames"].items())
      for (nlohmann::json& label : labels)
        if (label["class"] == "truck") change(label, folder / "drive/masks/front" / (name + ".png"));
    write_file(file, boxes.dump());
    fs::remove_all(folder / "drive/masks");
  }

  void expect_masked_by_labels() const {
    ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
    EXPECT_EQ(cameras_of("out")[0]["masks"], "labels");
    const CopiedElsewhere found = score_copied_elsewhere("out");
    EXPECT_GT(found.pixels, 100);
    EXPECT_LT(found.error, 20) << "no traffic is copied";
    const Result audit = dvi("audit out drive");
    EXPECT_EQ(audit.code, 0) << audit.out << audit.err;
  }

  /// Expects that a damaged image ends the run with a message that contains its name.
  void expect_refused_if_damaged(const std::string& image) const {
    write_file(stereo_drive() / "images" / image, "damaged");
    const Result run = dvi("run drive -o out --quiet");
    EXPECT_EQ(run.code, 3);
    EXPECT_THAT(run.err, HasSubstr(image));
    EXPECT_THAT(run.err, Not(HasSubstr("front")));
  }
};

TEST_F(Rig, TheOtherCameraIsASource) {
  stereo_drive();
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  ASSERT_EQ(cameras_of("out").size(), 1U);
  EXPECT_EQ(cameras_of("out")[0]["camera"], "right");
  EXPECT_EQ(cameras_of("out")[0]["masks"], "files");
  const CopiedElsewhere found = score_copied_elsewhere("out");
  EXPECT_GT(found.pixels, 100);
  EXPECT_LT(found.error, 20);
  const Result audit = dvi("audit out drive");
  EXPECT_EQ(audit.code, 0) << audit.out << audit.err;
  EXPECT_THAT(read_file(folder / "out/sources.json"), HasSubstr("\"camera\": \"right\""));
}

TEST_F(Rig, MasksAreReprojectedToACameraWithoutMasks) {
  stereo_drive();
  fs::remove_all(folder / "drive/masks/right");
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  EXPECT_EQ(cameras_of("out")[0]["masks"], "reprojected");
  const CopiedElsewhere found = score_copied_elsewhere("out");
  EXPECT_GT(found.pixels, 100);
  EXPECT_LT(found.error, 20) << "no traffic is copied";
  EXPECT_EQ(dvi("audit out drive").code, 0);
}

// The labels cover the view of the first camera only.
TEST_F(Rig, LabeledBoxesOfTheFirstCameraMaskTheOther) {
  label_truck_by([](nlohmann::json&, const fs::path&) {});
  expect_masked_by_labels();
}

TEST_F(Rig, LabelsWithoutABoxAreReprojected) {
  label_truck_by([&](nlohmann::json& truck, const fs::path& mask) {
    cv::Mat labels, stats, centers;
    cv::connectedComponentsWithStats(cv::Mat1b(read(mask)), labels, stats, centers);
    cv::Mat1i areas = stats.rowRange(1, stats.rows).col(cv::CC_STAT_AREA).clone();
    const auto largest = static_cast<int>(std::max_element(areas.begin(), areas.end()) - areas.begin()) + 1;
    const int* s = stats.ptr<int>(largest);
    truck = {{"track", truck["track"]}, {"class", truck["class"]}, {"rect", {s[0], s[1], s[2], s[3]}}};
  });
  expect_masked_by_labels();
}

TEST_F(Rig, AuditChecksTheMasksOfTheOtherCamera) {
  stereo_drive();
  fs::rename(folder / "drive/masks/right", folder / "originals");
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  ASSERT_EQ(cameras_of("out")[0]["masks"], "reprojected");
  const nlohmann::json sources = nlohmann::json::parse(read_file(folder / "out/sources.json")).at("sources");
  const auto [picture, p] = first_copied_elsewhere("out");
  cv::Mat_<cv::Vec3w> provenance = media::read_png_triples(picture, kSize);
  const std::size_t source = provenance(p)[0] - 1U;
  ASSERT_EQ(sources.at(source).at("camera"), "right");
  const fs::path kept = folder / "out/.dvi/masks" / fmt::format("{:06d}.png", source);
  std::vector<cv::Point> masked;
  cv::findNonZero(cv::Mat1b(read(kept)), masked);
  ASSERT_FALSE(masked.empty());
  // The reprojected mask covers most of the truck.
  const cv::Mat1b true_mask = read(folder / "originals" / (sources.at(source).at("frame").get<std::string>() + ".png"));
  EXPECT_GT(cv::countNonZero(cv::Mat1b(read(kept) & true_mask)), cv::countNonZero(true_mask) / 2);

  provenance(p) = {provenance(p)[0], static_cast<ushort>(masked.front().x * 16), static_cast<ushort>(masked.front().y * 16)};
  media::write_png(picture, provenance);
  const Result audit = dvi("audit out drive --json --quiet");
  EXPECT_EQ(audit.code, 3);
  EXPECT_EQ(nlohmann::json::parse(audit.out).at("findings").at("masked_source").at("pixels"), 1);

  fs::remove(kept);
  const Result missing = dvi("audit out drive --quiet");
  EXPECT_EQ(missing.code, 3);
  EXPECT_THAT(missing.err, HasSubstr(kept.filename().string()));
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  EXPECT_EQ(dvi("audit out drive").code, 0) << "the run writes missing masks again";
}

TEST_F(Rig, FindsTheTrafficOfAllCamerasInTheScans) {
  stereo_drive();
  for (const char* given : {"masks", "boxes.json"}) fs::remove_all(folder / "drive" / given);
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  EXPECT_EQ(cameras_of("out")[0]["masks"], "found");
}

TEST_F(Rig, VirtualTrafficIsVisibleInAllCameras) {
  stereo_drive();
  ASSERT_EQ(dvi("holdout drive --scenario lead --camera right -o case --quiet").code, 0);
  for (const char* camera : {"front", "right"})
    EXPECT_EQ(list_files(folder / "case/drive/images" / camera, {".png"}).size(), 6U) << camera;
  ASSERT_EQ(dvi("run case/drive -o out --quiet").code, 0);
  const nlohmann::json drive = nlohmann::json::parse(read_file(folder / "out/report.json")).at("drives").at(0);
  EXPECT_EQ(drive["camera"], "right") << "the one whose truth is known";
  ASSERT_EQ(drive["other_cameras"].size(), 1U);
  EXPECT_EQ(drive["other_cameras"][0]["masks"], "files");
  EXPECT_EQ(dvi("eval out --truth case/truth --ignore case/ignore --quiet").code, 0);
}

TEST_F(Rig, SourcesSelectsTheCameras) {
  stereo_drive();
  ASSERT_EQ(dvi("run drive -o out --quiet --sources none").code, 0);
  EXPECT_TRUE(cameras_of("out").empty());
  EXPECT_EQ(score_copied_elsewhere("out").pixels, 0);
  ASSERT_EQ(dvi("run drive -o named --quiet --sources right").code, 0);
  EXPECT_EQ(cameras_of("named").size(), 1U);
  const Result refused = dvi("run drive -o other --quiet --sources left");
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("front, right"));
  EXPECT_FALSE(fs::exists(folder / "other"));
}

TEST_F(Rig, ACameraThatCannotBeReadIsLeftOut) {
  const fs::path drive = stereo_drive();
  std::string config = read_file(drive / "dvi.toml");
  config.erase(config.rfind("camera_from_lidar"), config.find("[lidar]") - config.rfind("camera_from_lidar"));
  write_file(drive / "dvi.toml", config);
  const Result run = dvi("run drive -o out");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("camera right is not used as a source"));
  EXPECT_TRUE(cameras_of("out").empty());
}

TEST_F(Rig, NoColorsAreCopiedFromAGrayCamera) {
  const fs::path drive = stereo_drive();
  for (const fs::path& file : list_files(drive / "images/right", {".png"}))
    media::write_png(file, cv::imread(file.string(), cv::IMREAD_GRAYSCALE));
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  ASSERT_EQ(cameras_of("out").size(), 1U);
  EXPECT_TRUE(cameras_of("out")[0]["gray"].get<bool>());
  EXPECT_EQ(score_copied_elsewhere("out").pixels, 0);
  EXPECT_EQ(dvi("audit out drive").code, 0);
  ASSERT_EQ(dvi("holdout drive --scenario lead -o case --quiet").code, 0);
  EXPECT_FALSE(fs::exists(folder / "case/drive/images/right")) << "virtual vehicles have colors";
  // A gray target camera is filled from its own frames only.
  ASSERT_EQ(dvi("run drive -o right --quiet --camera right").code, 0);
  EXPECT_EQ(score_copied_elsewhere("right").pixels, 0);
  EXPECT_EQ(dvi("audit right drive").code, 0);
}

TEST_F(Rig, ADamagedFirstImageIsNotTreatedAsGray) { expect_refused_if_damaged("right/000000.png"); }

TEST_F(Rig, FramesOfTheOtherCameraWithoutAMaskFileCauseAWarning) {
  const fs::path drive = stereo_drive();
  fs::remove(drive / "masks/right/000004.png");
  const Result run = dvi("run drive -o out");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("drive right: 1 of 6 frames have no mask file, and nothing is removed in them: 4"));
}

TEST_F(Rig, ADamagedImageOfTheOtherCameraIsRefused) { expect_refused_if_damaged("right/000003.png"); }

}  // namespace
}  // namespace dvi
