#include "dvi/objects/track_outlines.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "dvi/drive/outline.h"
#include "dvi/objects/test_plain_drive.h"

namespace dvi::objects {
namespace {

constexpr int kScans = 10;
const Eigen::Vector3d kSize(4.4, 1.8, 1.5), kVelocity(8, 0, 0);
const PlainDrive kPlain(1, 0);
const SE3 kSensor = *kPlain.drive.poses.at(0);  // stationary

Eigen::Vector3d center_at(std::int64_t time_ns) {
  return Eigen::Vector3d(30, 2, 0.5 * kSize.z()) + 1e-9 * static_cast<double>(time_ns) * kVelocity;
}

// Makes a track of a car that drives away. Each scan hits the lower half of its rear.
Track make_car(double ray_spacing_m) {
  Track track;
  track.height_m = kSize.z();
  track.size_m = kSize.head<2>();
  for (int i = 0; i < kScans; ++i) {
    ObstacleReturns returns;
    for (const double y : {-0.5, -0.2, 0.1, 0.4, 0.5}) {
      const std::int64_t time = i * PlainDrive::kScanPeriodNs;
      returns.points.push_back(center_at(time) +
                               Eigen::Vector3d(-0.5, y, -0.1).cwiseProduct(Eigen::Vector3d(kSize.x(), kSize.y(), 1)));
      returns.time_ns.push_back(time);
      returns.ground.push_back(0);
      returns.ray_spacing_m.push_back(ray_spacing_m);
    }
    Cluster cluster;
    for (std::size_t k = 0; k < returns.points.size(); ++k) add(cluster, returns, k);
    measure(cluster);
    track.observations.push_back(std::move(cluster));
  }
  return track;
}

std::optional<Label> draw(const Track& track, std::int64_t time_ns) {
  return draw_outline(track, time_ns, {kPlain.drive.camera, kSensor, kPlain.drive.camera_from_lidar, 0.3});
}

TEST(Outlines, CoverTheWholeObjectIfRaysAreSparse) {
  const Track track = make_car(0.4);
  for (const std::int64_t time : {std::int64_t{0}, std::int64_t{500'000'000}, std::int64_t{1'700'000'000}}) {
    const std::optional<Label> label = draw(track, time);
    ASSERT_TRUE(label) << time;
    EXPECT_NEAR((label->box->size - kSize).norm(), 0, 1e-4);
    const Box box{SE3{Eigen::Matrix3d::Identity(), center_at(time)}, kSize};
    EXPECT_NEAR((kSensor * label->box->frame_from_box.t - box.frame_from_box.t).norm(), 0, 1e-4);
    std::vector<Eigen::Vector3d> corners;
    for (const Eigen::Vector3d& x : box.corners())
      corners.emplace_back(kPlain.drive.camera_from_lidar * (kSensor.inverse() * x));
    cv::Mat1b object(kPlain.drive.camera.height, kPlain.drive.camera.width, uchar{0}), found = object.clone();
    ASSERT_TRUE(draw_hull(corners, kPlain.drive.camera, object));
    dvi::draw(*label->instance, found);
    EXPECT_EQ(cv::countNonZero(object & ~found), 0) << time;
  }
}

TEST(Outlines, ExtendHeadsByHalfTheRaySpacing) {
  const auto top_of = [](double ray_spacing_m) {
    Track person = make_car(ray_spacing_m);
    person.size_m = {0.6, 0.5};
    const std::optional<Label> label = draw(person, 0);
    return label ? label->box->frame_from_box.t.z() + 0.5 * label->box->size.z() : 0;
  };
  EXPECT_NEAR(top_of(0.16) - top_of(0.04), 0.06, 1e-6);
}

TEST(Outlines, EndASecondAfterTheLastObservationAndSoonerIfRaysAreDense) {
  const std::int64_t last = (kScans - 1) * PlainDrive::kScanPeriodNs;
  EXPECT_TRUE(draw(make_car(0.4), last + 900'000'000));
  EXPECT_FALSE(draw(make_car(0.4), last + 1'100'000'000));
  EXPECT_TRUE(draw(make_car(0.1), last + 200'000'000));
  EXPECT_FALSE(draw(make_car(0.1), last + 300'000'000)) << "a scan would have shown it";
}

}  // namespace
}  // namespace dvi::objects
