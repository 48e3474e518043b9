#include "dvi/scan_match/local_map.h"

#include <algorithm>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "dvi/core/random.h"

namespace dvi::scan_match {
namespace {

constexpr double kVoxelM = 0.5;

/// A brute-force oracle: the points of each voxel in order of insertion.
class Points {
 public:
  void add(const Eigen::Vector3d& x) { voxels_[voxel_key(x, kVoxelM)].push_back(x); }
  void remove(const Eigen::Vector3d& x) {
    const auto it = voxels_.find(voxel_key(x, kVoxelM));
    if (it == voxels_.end()) return;
    const auto found = std::find(it->second.begin() + 1, it->second.end(), x);
    if (found != it->second.end()) it->second.erase(found);
  }
  void keep_near(const Eigen::Vector3d& position, double radius_m) {
    std::erase_if(voxels_, [&](const auto& v) { return (v.second.front() - position).norm() > radius_m; });
  }
  const std::map<VoxelKey, std::vector<Eigen::Vector3d>>& voxels() const { return voxels_; }

 private:
  std::map<VoxelKey, std::vector<Eigen::Vector3d>> voxels_;
};

void expect_same(LocalMap& map, const Points& points) {
  EXPECT_EQ(map.size(), points.voxels().size());
  std::size_t shapes = 0, each = 0;
  for (const auto& [key, in] : points.voxels()) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& x : in) mean += x / static_cast<double>(in.size());
    const Shape* plane = map.at(in.front(), 1);
    const Shape* line = map.at(in.front(), 2);
    EXPECT_TRUE(plane == nullptr || line == nullptr);
    EXPECT_EQ(map.at(in.front(), 1) != nullptr, plane != nullptr) << "asked again";
    const Shape* shape = plane != nullptr ? plane : line;
    if (shape == nullptr) continue;
    ++shapes;
    ASSERT_EQ(shape->count, in.size());
    ASSERT_LT((shape->mean - mean).norm(), 1e-9);
  }
  map.each([&](const Shape&) { ++each; });
  EXPECT_EQ(each, shapes);
}

TEST(LocalMap, HoldsThePointsOfEachVoxel) {
  Random random(5);
  LocalMap map(kVoxelM);
  Points points;
  std::vector<Eigen::Vector3d> later;  // without the first points of voxels, which remain their origins
  for (int round = 0; round < 4; ++round) {
    for (int i = 0; i < 20000; ++i) {
      const Eigen::Vector3d x(10 * round + random.uniform(-12, 12), random.uniform(-12, 12), random.uniform(0, 0.05));
      const auto known = points.voxels().find(voxel_key(x, kVoxelM));
      if (known != points.voxels().end() && i % 3 == 0) later.push_back(x);
      map.add(x), points.add(x);
    }
    expect_same(map, points);
    for (const Eigen::Vector3d& x : later) map.remove(x), points.remove(x);
    later.clear();
    expect_same(map, points);
    const Eigen::Vector3d position(10 * round, 0, 0);
    map.keep_near(position, 9), points.keep_near(position, 9);
    expect_same(map, points);
  }
  EXPECT_GT(map.size(), 500U);
}

TEST(LocalMap, HasNoDroppedVoxels) {
  LocalMap map(kVoxelM);
  const Eigen::Vector3d x(0.1, 0.1, 0.1);
  for (int i = 0; i < 9; ++i) map.add(x + 0.1 * Eigen::Vector3d(i % 3, i / 3, 0));
  ASSERT_NE(map.at(x, 1), nullptr);
  map.keep_near({100, 0, 0}, 10);
  EXPECT_EQ(map.size(), 0U);
  EXPECT_EQ(map.at(x, 1), nullptr);
  map.remove(x);
  EXPECT_EQ(map.size(), 0U);
}

}  // namespace
}  // namespace dvi::scan_match
