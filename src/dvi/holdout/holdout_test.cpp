#include "dvi/holdout/holdout.h"
#include "dvi/image/region.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>

#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/core/random.h"
#include "dvi/core/threads.h"
#include "dvi/datasets/reader.h"
#include "dvi/datasets/scan_time.h"
#include "dvi/media/image_file.h"
#include "dvi/synth/scene.h"
#include "dvi/testing/temp_folder.h"

namespace dvi::holdout {
namespace {

using testing::HasSubstr;

constexpr double kNoiseM = 0.021;  // range noise on the faces of the vehicle, and rounding

Drive make_small_street() {
  synth::SynthOptions options;
  options.frames = 5, options.width = 160, options.height = 90, options.beams = 16, options.columns = 400;
  static const auto scene = std::make_shared<const synth::Scene>(options);
  Drive drive = synth::drive_of(scene);
  // Times as files have them: the first return, directly behind, may count as the last.
  drive.scans =
      Lazy<Scan>(drive.scan_headers.size(), 8, [scans = drive.scans, scan_headers = drive.scan_headers](std::size_t i) {
        Scan scan = *scans[i];
        scan.time = datasets::times_by_azimuth(scan.points, scan_headers[i], {});
        return scan;
      });
  return drive;
}

Holdout make(const Drive& drive, Scenario scenario, int seed = 1) {
  return {{{drive, drive.masks}}, drive.poses, {scenario, seed}};
}

bool is_same(const cv::Mat& a, const cv::Mat& b) { return a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0; }

/// Returns the range at which the ray of a return hits the vehicle; nothing if it misses.
std::optional<double> compute_range_to_vehicle(const Holdout& holdout, std::size_t scan_index, const Eigen::Vector3f& p,
                                               float seconds) {
  const std::int64_t time = holdout.drive().scan_headers[scan_index].time_ns + std::llround(1e9 * static_cast<double>(seconds));
  const auto pose = holdout.drive().poses.at(time);
  const auto hit = find_hit(holdout.vehicle()->box_at(time), pose->t, pose->R * p.cast<double>());
  if (!hit) return std::nullopt;
  return hit->distance * static_cast<double>(p.norm());
}

class Folder : public testing::Test {
 protected:
  const TempFolder temporary;
  const fs::path folder = temporary.path;
};

class EachScenario : public testing::TestWithParam<Scenario> {};

INSTANTIATE_TEST_SUITE_P(Holdout, EachScenario, testing::ValuesIn(kScenarios),
                         [](const auto& scenario) { return name(scenario.param); });

TEST_P(EachScenario, PaintsExactlyTheMaskedPixels) {
  const Drive drive = make_small_street();
  const Holdout holdout = make(drive, GetParam());
  int painted = 0;
  for (std::size_t i = 0; i < drive.frames.size(); ++i) {
    const HoldoutFrame frame = holdout.frame(i);
    const cv::Mat3b truth = holdout.truth(i);
    const cv::Mat1b traffic = *drive.masks[i];
    for (int y = 0; y < truth.rows; ++y)
      for (int x = 0; x < truth.cols; ++x) {
        const bool held_out = frame.held_out(y, x) != 0;
        ASSERT_TRUE(held_out || frame.image(y, x) == truth(y, x));
        painted += held_out && frame.image(y, x) != truth(y, x) ? 1 : 0;
        ASSERT_EQ(frame.mask(y, x) != 0, held_out || traffic(y, x) != 0);
        ASSERT_TRUE(traffic(y, x) == 0 || frame.ignore(y, x) == 255);
      }
  }
  EXPECT_GT(painted, 20);
}

TEST_P(EachScenario, TouchesTheRoad) {
  if (GetParam() == Scenario::banner) GTEST_SKIP() << "a banner has no position on the road";
  const Drive drive = make_small_street();
  const Holdout holdout = make(drive, GetParam());
  EXPECT_NEAR(holdout.sensor_height(), drive.poses.poses()[0].world_from_body.t.z(), 0.03);
  for (const Frame& frame : drive.frames) {
    const Box box = holdout.vehicle()->box_at(frame.time_ns);
    const double bottom = (box.frame_from_box * Eigen::Vector3d(0, 0, -0.5 * box.size.z())).z();
    EXPECT_NEAR(bottom, 0, 0.08) << "the street's road is at z = 0";
    EXPECT_GT(box.frame_from_box.R(2, 2), 0.999);
  }
}

TEST_P(EachScenario, ScansHitTheVehicleAndNothingBehindIt) {
  if (GetParam() == Scenario::banner) GTEST_SKIP() << "a banner is not in the scans";
  const Drive drive = make_small_street();
  const Holdout holdout = make(drive, GetParam());
  int replaced = 0;
  for (std::size_t i = 0; i < drive.scan_headers.size(); ++i) {
    const Scan before = *drive.scans[i], after = holdout.scan(i);
    ASSERT_EQ(before.size(), after.size());
    for (std::size_t k = 0; k < before.size(); ++k) {
      const auto range = compute_range_to_vehicle(holdout, i, before.points[k], before.time[k]);
      if (range && *range < static_cast<double>(before.points[k].norm())) {
        ++replaced;
        ASSERT_NEAR(after.points[k].norm(), *range, kNoiseM);
        ASSERT_LT(after.points[k].normalized().cross(before.points[k].normalized()).norm(), 1e-5F);
      } else {
        ASSERT_EQ(after.points[k], before.points[k]);
        ASSERT_EQ(after.intensity[k], before.intensity[k]);
      }
    }
  }
  EXPECT_GT(replaced, GetParam() == Scenario::oncoming ? 0 : 10);
}

TEST(Holdout, PaintsTheVehicleInAllCameras) {
  const Drive drive = make_small_street();
  Drive right = drive;
  right.camera_name = "right";
  right.camera_from_lidar.t.x() -= 1;
  const Holdout holdout({{drive, drive.masks}, {right, drive.masks}}, drive.poses, {Scenario::lead, 1});
  ASSERT_EQ(holdout.more_cameras().size(), 1U);
  for (std::size_t i = 0; i < drive.frames.size(); ++i) {
    const cv::Mat1b vehicle(~grown(cv::Mat1b(~holdout.camera_frame(0, i).held_out), 4));  // without its margin
    ASSERT_GT(cv::countNonZero(vehicle), 20) << i;
    const std::int64_t time = drive.frames[i].time_ns;
    const SE3 world_from_camera = *drive.poses.at(time) * right.camera_from_lidar.inverse();
    for (int y = 0; y < vehicle.rows; ++y)
      for (int x = 0; x < vehicle.cols; ++x)
        if (vehicle(y, x) != 0) {
          EXPECT_TRUE(
              find_hit(holdout.vehicle()->box_at(time), world_from_camera.t, world_from_camera.R * drive.camera.ray({x, y})))
              << x << ", " << y;
        }
  }
}

TEST_P(EachScenario, MaskErrorsChangeOnlyTheMasksAndTheLabels) {
  const Drive drive = make_small_street();
  Drive right = drive;
  right.camera_name = "right";
  const std::vector<HoldoutCamera> cameras{{drive, drive.masks}, {right, drive.masks}};
  const Holdout correct(cameras, drive.poses, {GetParam(), 1});
  for (const auto& [kind, kind_name] : names_of(MaskErrors{})) {
    HoldoutOptions options{GetParam(), 1};
    options.mask_errors = kind;
    const Holdout holdout(cameras, drive.poses, options);
    EXPECT_EQ(holdout.visible(), correct.visible());
    for (std::size_t i = 0; i < drive.frames.size(); ++i) {
      const HoldoutFrame frame = holdout.frame(i), expected = correct.frame(i);
      EXPECT_TRUE(is_same(frame.image, expected.image));
      EXPECT_TRUE(is_same(frame.held_out, expected.held_out));
      EXPECT_TRUE(is_same(frame.ignore, expected.ignore));
      EXPECT_TRUE(is_same(frame.mask, holdout.frame(i).mask)) << "frames are made again with the same errors";
      EXPECT_EQ(cv::countNonZero(cv::Mat1b(*drive.masks[i] & ~frame.mask)), 0) << "real traffic is masked";
      EXPECT_TRUE(kind != MaskErrors::none || is_same(frame.mask, expected.mask));
      EXPECT_TRUE(holdout.scan(i).points == correct.scan(i).points);
      const std::size_t virtual_labels = holdout.is_labeled() ? 1 : 0;
      EXPECT_EQ(holdout.drive().frames[i].labels.size(), drive.frames[i].labels.size() + virtual_labels) << kind_name;
    }
    EXPECT_EQ(holdout.is_labeled(), kind == MaskErrors::none && GetParam() != Scenario::banner);
  }
}

TEST(Holdout, MaskErrorsOfCamerasAreIndependent) {
  const Drive drive = make_small_street();
  std::vector<HoldoutCamera> cameras(4, {drive, drive.masks});
  HoldoutOptions options{Scenario::lead, 1};
  options.mask_errors = MaskErrors::false_boxes;
  const Holdout holdout(cameras, drive.poses, options);
  bool differ = false;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < drive.frames.size(); ++i)
      differ = differ || !is_same(holdout.camera_frame(k, i).mask, holdout.frame(i).mask);
  EXPECT_TRUE(differ);
}

TEST(Holdout, DependsOnTheSeedAndNotOnTheNumberOfThreads) {
  const Drive drive = make_small_street();
  const ThreadLimit limit(2);
  const Holdout two = make(drive, Scenario::lead), other = make(drive, Scenario::lead, 2);
  const ThreadLimit lower(1);
  const Holdout one = make(drive, Scenario::lead);
  for (std::size_t i = 0; i < drive.frames.size(); ++i) {
    EXPECT_TRUE(is_same(one.frame(i).image, two.frame(i).image));
    EXPECT_TRUE(one.scan(i).points == two.scan(i).points);
    EXPECT_TRUE(one.scan(i).intensity == two.scan(i).intensity);
    EXPECT_FALSE(is_same(one.frame(i).image, other.frame(i).image));
    EXPECT_FALSE(one.scan(i).points == other.scan(i).points);
  }
}

TEST(Holdout, LeadStaysAheadAtAVaryingDistance) {
  const Drive drive = make_small_street();
  const Holdout holdout = make(drive, Scenario::lead);
  std::vector<double> distances;
  for (const Frame& frame : holdout.drive().frames) {
    ASSERT_FALSE(frame.labels.empty());
    const Label& label = frame.labels.back();
    EXPECT_EQ(label.track, holdout.track());
    EXPECT_NEAR(label.box->frame_from_box.t.y(), 0, 0.5);
    distances.push_back(label.box->frame_from_box.t.x());
    EXPECT_THAT(distances.back(), testing::AllOf(testing::Gt(8.5), testing::Lt(12.5)));
  }
  EXPECT_NE(distances.front(), distances.back());
}

TEST_F(Folder, TheCaseDoesNotContainTheTruth) {
  const Drive drive = make_small_street();
  for (const Scenario scenario : {Scenario::lead, Scenario::banner}) {
    const Holdout holdout = make(drive, scenario);
    Drive other = drive;
    other.images = Lazy<cv::Mat3b>(drive.frames.size(), 8, [&](std::size_t i) {
      cv::Mat3b image = drive.images[i]->clone();
      const cv::Mat1b held_out = holdout.frame(i).held_out;
      Random random(i);
      for (int y = 0; y < image.rows; ++y)
        for (int x = 0; x < image.cols; ++x)
          for (int c = 0; held_out(y, x) != 0 && c < 3; ++c) image(y, x)[c] = static_cast<uchar>(random.below(256));
      return image;
    });
    const fs::path a = folder / name(scenario) / "a", b = folder / name(scenario) / "b";
    write_holdout(holdout, a, "");
    write_holdout(make(other, scenario), b, "");
    EXPECT_TRUE(contents(a / "drive") == contents(b / "drive")) << name(scenario);
    EXPECT_FALSE(contents(a / "truth") == contents(b / "truth")) << name(scenario);
  }
}

TEST_F(Folder, TheCaseIsADriveThatCanBeRead) {
  const Drive drive = make_small_street();
  const Holdout holdout = make(drive, Scenario::oncoming);
  write_holdout(holdout, folder / "new/case", "recipe");
  EXPECT_EQ(read_holdout_recipe(folder / "new/case"), "recipe");
  EXPECT_EQ(read_holdout_recipe(folder / "elsewhere"), "");
  const Drive read = datasets::read_drive(folder / "new/case/drive");
  EXPECT_TRUE(read.warnings.empty());
  ASSERT_EQ(read.frames.size(), drive.frames.size());
  EXPECT_EQ(read.camera.fx, drive.camera.fx);
  for (std::size_t i = 0; i < drive.frames.size(); ++i) {
    EXPECT_EQ(read.frames[i].time_ns, drive.frames[i].time_ns);
    EXPECT_EQ(read.frames[i].labels.size(), drive.frames[i].labels.size() + 1);
    EXPECT_EQ(read.scan_headers[i].time_ns, drive.scan_headers[i].time_ns);
    EXPECT_EQ(read.scan_headers[i].file.extension(), ".bin");
    const HoldoutFrame frame = holdout.frame(i);
    EXPECT_TRUE(is_same(*read.images[i], frame.image));
    EXPECT_TRUE(is_same(*read.masks[i], frame.mask));
    const Scan expected = holdout.scan(i);
    const auto scan = read.scans[i];
    EXPECT_TRUE(scan->points == expected.points);
    for (std::size_t k = 0; k < scan->size(); ++k) ASSERT_NEAR(scan->time[k], expected.time[k], 1e-4);
    const SE3 a = *read.poses.at(read.frames[i].time_ns), b = *drive.poses.at(drive.frames[i].time_ns);
    EXPECT_LT((a.t - b.t).norm() + (a.R - b.R).norm(), 1e-9);
  }
}

TEST_F(Folder, TheCaseKeepsTheTrueMasks) {
  const Drive drive = make_small_street();
  HoldoutOptions options{Scenario::lead, 1};
  options.mask_errors = MaskErrors::burst;
  const Holdout holdout({{drive, drive.masks}}, drive.poses, options);
  write_holdout(holdout, folder / "case", "");
  const Drive read = datasets::read_drive(folder / "case/drive");
  for (std::size_t i = 0; i < drive.frames.size(); ++i) {
    const HoldoutFrame frame = holdout.frame(i);
    EXPECT_TRUE(is_same(*read.masks[i], *drive.masks[i])) << "a burst covers this short drive";
    EXPECT_TRUE(is_same(media::read_mask(folder / "case/truth_masks" / (drive.frames[i].name + ".png"), frame.held_out.size()),
                        frame.held_out));
  }
}

TEST_F(Folder, TheCaseOfADepthCameraHasItsSensor) {
  Drive drive = make_small_street();
  drive.sensor = Sensor::depth_camera;
  write_holdout(make(drive, Scenario::lead), folder / "case", "recipe");
  EXPECT_EQ(datasets::read_drive(folder / "case/drive").sensor, Sensor::depth_camera);
}

TEST_F(Folder, UnusualTimesAreWritten) {
  Drive drive = make_small_street();
  drive.scans = Lazy<Scan>(drive.scan_headers.size(), 8, [scans = drive.scans](std::size_t i) {
    Scan scan = *scans[i];
    for (std::size_t k = 0; k < scan.size(); ++k) scan.time[k] = 1e-4F * static_cast<float>(k % 1000) - 0.05F;
    scan.ring.assign(scan.size(), 7);
    return scan;
  });
  write_holdout(make(drive, Scenario::parked), folder / "case", "");
  const Drive read = datasets::read_drive(folder / "case/drive");
  EXPECT_EQ(read.scan_headers[0].file.extension(), ".ply");
  for (std::size_t k = 0; k < drive.scans[0]->size(); ++k) {
    ASSERT_NEAR(read.scans[0]->time[k], drive.scans[0]->time[k], 1e-7);
    ASSERT_EQ(read.scans[0]->ring[k], 7);
  }
}

TEST_F(Folder, RejectsInvalidInput) {
  const Drive drive = make_small_street();
  const Holdout holdout = make(drive, Scenario::lead);
  make_folder(folder / "mine");
  write_file(folder / "mine/thesis.tex", "years of work");
  EXPECT_THROW(write_holdout(holdout, folder / "mine", ""), InputError);
  EXPECT_EQ(contents(folder / "mine").size(), 1);
  EXPECT_THROW(parse_scenario("meteor"), UsageError);

  Drive blind = drive;
  blind.camera_from_lidar = SE3{so3_exp({0, M_PI, 0}), {0, 0, 0}} * drive.camera_from_lidar;  // points backward
  EXPECT_THAT(input_error([&] { make(blind, Scenario::parked); }), HasSubstr("is in no image"));
  Drive floating = drive;
  floating.scans = Lazy<Scan>(drive.scan_headers.size(), 8, [](std::size_t) { return Scan{{{5, 5, 5}}, {0}, {0}, {}}; });
  EXPECT_THROW(make(floating, Scenario::lead), InputError);
}

TEST(PaintedBox, HitsTheNearestFace) {
  const Box box{{Eigen::Matrix3d::Identity(), {10, 0, 0}}, {4, 2, 2}};
  const auto hit = find_hit(box, {0, 0.5, 0.25}, {2, 0, 0});
  ASSERT_TRUE(hit);
  EXPECT_DOUBLE_EQ(hit->distance, 4);
  EXPECT_EQ(hit->axis, 0);
  EXPECT_EQ(hit->side, -1);
  EXPECT_TRUE(hit->point.isApprox(Eigen::Vector3d(-2, 0.5, 0.25)));
  EXPECT_FALSE(find_hit(box, {0, 1.5, 0}, {1, 0, 0})) << "beside it";
  EXPECT_FALSE(find_hit(box, {0, 0, 0}, {-1, 0, 0})) << "behind";
  EXPECT_FALSE(find_hit(box, {10, 0, 0}, {1, 0, 0})) << "from inside";
  EXPECT_FALSE(find_hit(box, {0, 0, 0}, {1, 1, 0}));
}

}  // namespace
}  // namespace dvi::holdout
