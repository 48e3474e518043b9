#include "dvi/objects/cluster_returns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace dvi::objects {
namespace {

// Returns on a car far from the origin of the world.
std::vector<ClusterReturn> make_returns() {
  std::vector<ClusterReturn> out;
  for (int i = 0; i < 50; ++i)
    out.push_back({Eigen::Vector3d(691'000.123 + 0.09 * i, -5'335'000.456 + 0.037 * i, 512.3 + 0.03 * i),
                   1'700'000'000'123'456'789 + 2'000'123 * i, 511.2 - 0.001 * i, 0.02 * i});
  return out;
}

ClusterReturns pack(const std::vector<ClusterReturn>& returns) {
  ClusterReturns out;
  for (const ClusterReturn& r : returns) out.push_back(r);
  return out;
}

TEST(ClusterReturns, AreStoredWithSmallErrors) {
  const std::vector<ClusterReturn> given = make_returns();
  const ClusterReturns packed = pack(given);
  ASSERT_EQ(packed.size(), given.size());
  std::size_t i = 0;
  for (const ClusterReturn& r : packed) {
    EXPECT_LE((r.point - given[i].point).cwiseAbs().maxCoeff(), 8e-6) << i;
    EXPECT_NEAR(r.ground, given[i].ground, 8e-6) << i;
    EXPECT_FLOAT_EQ(static_cast<float>(r.ray_spacing_m), static_cast<float>(given[i].ray_spacing_m)) << i;
    EXPECT_LT(std::abs(r.time_ns - given[i].time_ns), 100) << i;
    ++i;
  }
  EXPECT_EQ(i, given.size());
  EXPECT_NEAR(packed.median_ground(), 511.2 - 0.001 * 24, 8e-6);
  EXPECT_NEAR(packed.median_ray_spacing_m(), 0.5, 1e-6);
}

TEST(ClusterReturns, AreEqualWhateverTheFirstReturnIs) {
  std::vector<ClusterReturn> given = make_returns();
  const ClusterReturns forward = pack(given);
  std::reverse(given.begin(), given.end());
  const ClusterReturns backward = pack(given);
  for (std::size_t i = 0; i < given.size(); ++i) {
    const ClusterReturn a = forward[i], b = backward[given.size() - 1 - i];
    EXPECT_EQ(a.point, b.point) << i;
    EXPECT_EQ(a.time_ns, b.time_ns) << i;
    EXPECT_EQ(a.ground, b.ground) << i;
  }
}

TEST(ClusterReturns, HaveSmallCountsToo) {
  EXPECT_TRUE(ClusterReturns().empty());
  ClusterReturns one;
  one.push_back({{1, 2, 3}, -150, -1, 0.25});
  EXPECT_EQ(one.front().point, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(one.median_ground(), -1);
  EXPECT_EQ(one.median_ray_spacing_m(), 0.25);
}

}  // namespace
}  // namespace dvi::objects
