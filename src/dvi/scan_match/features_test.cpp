#include "dvi/scan_match/features.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/testing/test_street.h"

namespace dvi::scan_match {
namespace {

Scan standing_scan(bool rings) {
  TestStreet street;
  street.rings = rings;
  return street.scan(TestStreet::path(0), 0);
}

/// Returns the scan with its points in another order.
Scan reordered(const Scan& scan, const std::vector<std::uint32_t>& order) {
  Scan out;
  for (const std::uint32_t i : order) {
    out.points.push_back(scan.points[i]);
    out.intensity.push_back(scan.intensity[i]);
    out.time.push_back(scan.time[i]);
    if (!scan.ring.empty()) out.ring.push_back(scan.ring[i]);
  }
  return out;
}

std::vector<std::uint32_t> beam_after_beam(const Scan& with_rings) {
  std::vector<std::uint32_t> order(with_rings.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return with_rings.ring[a] < with_rings.ring[b]; });
  return order;
}

// Expects that each found beam has points of only one true beam.
void expect_true_beams(const Rings& rings, const std::vector<std::uint16_t>& truth) {
  EXPECT_THAT(rings.points.size(), testing::AllOf(testing::Ge(31), testing::Le(33)));
  std::size_t astray = 0;
  for (const auto& beam : rings.points)
    for (const std::uint32_t i : beam) astray += truth[i] != truth[beam[beam.size() / 2]] ? 1 : 0;
  EXPECT_LE(astray, 20);
}

TEST(Rings, AreReadFromTheFile) {
  const Scan scan = standing_scan(true);
  const Rings rings = find_rings(scan);
  EXPECT_EQ(rings.source, Rings::Source::file);
  expect_true_beams(rings, scan.ring);
  for (const auto& beam : rings.points)
    for (std::size_t k = 1; k < beam.size(); ++k) ASSERT_LE(scan.time[beam[k - 1]], scan.time[beam[k]]);
}

TEST(Rings, AreFoundByElevationForPointsInOrderOfTime) {
  const Rings rings = find_rings(standing_scan(false));
  EXPECT_EQ(rings.source, Rings::Source::elevation);
  expect_true_beams(rings, standing_scan(true).ring);
}

TEST(Rings, AreFoundByRevolutionsForConsecutiveBeams) {
  const Scan known = standing_scan(true);
  const Scan sorted = reordered(known, beam_after_beam(known));
  Scan unknown = sorted;
  unknown.ring.clear();
  const Rings rings = find_rings(unknown);
  EXPECT_EQ(rings.source, Rings::Source::order);
  expect_true_beams(rings, sorted.ring);
}

TEST(Rings, AreNotReadFromWrongNumbers) {
  Scan scan = standing_scan(true);
  for (std::size_t i = 0; i < scan.size(); ++i) scan.ring[i] = static_cast<std::uint16_t>(i % 7);
  EXPECT_EQ(find_rings(scan).source, Rings::Source::elevation);
  Random random(1);
  for (std::uint16_t& r : scan.ring) r = static_cast<std::uint16_t>(random.uniform(0, 40));
  EXPECT_EQ(find_rings(scan).source, Rings::Source::elevation);
}

TEST(Rings, AreNotFoundInAnUnorderedCloud) {
  Random random(3);
  Scan scan;
  for (int i = 0; i < 5000; ++i) {
    scan.points.emplace_back(random.uniform(-30, 30), random.uniform(-30, 30), random.uniform(-2, 8));
    scan.time.push_back(0);
  }
  EXPECT_EQ(find_rings(scan).source, Rings::Source::none);
  EXPECT_EQ(find_rings({}).source, Rings::Source::none);
  EXPECT_GT(find_features(scan, find_rings(scan), {}).planes.size(), 4000);
  EXPECT_TRUE(find_features({}, {}, {}).planes.empty());
}

TEST(Features, ArePlanesOnFlatSurfacesAndEdgesOnPoles) {
  TestStreet street;
  street.boxes.clear();
  street.add({-500, -500, -1}, {500, 500, 0});
  street.add({-20, 10, 0}, {20, 12, 8});
  street.add({4.9, 4.9, 0}, {5.1, 5.1, 6});  // a pole in front of the wall
  const Scan scan = street.scan(TestStreet::path(0), 0);
  const Features features = find_features(scan, find_rings(scan), {});
  EXPECT_GT(features.planes.size(), 3000);
  for (const Feature& f : features.planes) {
    const double ground = std::abs(f.point.z() + 1.8), wall = std::abs(f.point.y() - 10);
    EXPECT_LT(std::min(ground, wall), 0.06) << f.point.transpose();
  }
  const auto on_pole = [](const Feature& f) { return (f.point.head<2>() - Eigen::Vector2f(8, 5)).norm() < 0.25; };
  EXPECT_GE(std::count_if(features.edges.begin(), features.edges.end(), on_pole), 10);
}

TEST(Features, AreThinnedToOnePerCube) {
  std::vector<Feature> features;
  for (int i = 0; i < 100; ++i) features.push_back({{0.1F * static_cast<float>(i) + 0.05F, 0.01F, 0.01F}, 0});
  EXPECT_EQ(thin_features(features, 1).size(), 10);
}

}  // namespace
}  // namespace dvi::scan_match
