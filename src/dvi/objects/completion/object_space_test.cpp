#include "dvi/objects/completion/object_space.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "dvi/objects/completion/test_masked_drive.h"
#include "dvi/objects/test_moving_cuboids.h"

namespace dvi::objects {
namespace {

constexpr std::int64_t kToEnd = std::numeric_limits<std::int64_t>::max(), kFromStart = std::numeric_limits<std::int64_t>::min();

std::vector<Cuboid> no_movers(int) { return {}; }

// Draws the masks of the movers in the frames [first, last).
std::vector<cv::Mat1b> mask_movers(const Situation& situation, int first, int last) {
  std::vector<cv::Mat1b> masks(static_cast<std::size_t>(situation.scans));
  for (int i = first; i < last; ++i) masks[static_cast<std::size_t>(i)] = situation.draw_mask(i, situation.movers(i));
  return masks;
}

bool is_within(const Cuboid& cuboid, const OccupiedVoxel& voxel) {
  return (voxel.center().array() > cuboid.min().array() - kObjectVoxelM).all() &&
         (voxel.center().array() < cuboid.max().array() + kObjectVoxelM).all();
}

std::set<int> find_numbers(const std::vector<OccupiedVoxel>& voxels) {
  std::set<int> out;
  for (const OccupiedVoxel& voxel : voxels) out.insert(voxel.object);
  return out;
}

TEST(ObjectSpace, OfAParkedCarLastsForTheWholeDriveIfFewFramesMaskIt) {
  const Situation situation{.scans = 24, .sensor_x = [](int scan) { return 0.3 * scan; }, .movers = no_movers};
  std::vector<cv::Mat1b> masks(24);
  for (const int i : {8, 9, 10, 12, 13, 14}) masks[static_cast<std::size_t>(i)] = situation.draw_mask(i, {Situation::parked()});
  const std::vector<OccupiedVoxel> space = MaskedDrive(situation.drive(), masks).find_space();
  ASSERT_GT(space.size(), 60U);
  EXPECT_EQ(find_numbers(space), std::set<int>{0});
  for (const OccupiedVoxel& voxel : space) EXPECT_TRUE(is_within(Situation::parked(), voxel)) << voxel.center().transpose();
  const auto whole = std::count_if(space.begin(), space.end(), [](const OccupiedVoxel& voxel) {
    return voxel.first_ns == kFromStart && voxel.last_ns == kToEnd;
  });
  EXPECT_GT(static_cast<double>(whole), 0.9 * static_cast<double>(space.size()));
}

TEST(ObjectSpace, EndsWhereScansObserveFreeSpace) {
  constexpr int kArrives = 8, kLeaves = 20;
  const Situation situation{.scans = 26, .movers = [](int scan) {
                              return scan >= kArrives && scan < kLeaves ? std::vector<Cuboid>{car_at(14, 1)}
                                                                        : std::vector<Cuboid>{};
                            }};
  const std::vector<OccupiedVoxel> space = MaskedDrive(situation.drive(), mask_movers(situation, 11, 15)).find_space();
  ASSERT_GT(space.size(), 40U);
  std::size_t exact = 0;
  for (const OccupiedVoxel& voxel : space) {
    EXPECT_TRUE(is_within(car_at(14, 1), voxel)) << voxel.center().transpose();
    exact +=
        voxel.first_ns == (kArrives - 1) * PlainDrive::kScanPeriodNs && voxel.last_ns == kLeaves * PlainDrive::kScanPeriodNs;
  }
  EXPECT_GT(static_cast<double>(exact), 0.8 * static_cast<double>(space.size()));
}

TEST(ObjectSpace, IsEmptyIfOneFrameMasksAWall) {
  const Situation situation{.scans = 12, .movers = no_movers};
  std::vector<cv::Mat1b> masks(12);
  masks[5] = situation.draw_mask(5, Situation::houses());
  EXPECT_TRUE(MaskedDrive(situation.drive(), masks).find_space().empty());
}

TEST(ObjectSpace, IsEmptyIfFewOfManyFramesMaskAWall) {
  const Situation situation{.scans = 24, .movers = no_movers};
  std::vector<cv::Mat1b> masks(24);
  for (const std::size_t i : {5U, 6U, 7U}) masks[i] = situation.draw_mask(5, {Situation::houses()[8]});
  ASSERT_GT(cv::countNonZero(masks[5]), 5000);
  EXPECT_TRUE(MaskedDrive(situation.drive(), masks).find_space().empty());
}

// Finds the object space of a drive from the masks of two cameras at the same place.
std::vector<OccupiedVoxel> find_space_of_two_cameras(const Situation& situation, const std::vector<cv::Mat1b>& first,
                                                     const std::vector<cv::Mat1b>& second) {
  const MaskedDrive a(situation.drive(), first), b(situation.drive(), second);
  return find_object_space({a.cameras().front(), b.cameras().front()}, a.returns, [] {});
}

TEST(ObjectSpace, ExcludesTheHouseThatLooseMasksOfOneOfTwoCamerasCover) {
  const Situation situation{.scans = 24, .sensor_x = [](int scan) { return 0.3 * scan; }, .movers = no_movers};
  std::vector<cv::Mat1b> tight(24), loose(24);
  for (int i = 0; i < 24; ++i) {
    const auto frame = static_cast<std::size_t>(i);
    tight[frame] = situation.draw_mask(i, {Situation::parked()});
    loose[frame] = situation.draw_mask(i, {Situation::parked(), Situation::houses()[8]});
  }
  for (const auto& [first, second] : {std::pair(tight, loose), std::pair(loose, tight)}) {
    const std::vector<OccupiedVoxel> space = find_space_of_two_cameras(situation, first, second);
    EXPECT_GT(space.size(), 60U);
    for (const OccupiedVoxel& voxel : space) EXPECT_TRUE(is_within(Situation::parked(), voxel)) << voxel.center().transpose();
  }
  const std::vector<OccupiedVoxel> agreed = find_space_of_two_cameras(situation, loose, loose);
  EXPECT_TRUE(std::any_of(agreed.begin(), agreed.end(), [](const OccupiedVoxel& voxel) {
    return is_within(Situation::houses()[8], voxel);
  })) << "what both cameras mask is an object";
}

TEST(ObjectSpace, HasAnObjectThatTwoCamerasMissInDifferentFrames) {
  const Situation situation{.scans = 24,
                            .sensor_x = [](int scan) { return 0.3 * scan; },
                            .movers = [](int) { return std::vector<Cuboid>{car_at(16, 3)}; }};
  std::vector<cv::Mat1b> first(24), second(24);
  for (int i = 0; i < 24; ++i) {  // all masks show the other car
    const std::vector<Cuboid> one{car_at(16, 3)}, both{car_at(16, 3), Situation::parked()};
    first[static_cast<std::size_t>(i)] = situation.draw_mask(i, i % 2 == 0 ? both : one);
    second[static_cast<std::size_t>(i)] = situation.draw_mask(i, i % 3 == 0 ? one : both);
  }
  const std::vector<OccupiedVoxel> space = find_space_of_two_cameras(situation, first, second);
  const auto parked = std::count_if(space.begin(), space.end(),
                                    [](const OccupiedVoxel& voxel) { return is_within(Situation::parked(), voxel); });
  EXPECT_GT(parked, 60);
}

TEST(ObjectSpace, KeepsTheReturnsOfTwoObjectsThatCross) {
  const Situation situation{.scans = 24, .movers = [](int scan) {
                              return std::vector<Cuboid>{person_at(12, -3 + 0.25 * scan), car_at(20, 3 - 0.4 * scan)};
                            }};
  MaskedDrive masked(situation.drive(), mask_movers(situation, 0, 24));
  const std::vector<OccupiedVoxel> space = masked.find_space();
  std::set<int> persons, cars;  // the person hides the car for a time, so that the car may have several numbers
  for (const OccupiedVoxel& voxel : space) (voxel.center().x() < 16 ? persons : cars).insert(voxel.object);
  EXPECT_EQ(persons.size(), 1U);
  EXPECT_EQ(persons.size() + cars.size(), find_numbers(space).size()) << "no number is that of both objects";
  std::size_t all = 0, kept = 0;
  for (std::size_t scan = 0; scan < 24; ++scan)
    for (const Eigen::Vector3d& point : masked.returns.obstacles(scan)->points) {
      const std::vector<Cuboid> movers = situation.movers(static_cast<int>(scan));
      if (std::none_of(movers.begin(), movers.end(), [&](const Cuboid& c) { return c.exteriorDistance(point) < 0.1; }))
        continue;
      ++all;
      kept += std::any_of(space.begin(), space.end(), [&](const OccupiedVoxel& voxel) {
        return (voxel.center() - point).cwiseAbs().maxCoeff() <= 0.5 * kObjectVoxelM &&
               std::binary_search(voxel.returns.begin(), voxel.returns.end(), scan);
      });
    }
  ASSERT_GT(all, 3000U);
  // The masks are rectangles, like bounding boxes, in which the car behind the person is not the nearest thing.
  EXPECT_GT(static_cast<double>(kept), 0.9 * static_cast<double>(all));
}

TEST(ObjectSpace, DistinguishesObjectsAtOnePlaceAtDifferentTimes) {
  const Situation situation{.scans = 24, .movers = [](int scan) {
                              return scan < 8    ? std::vector<Cuboid>{person_at(12, 1)}
                                     : scan < 16 ? std::vector<Cuboid>{}
                                                 : std::vector<Cuboid>{person_at(12, 1)};
                            }};
  const std::vector<OccupiedVoxel> both = MaskedDrive(situation.drive(), mask_movers(situation, 0, 24)).find_space();
  EXPECT_EQ(find_numbers(both).size(), 2U);
  const std::vector<OccupiedVoxel> first = MaskedDrive(situation.drive(), mask_movers(situation, 0, 8)).find_space();
  EXPECT_EQ(find_numbers(first).size(), 1U);
  for (const OccupiedVoxel& voxel : first) EXPECT_LE(voxel.last_ns, 9 * PlainDrive::kScanPeriodNs);
}

TEST(ObjectSpace, IsEmptyWithoutPosesOrMasks) {
  const Situation situation{.scans = 6, .movers = [](int) { return std::vector<Cuboid>{car_at(14, 1)}; }};
  EXPECT_FALSE(MaskedDrive(situation.drive(), mask_movers(situation, 0, 6)).find_space().empty());
  EXPECT_TRUE(MaskedDrive(situation.drive(), {}).find_space().empty());
  Drive unposed = situation.drive();
  unposed.poses = Trajectory();
  EXPECT_TRUE(MaskedDrive(unposed, mask_movers(situation, 0, 6)).find_space().empty());
  const MaskedDrive masked(situation.drive(), {});
  EXPECT_TRUE(find_object_space({}, masked.returns, [] {}).empty());
}

}  // namespace
}  // namespace dvi::objects
