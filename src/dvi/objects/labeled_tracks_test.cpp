#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>

#include "dvi/drive/outline.h"
#include "dvi/image/region.h"
#include "dvi/objects/clusters.h"
#include "dvi/objects/draw_masks.h"
#include "dvi/objects/motion_segmentation.h"
#include "dvi/objects/test_recorded_street.h"

namespace dvi::objects {
namespace {

// Returns at a position, five with each label.
ObstacleReturns make_returns(const std::vector<std::pair<double, std::uint32_t>>& groups) {
  ObstacleReturns out;
  for (const auto& [x, label] : groups)
    for (int i = 0; i < 5; ++i) {
      out.points.emplace_back(x + 0.1 * i, 0, 1);
      out.label.push_back(label);
    }
  out.time_ns.resize(out.points.size());
  out.ground.resize(out.points.size());
  out.ray_spacing_m.resize(out.points.size());
  return out;
}

TEST(LabeledClusters, AreReturnsOfOneObject) {
  const std::vector<Cluster> near = find_labeled_clusters(make_returns({{10, 252}, {10.5, 252}, {20, 252}, {11, 0}}));
  ASSERT_EQ(near.size(), 2U) << "0 is not removed";
  EXPECT_EQ(near[0].returns.size(), 10U);
  EXPECT_EQ(near[0].label_class, 252);
  const std::vector<Cluster> kinds = find_labeled_clusters(make_returns({{10, 10}, {10.2, 252}, {10.2, 252}, {10.4, 30}}));
  ASSERT_EQ(kinds.size(), 2U) << "a person beside a car";
  EXPECT_EQ(kinds[0].returns.size(), 15U) << "a car of which a part is labeled as moving";
  EXPECT_EQ(kinds[0].label_class, 252);
  EXPECT_EQ(find_labeled_clusters(make_returns({{10, 1U << 16U | 10U}, {10.2, 2U << 16U | 10U}})).size(), 2U) << "instances";
}

// A street with exact labels of its points. All objects have the same class if it is given.
struct LabeledStreet : RecordedStreet {
  explicit LabeledStreet(std::uint32_t all_of_class = 0) : RecordedStreet(12) {
    drive.point_labels = {drive.scans.size(), 20, [scene = scene, all_of_class](std::size_t i) {
                            PointLabels labels{scene->scan(static_cast<int>(i)).label};
                            for (std::uint32_t& value : labels.values)
                              value = value == kStaticPointClass ? 0 : all_of_class != 0 ? all_of_class : value;
                            return labels;
                          }};
  }

  CameraEvidence evidence() const { return {drive, drive.poses, "street", {MaskSource::points}}; }
  Masks draw() const {
    Progress progress(ProgressStyle::quiet);
    return find_and_draw(Evidence({evidence()}), {}, progress);
  }
  // Returns the share of the traffic that masks cover, and the masked share relative to the traffic.
  std::pair<double, double> measure(const CameraMasks& masks) const {
    double covered = 0, masked = 0, all = 0;
    for (std::size_t i = 0; i < masks.images.size(); ++i) {
      const cv::Mat1b truth = scene->render(static_cast<int>(i)).dynamic;
      covered += cv::countNonZero(*masks.images[i] & truth);
      masked += cv::countNonZero(*masks.images[i]);
      all += cv::countNonZero(truth);
    }
    return {covered / all, masked / all};
  }
};

TEST(LabeledTracks, CoverTheTrafficInEveryFrame) {
  const LabeledStreet street;
  const Masks masks = street.draw();
  const auto [covered, masked] = street.measure(masks.front());
  EXPECT_GT(covered, 0.85);
  EXPECT_LT(masked, 2);
  std::set<std::string> types;
  for (const std::vector<Label>& frame : *masks.front().objects.labels)
    for (const Label& label : frame) {
      EXPECT_EQ(label.source, MaskSource::points);
      types.insert(label.type);
    }
  EXPECT_TRUE(types.contains("car"));
  for (const ObjectMotion& motion : masks.front().objects.motions) EXPECT_EQ(motion.state, MotionState::moving);
}

TEST(LabeledTracks, OfClassesWithoutMotionAreRemovedToo) {
  const LabeledStreet street(10);
  const Masks masks = street.draw();
  EXPECT_GT(street.measure(masks.front()).first, 0.75) << "without refinement and shadows";
  for (const ObjectMotion& motion : masks.front().objects.motions) EXPECT_EQ(motion.state, MotionState::unknown);
}

}  // namespace
}  // namespace dvi::objects
