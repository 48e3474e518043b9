#include "dvi/objects/completion/masked_returns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "dvi/drive/outline.h"
#include "dvi/image/region.h"
#include "dvi/objects/test_plain_drive.h"

namespace dvi::objects {
namespace {

using Points = std::vector<Eigen::Vector3d>;

// Makes returns every 10 cm on an upright rectangle across the street.
Points make_board(double x, double right_m, double left_m, double height_m) {
  Points out;
  for (double y = right_m; y <= left_m; y += 0.1)
    for (double z = 0.4; z <= height_m; z += 0.1) out.emplace_back(x, y, z);
  return out;
}

Points join_points(const Points& a, const Points& b) {
  Points out = a;
  out.insert(out.end(), b.begin(), b.end());
  return out;
}

// One image taken at the origin, 1.7 m above the ground, at time 0.
struct MaskedImage {
  Drive drive = PlainDrive(2, 0).drive;
  cv::Mat1b mask = cv::Mat1b(drive.camera.height, drive.camera.width, uchar{0});
  FrameLabels labels{2};

  SE3 camera_from_world() const { return drive.camera_from_lidar * drive.poses.at(0)->inverse(); }

  // Masks the convex hull of points, dilated by a margin.
  void add_mask(const Points& points, int margin_px) {
    Points in_camera;
    for (const Eigen::Vector3d& point : points) in_camera.push_back(camera_from_world() * point);
    cv::Mat1b hull(mask.size(), uchar{0});
    draw_hull(in_camera, drive.camera, hull);
    mask |= grown(hull, margin_px);
  }

  std::vector<MaskVote> vote(const Points& points, std::int64_t time_ns = 0) const {
    const CameraEvidence evidence{drive, drive.poses, "drive", {MaskSource::files}};
    const Lazy<cv::Mat1b> masks(2, [this](std::size_t) { return mask; });
    ObstacleReturns returns;
    returns.points = points;
    return vote_by_masks({{evidence, masks, masks, shared(labels)}}, returns, time_ns);
  }

  int to_column(const Eigen::Vector3d& point) const { return cvRound(drive.camera.project(camera_from_world() * point).x()); }
};

// Counts the votes on the points [first, last).
std::ptrdiff_t count_votes(const std::vector<MaskVote>& votes, MaskVote vote, std::size_t first, std::size_t last) {
  const auto at = [&](std::size_t i) { return votes.begin() + static_cast<std::ptrdiff_t>(i); };
  return std::count(at(first), at(last), vote);
}

std::ptrdiff_t count_votes(const std::vector<MaskVote>& votes, MaskVote vote) {
  return count_votes(votes, vote, 0, votes.size());
}

std::ptrdiff_t count_points(const Points& points) { return static_cast<std::ptrdiff_t>(points.size()); }

const Points kMaskedCar = make_board(10, -1, 1, 1.5);

TEST(MaskedReturns, AreObjectsIfTheirThingIsMasked) {
  MaskedImage image;
  image.add_mask(kMaskedCar, 1);
  EXPECT_EQ(count_votes(image.vote(kMaskedCar), MaskVote::object), count_points(kMaskedCar));
}

TEST(MaskedReturns, InABoundingBoxAreObjectsOnlyOfTheNearestThing) {
  MaskedImage image;
  const Points behind = make_board(20, 1.5, 2.2, 1.5);  // beside the car in the image, in the corner of its box
  Points all = kMaskedCar;
  all.insert(all.end(), behind.begin(), behind.end());
  image.add_mask(kMaskedCar, 0);
  image.add_mask(behind, 0);
  image.mask(cv::boundingRect(image.mask)) = 255;
  const std::vector<MaskVote> votes = image.vote(all);
  EXPECT_EQ(count_votes(votes, MaskVote::object, 0, kMaskedCar.size()), count_points(kMaskedCar));
  EXPECT_EQ(count_votes(votes, MaskVote::unclear, kMaskedCar.size(), all.size()), count_points(behind));
}

TEST(MaskedReturns, AreObjectsAlsoIfTheMaskLacksAPart) {
  MaskedImage image;
  image.add_mask(make_board(10, -1, 0.5, 1.5), 0);
  const std::vector<MaskVote> votes = image.vote(kMaskedCar);
  EXPECT_GT(count_votes(votes, MaskVote::object), 0.7 * static_cast<double>(kMaskedCar.size()));
  EXPECT_EQ(count_votes(votes, MaskVote::background), 0) << "the rest of the thing is unclear";
}

TEST(MaskedReturns, ExcludeTheWallBehindALooseMask) {
  const Points wall = make_board(14, -9, 9, 3);
  MaskedImage image;
  image.add_mask(kMaskedCar, 10);
  const std::vector<MaskVote> votes = image.vote(join_points(kMaskedCar, wall));
  EXPECT_EQ(count_votes(votes, MaskVote::object, 0, kMaskedCar.size()), count_points(kMaskedCar));
  EXPECT_EQ(count_votes(votes, MaskVote::object, kMaskedCar.size(), votes.size()), 0);
  EXPECT_GT(count_votes(votes, MaskVote::background, kMaskedCar.size(), votes.size()), count_points(wall) / 2);
}

TEST(MaskedReturns, AreUnclearOnAThingBehindTheObject) {
  const Points behind = make_board(20, -1.5, 1.5, 0.8);
  MaskedImage image;
  image.add_mask(kMaskedCar, 1);
  image.add_mask(behind, 0);
  const std::vector<MaskVote> votes = image.vote(join_points(kMaskedCar, behind));
  EXPECT_EQ(count_votes(votes, MaskVote::object, 0, kMaskedCar.size()), count_points(kMaskedCar));
  EXPECT_EQ(count_votes(votes, MaskVote::unclear, kMaskedCar.size(), votes.size()), count_points(behind));
}

TEST(MaskedSurfaces, ShowNothingOfPointsBehindThemOrOutsideTheImage) {
  const Points behind = make_board(20, -0.5, 0.5, 1.0);
  MaskedImage image;
  image.add_mask(kMaskedCar, 1);
  const SE3 lidar_from_world = image.drive.poses.at(0)->inverse();
  const auto mask = std::make_shared<const cv::Mat1b>(image.mask);
  const MaskedSurfaces surfaces(
      {image.labels.data(), &image.drive.camera, lidar_from_world, image.camera_from_world(), mask, mask},
      join_points(kMaskedCar, behind));
  for (const Eigen::Vector3d& point : kMaskedCar) EXPECT_EQ(surfaces.shows_masked(point), true);
  for (const Eigen::Vector3d& point : behind) EXPECT_EQ(surfaces.shows_masked(point), std::nullopt);
  EXPECT_EQ(surfaces.shows_masked({10, 3, 1}), false);
  EXPECT_EQ(surfaces.shows_masked({-10, 0, 1}), std::nullopt);
}

TEST(MaskedReturns, AreJudgedByEachPartOfTheMask) {
  // The farther car is beside the nearer one in the image, with a mask of its own.
  const Points farther = make_board(20, 4, 6, 1.5);
  MaskedImage image;
  image.add_mask(kMaskedCar, 1);
  image.add_mask(farther, 1);
  EXPECT_EQ(count_votes(image.vote(join_points(kMaskedCar, farther)), MaskVote::object),
            count_points(kMaskedCar) + count_points(farther));
}

TEST(MaskedReturns, AreObjectsInTheMaskedPartOfAThingThatTouches) {
  const Points hedge = make_board(10, 1.1, 3.5, 1.5), long_hedge = make_board(10, 1.1, 6, 1.5);
  MaskedImage image;
  image.add_mask(kMaskedCar, 0);
  const std::vector<MaskVote> votes = image.vote(join_points(kMaskedCar, hedge));
  EXPECT_EQ(count_votes(votes, MaskVote::object, 0, kMaskedCar.size()), count_points(kMaskedCar));
  EXPECT_EQ(count_votes(votes, MaskVote::object, kMaskedCar.size(), votes.size()), 0);
  EXPECT_GT(count_votes(votes, MaskVote::background, kMaskedCar.size(), votes.size()), count_points(hedge) / 2);
  EXPECT_EQ(count_votes(image.vote(join_points(kMaskedCar, long_hedge)), MaskVote::object), 0)
      << "the mask covers a small part of the hedge";
}

TEST(MaskedReturns, AreBackgroundOutsideTheMasksButForTheirBoundary) {
  MaskedImage image;
  const Points wall = make_board(14, -9, 9, 3);
  EXPECT_EQ(count_votes(image.vote(wall), MaskVote::background), count_points(wall));
  constexpr int kMaskedColumns = 70, kBoundaryPx = 3;  // less than 0.3 of the wall is masked
  image.mask(cv::Rect(0, 0, kMaskedColumns, image.mask.rows)) = 255;
  const std::vector<MaskVote> votes = image.vote(wall);
  for (std::size_t i = 0; i < wall.size(); ++i)
    EXPECT_EQ(votes[i], image.to_column(wall[i]) < kMaskedColumns + kBoundaryPx ? MaskVote::unclear : MaskVote::background)
        << wall[i].transpose();
}

TEST(MaskedReturns, AreUnseenOutsideTheImage) {
  MaskedImage image;
  image.mask = 255;
  const Points behind = make_board(-10, -1, 1, 1.5), aside = make_board(2, 5, 6, 1.5);
  EXPECT_EQ(count_votes(image.vote(behind), MaskVote::unseen), count_points(behind));
  EXPECT_EQ(count_votes(image.vote(aside), MaskVote::unseen), count_points(aside));
}

TEST(MaskedReturns, AreObjectsInBoxesWithoutAMask) {
  const Points other = make_board(10, 3, 5, 1.5);
  MaskedImage image;
  Label label;
  label.box = Box{{Eigen::Matrix3d::Identity(), {11, 0, -0.8}}, {2, 2, 1.4}};
  image.labels[0] = {label};
  const std::vector<MaskVote> votes = image.vote(join_points(kMaskedCar, other));
  EXPECT_EQ(count_votes(votes, MaskVote::object, 0, kMaskedCar.size()), count_points(kMaskedCar));
  EXPECT_EQ(count_votes(votes, MaskVote::background, kMaskedCar.size(), votes.size()), count_points(other));
}

TEST(MaskedReturns, AreUnseenWithoutAFrameNearTheScan) {
  MaskedImage image;
  image.add_mask(kMaskedCar, 1);
  EXPECT_EQ(count_votes(image.vote(kMaskedCar, -100'000'000), MaskVote::object), count_points(kMaskedCar));
  EXPECT_EQ(count_votes(image.vote(kMaskedCar, -100'000'001), MaskVote::unseen), count_points(kMaskedCar));
  image.drive.poses = Trajectory();
  const CameraEvidence evidence{image.drive, image.drive.poses, "drive", {MaskSource::files}};
  const Lazy<cv::Mat1b> masks(2, [&](std::size_t) { return image.mask; });
  ObstacleReturns returns;
  returns.points = kMaskedCar;
  EXPECT_EQ(count_votes(vote_by_masks({{evidence, masks, masks, shared(image.labels)}}, returns, 0), MaskVote::unseen),
            count_points(kMaskedCar));
  EXPECT_EQ(count_votes(vote_by_masks({}, returns, 0), MaskVote::unseen), count_points(kMaskedCar));
  EXPECT_TRUE(image.vote({}).empty());
}

// Votes for the returns of the car by the masks of two cameras at the same place.
std::vector<MaskVote> vote_by_two_cameras(const cv::Mat1b& first, const cv::Mat1b& second) {
  const Drive drive = PlainDrive(2, 0).drive;
  const CameraEvidence evidence{drive, drive.poses, "drive", {MaskSource::files}};
  const Lazy<cv::Mat1b> of_first(2, [&](std::size_t) { return first; }), of_second(2, [&](std::size_t) { return second; });
  const SharedLabels none = shared(FrameLabels(2));
  ObstacleReturns returns;
  returns.points = kMaskedCar;
  return vote_by_masks({{evidence, of_first, of_first, none}, {evidence, of_second, of_second, none}}, returns, 0);
}

TEST(MaskedReturns, AreObjectsIfOneOfTwoCamerasMasksThemAndTheOtherMasksNothing) {
  MaskedImage image;
  image.add_mask(kMaskedCar, 1);
  const cv::Mat1b empty(image.mask.size(), uchar{0});
  EXPECT_EQ(count_votes(vote_by_two_cameras(empty, image.mask), MaskVote::object), count_points(kMaskedCar));
  EXPECT_EQ(count_votes(vote_by_two_cameras(image.mask, empty), MaskVote::object), count_points(kMaskedCar));
}

TEST(MaskedReturns, AreDisputedIfOneOfTwoCamerasMasksThemAndTheOtherSomethingElse) {
  MaskedImage image;
  image.add_mask(kMaskedCar, 1);
  cv::Mat1b elsewhere(image.mask.size(), uchar{0});
  elsewhere(cv::Rect(elsewhere.cols - 4, elsewhere.rows - 4, 4, 4)) = 255;
  ASSERT_EQ(cv::countNonZero(elsewhere & image.mask), 0);
  EXPECT_EQ(count_votes(vote_by_two_cameras(elsewhere, image.mask), MaskVote::disputed), count_points(kMaskedCar));
  EXPECT_EQ(count_votes(vote_by_two_cameras(image.mask, elsewhere), MaskVote::disputed), count_points(kMaskedCar));
  EXPECT_EQ(count_votes(vote_by_two_cameras(elsewhere, elsewhere), MaskVote::background), count_points(kMaskedCar));
  EXPECT_EQ(count_votes(vote_by_two_cameras(image.mask, image.mask), MaskVote::object), count_points(kMaskedCar));
}

}  // namespace
}  // namespace dvi::objects
