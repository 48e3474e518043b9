#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "dvi/core/random.h"
#include "dvi/drive/outline.h"
#include "dvi/image/region.h"
#include "dvi/objects/motion_segmentation.h"
#include "dvi/objects/shadows.h"
#include "dvi/objects/test_plain_drive.h"
#include "dvi/objects/test_recorded_street.h"
#include "dvi/testing/memory_views.h"

namespace dvi::objects {
namespace {

MotionSegmentation segment(const Drive& drive, const ScanPoses& poses) {
  const ground::ScanGround ground(drive, poses.world_from_lidar);
  MovingReturns returns(drive, poses, ground);
  return segment_motion(returns, [] {});
}

TEST(MotionSegmentation, FindsMovingObjectsAndNoStaticOnes) {
  const RecordedStreet street(14);
  const std::vector<Track> tracks = segment(street.drive, {street.drive.poses}).tracks;
  const FrameLabels labels = draw_outlines(tracks, street.drive, street.drive.poses, 0.3);
  ASSERT_EQ(labels.size(), street.drive.frames.size());
  double covered = 0, all = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const synth::SynthFrame truth = street.scene->render(static_cast<int>(i));
    const cv::Mat1b found = draw_instances(labels[i], truth.dynamic.size());
    covered += cv::countNonZero(grown(found, 3) & truth.dynamic);
    all += cv::countNonZero(truth.dynamic);
    for (const Label& label : labels[i]) {
      const cv::Mat1b own = draw_instances({label}, truth.dynamic.size());
      EXPECT_GT(cv::countNonZero(own & grown(truth.dynamic, 3)), cv::countNonZero(own) / 3)
          << "frame " << i << " track " << label.track;
      ASSERT_TRUE(label.box);
      EXPECT_GT(label.box->size.minCoeff(), 0);
    }
  }
  EXPECT_GT(covered / all, 0.75);  // shadows are part of the truth, not of the outlines
  RecordProperty("recall", std::to_string(covered / all));
}

// Makes a drive of a slow vehicle toward a wall on a plain. A person 0.8 m long walks across the plain, 25 m ahead of the first
// scan.
Drive make_drive_with_walker(int scans) {
  Drive drive = PlainDrive(scans, 0).drive;
  std::vector<StampedPose> poses;
  for (int i = 0; i < scans; ++i)
    poses.push_back({i * PlainDrive::kScanPeriodNs, {Eigen::Matrix3d::Identity(), {0.3 * i, 0, 1.7}}});
  drive.poses = Trajectory(poses);
  drive.scans = Lazy<Scan>(scans, 4, [](std::size_t i) {
    constexpr double kDegree = std::numbers::pi / 180, kWall = 40, kWalker = 25, kTall = 1.8;
    const double walker = -1.5 + 0.145 * static_cast<double>(i), sensor = 0.3 * static_cast<double>(i);
    Scan scan;
    for (double up = -15; up <= 2; up += 0.4)
      for (double aside = -40; aside <= 40; aside += 0.2) {
        const Eigen::Vector3d ray(std::cos(aside * kDegree), std::sin(aside * kDegree), std::tan(up * kDegree));
        double length = (kWall - sensor) / ray.x();
        if (ray.z() < 0) length = std::min(length, -1.7 / ray.z());
        const double there = (kWalker - sensor) / ray.x();
        const Eigen::Vector3d x = there * ray;
        if (std::abs(x.y() - walker) < 0.4 && x.z() + 1.7 < kTall) length = std::min(length, there);
        scan.points.emplace_back((length * ray).cast<float>());
        scan.time.push_back(0);
        scan.intensity.push_back(0.5F);
      }
    return scan;
  });
  return drive;
}

TEST(MotionSegmentation, FindsAWalkingPersonInAShortDrive) {
  const Drive drive = make_drive_with_walker(24);
  const std::vector<Track> tracks = segment(drive, {drive.poses}).tracks;
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_GE(tracks[0].observations.size(), 18U);
  EXPECT_NEAR(tracks[0].height_m, 1.8, 0.2);
  EXPECT_NEAR(tracks[0].velocity(12).norm(), 1.45, 0.3);
}

TEST(MovingReturns, HaveTheSameVotesAloneAndWithTheirNeighbors) {
  const RecordedStreet street(14);
  const ground::ScanGround ground(street.drive, street.drive.poses);
  std::vector<bool> untrusted(14, false);
  untrusted[5] = true;
  const MovingReturns returns(street.drive, {street.drive.poses, 0.05, untrusted}, ground);
  const std::vector<ObstacleReturns> together = returns.vote(0, 14);
  ASSERT_EQ(together.size(), 14U);
  std::ptrdiff_t moving = 0, stationary = 0;
  for (std::size_t i = 0; i < together.size(); ++i) {
    EXPECT_EQ(together[i].vote, returns.vote(i, i + 1).front().vote) << "scan " << i;
    EXPECT_EQ(together[i].vote.size(), together[i].points.size());
    EXPECT_EQ(together[i].points.empty(), i == 5) << "its pose is wrong";
    moving += std::count(together[i].vote.begin(), together[i].vote.end(), VisibilityVote::moving);
    stationary += std::count(together[i].vote.begin(), together[i].vote.end(), VisibilityVote::stationary);
  }
  EXPECT_GT(moving, 100);
  EXPECT_GT(stationary, 10 * moving);
}

TEST(MotionSegmentation, FindsNothingInOneScanOrWithoutPoses) {
  const RecordedStreet street(1);
  EXPECT_TRUE(segment(street.drive, {street.drive.poses}).tracks.empty());
  const std::vector<Track> unposed = segment(street.drive, {}).tracks;
  EXPECT_TRUE(unposed.empty());
  EXPECT_EQ(draw_outlines(unposed, street.drive, Trajectory(), 0.3).size(), 1U);
}

TEST(ScanGroundOfADrive, FollowsSlopesAndIgnoresReflectionsBelowTheGround) {
  const PlainDrive plain(12, 0.08, 0.005);
  const ground::ScanGround ground(plain.drive, plain.drive.poses);
  for (const double x : {1.3, 7.7, 15.2, 24.9})
    for (const double y : {-8.4, -0.3, 6.1}) {
      const auto height = ground.height({x, y});
      ASSERT_TRUE(height) << x << ' ' << y;
      EXPECT_NEAR(*height, 0.08 * x, 0.05) << x << ' ' << y;
    }
  EXPECT_FALSE(ground.height({500, 0}));
}

// Images of the plain with an upright board ahead that moves away. The board is masked, the shadow to its left is not.
struct ShadowedViews {
  Views views;
  std::vector<cv::Mat1b> shadows;

  enum class Shadow { none, cast };

  ShadowedViews(const Drive& drive, Shadow shadowed, double exposure_step = 0) {
    std::vector<cv::Mat3b> images;
    std::vector<cv::Mat1b> masks;
    for (std::size_t i = 0; i < drive.frames.size(); ++i) {
      const SE3 world_from_lidar = *drive.poses.at(drive.frames[i].time_ns);
      const SE3 camera_from_world = drive.camera_from_lidar * world_from_lidar.inverse(),
                world_from_camera = camera_from_world.inverse();
      views.views.push_back({0, i, drive.frames[i].time_ns, drive.camera, camera_from_world});
      const double board = 7 + 1.1 * static_cast<double>(i);  // meters along x
      const double exposure = 1 + exposure_step * static_cast<double>(i);
      cv::Mat3b image(drive.camera.height, drive.camera.width, cv::Vec3b(200, 180, 160));
      cv::Mat1b mask(image.size(), uchar{0}), shadow(image.size(), uchar{0});
      for (int y = 0; y < image.rows; ++y)
        for (int x = 0; x < image.cols; ++x) {
          const Eigen::Vector3d ray = world_from_camera.R * drive.camera.ray({x, y});
          const double to_board = (board - world_from_camera.t.x()) / ray.x();
          const Eigen::Vector3d on_board = world_from_camera.t + to_board * ray;
          if (std::abs(on_board.y()) < 0.9 && on_board.z() > 0 && on_board.z() < 1.6) {
            mask(y, x) = 255;
            image(y, x) = {30, 30, 200};
            continue;
          }
          if (ray.z() >= 0) continue;
          const Eigen::Vector2d foot = (world_from_camera.t - world_from_camera.t.z() / ray.z() * ray).head<2>();
          const bool dark =
              shadowed == Shadow::cast && foot.x() > board - 0.2 && foot.x() < board + 1.8 && foot.y() > 0.5 && foot.y() < 2.6;
          if (dark && foot.y() > 0.9) shadow(y, x) = 255;
          const double level = sample_road(foot) * exposure * (dark ? 0.45 : 1.0);
          image(y, x) = cv::Vec3b::all(cv::saturate_cast<uchar>(level));
        }
      images.push_back(image);
      masks.push_back(mask);
      shadows.push_back(shadow);
    }
    views = memory_views(views.views, images, masks);
  }
};

TEST(Shadows, AreAddedToTheMaskAlsoIfTheExposureDrifts) {
  const PlainDrive plain(40, 0);
  const auto ground = std::make_shared<const ground::ScanGround>(plain.drive, plain.drive.poses);
  for (const double drift : {0.0, 0.01}) {
    const ShadowedViews filmed(plain.drive, ShadowedViews::Shadow::cast, drift);
    const Lazy<cv::Mat1b> masks = add_shadows(filmed.views, ground);
    for (const std::size_t i : {std::size_t{8}, std::size_t{12}}) {
      const cv::Mat1b base = *filmed.views.masks[i], mask = *masks[i], shadow(filmed.shadows[i] & ~base);
      ASSERT_GT(cv::countNonZero(shadow), 30);
      EXPECT_EQ(cv::countNonZero(base & ~mask), 0);
      EXPECT_GT(cv::countNonZero(mask & shadow), 0.8 * cv::countNonZero(shadow)) << "frame " << i;
      EXPECT_LT(cv::countNonZero(mask & ~grown(cv::Mat1b(base | shadow), 4)), mask.rows * mask.cols / 50) << "frame " << i;
    }
  }
}

TEST(Shadows, AreNotFoundOnThingsThatHideTheGround) {
  const PlainDrive plain(40, 0);
  const auto ground = std::make_shared<const ground::ScanGround>(plain.drive, plain.drive.poses);
  ShadowedViews filmed(plain.drive, ShadowedViews::Shadow::cast);
  constexpr std::size_t kFrame = 8;
  cv::Rect hidden = cv::boundingRect(filmed.shadows[kFrame]);
  hidden = {hidden.x, hidden.y - 12, hidden.width / 3, hidden.height + 12};
  const auto seen_through = add_shadows(filmed.views, ground)[kFrame];
  filmed.views.returns = Lazy<std::vector<ImageReturn>>(filmed.views.size(), [hidden](std::size_t) {
    std::vector<ImageReturn> returns;
    for (int y = hidden.y; y < hidden.br().y; y += 3)
      for (int x = hidden.x; x < hidden.br().x; ++x)
        returns.push_back({static_cast<float>(x), static_cast<float>(y), 4});  // on a trunk, nearer than the ground
    return returns;
  });
  const auto mask = add_shadows(filmed.views, ground)[kFrame];
  const cv::Mat1b base = *filmed.views.masks[kFrame], shadow(filmed.shadows[kFrame] & ~base);
  cv::Mat1b on_trunk(mask->size(), uchar{0}), beside = shadow.clone();
  on_trunk(hidden) = 255;
  beside.setTo(0, on_trunk);
  on_trunk.setTo(0, grown(cv::Mat1b(base | beside), 6));  // shadows have a margin
  ASSERT_GT(cv::countNonZero(*seen_through & on_trunk), 15);
  EXPECT_EQ(cv::countNonZero(*mask & on_trunk), 0);
  EXPECT_GT(cv::countNonZero(*mask & beside), 0.5 * cv::countNonZero(beside));
}

TEST(Shadows, AreNotFoundOnDarkGroundOrWithoutOtherViews) {
  const PlainDrive plain(40, 0);
  const auto ground = std::make_shared<const ground::ScanGround>(plain.drive, plain.drive.poses);
  const ShadowedViews filmed(plain.drive, ShadowedViews::Shadow::none);
  const Lazy<cv::Mat1b> masks = add_shadows(filmed.views, ground);
  const cv::Mat1b base = *filmed.views.masks[20];
  EXPECT_EQ(cv::countNonZero(*masks[20] & ~grown(base, 4)), 0);
  Views alone = filmed.views;
  alone.views.resize(1);
  alone.images = {1, 1, [of = filmed.views.images](std::size_t) { return of[0]->clone(); }};
  alone.masks = {1, 1, [of = filmed.views.masks](std::size_t) { return of[0]->clone(); }};
  EXPECT_EQ(cv::norm(*add_shadows(alone, ground)[0], *filmed.views.masks[0], cv::NORM_INF), 0);
}

TEST(Shadows, AreComputedOnceEvenWithoutACache) {
  const PlainDrive plain(40, 0);
  ShadowedViews filmed(plain.drive, ShadowedViews::Shadow::cast);
  const auto reads = std::make_shared<std::atomic<int>>(0);
  filmed.views.images = Lazy<cv::Mat3b>::through(filmed.views.size(), [reads, of = filmed.views.images](std::size_t i) {
    ++*reads;
    return of[i];
  });
  const Lazy<cv::Mat1b> masks =
      add_shadows(filmed.views, std::make_shared<const ground::ScanGround>(plain.drive, plain.drive.poses));
  const cv::Mat1b found = masks[12]->clone();
  CacheBudget& budget = *CacheBudget::of_process();
  budget.set_bound(0);  // one item of all sequences stays in memory
  masks[0];
  const int before = *reads;
  EXPECT_EQ(cv::norm(*masks[12], found, cv::NORM_INF), 0);
  EXPECT_EQ(*reads, before);
  budget.set_bound(std::size_t{1000} << 20);
}

Cluster cluster_at(double x, double y, double seconds, double moving_share = 1) {
  Cluster cluster;
  cluster.center = {x, y};
  cluster.extent_m = 0.8;
  cluster.mean_time_ns = std::llround(1e9 * seconds);
  cluster.moving_share = moving_share;
  return cluster;
}

TEST(Tracker, SeparatesTwoObjectsThatPassEachOther) {
  Tracker tracker;
  for (int i = 0; i < 20; ++i) {
    const double t = 0.1 * i;
    if (i == 9) continue;  // hidden for a moment
    tracker.add({cluster_at(8 * t, 0, t), cluster_at(16 - 8 * t, 2.5, t)});
  }
  const std::vector<Track> tracks = tracker.finish();
  ASSERT_EQ(tracks.size(), 2U);
  for (const Track& track : tracks) {
    EXPECT_EQ(track.observations.size(), 19U);
    EXPECT_NEAR(std::abs(track.velocity(10).x()), 8, 1e-6);
    EXPECT_NEAR(track.velocity(10).y(), 0, 1e-6);
  }
}

TEST(Tracker, EndsATrackAfterALongGap) {
  for (const double gap : {0.5, 0.6}) {
    Tracker tracker;
    for (int i = 0; i < 20; ++i) {
      const double t = 0.1 * i + (i < 10 ? 0 : gap - 0.1);
      tracker.add({cluster_at(8 * t, 0, t)});
    }
    EXPECT_EQ(tracker.finish().size(), gap < 0.55 ? 1U : 2U) << gap << " s";
  }
}

TEST(Tracker, KeepsAVanWithFewMovingReturnsIfItTravelsFar) {
  for (const double speed : {5.0, 1.0}) {
    Tracker tracker;
    for (int i = 0; i < 20; ++i) tracker.add({cluster_at(0.1 * i * speed, 0, 0.1 * i, 0.4)});
    EXPECT_EQ(tracker.finish().size(), speed > 2 ? 1U : 0U) << speed << " m/s";
  }
}

TEST(Tracker, DropsStationaryWanderingAndMostlyStaticClusters) {
  Random random(5);
  Tracker tracker;
  for (int i = 0; i < 30; ++i) {
    const double t = 0.1 * i;
    tracker.add({cluster_at(0.05 * random.normal(), 0, t),
                 cluster_at(30 + random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7), t), cluster_at(3 * t, 60, t, 0.25)});
  }
  EXPECT_TRUE(tracker.finish().empty());
}

}  // namespace
}  // namespace dvi::objects
