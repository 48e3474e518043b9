#include "dvi/objects/object_returns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <vector>

#include <opencv2/core.hpp>

#include "dvi/objects/find_objects.h"
#include "dvi/objects/test_recorded_street.h"

namespace dvi::objects {
namespace {

using Values = std::vector<std::uint32_t>;

bool moves(std::uint32_t value) { return is_moving_point_class(class_of_point(value)); }

// The labels of all scans of a street, with the true ones.
struct StreetLabels {
  std::vector<Values> truth, found;

  // Returns the share of the points for which `is_counted` holds that the labels show as moving.
  template <class IsCounted>
  double moving_share(const IsCounted& is_counted) const {
    double counted = 0, moving = 0;
    for (std::size_t scan = 0; scan < truth.size(); ++scan)
      for (std::size_t i = 0; i < truth[scan].size(); ++i) {
        if (!is_counted(truth[scan][i])) continue;
        ++counted;
        moving += moves(found[scan][i]);
      }
    return moving / counted;
  }
  std::set<std::uint32_t> values() const {
    std::set<std::uint32_t> out;
    for (const Values& scan : found) out.insert(scan.begin(), scan.end());
    return out;
  }
};

StreetLabels label_street(const RecordedStreet& street, const MaskSources& sources, const RemovalOptions& options = {}) {
  Progress progress(ProgressStyle::quiet);
  const Evidence evidence({{street.drive, street.drive.poses, "street", sources}});
  const ObjectReturns returns(find_scanned_objects(evidence, options, progress));
  StreetLabels out;
  for (std::size_t i = 0; i < street.drive.scans.size(); ++i) {
    out.truth.push_back(street.scene->scan(static_cast<int>(i)).label);
    out.found.push_back(returns.label(i).values);
  }
  return out;
}

TEST(ObjectReturns, OfMovingObjectsAreLabeled) {
  const StreetLabels labels = label_street(RecordedStreet(12), {MaskSource::found});
  EXPECT_GT(labels.moving_share(moves), 0.95);
  EXPECT_LT(labels.moving_share([](std::uint32_t value) { return !moves(value); }), 0.001);
  std::map<std::uint32_t, std::map<std::uint32_t, int>> tracks;  // true tracks by number of the object
  for (std::size_t scan = 0; scan < labels.truth.size(); ++scan)
    for (std::size_t i = 0; i < labels.truth[scan].size(); ++i)
      if (moves(labels.found[scan][i])) ++tracks[labels.found[scan][i] >> 16U][labels.truth[scan][i] >> 16U];
  EXPECT_GT(tracks.size(), 1U);
  for (const auto& [number, counts] : tracks) {
    int most = 0, all = 0;
    for (const auto& [track, count] : counts) most = std::max(most, count), all += count;
    EXPECT_GT(most, 0.8 * all) << "object " << number;
  }
}

TEST(ObjectReturns, InLabeledBoxesHaveTheClassAndNumberOfTheirLabel) {
  RecordedStreet street(8);
  street.drive = synth::drive_of(street.scene);  // with labels
  for (const bool complete : {true, false}) {
    RemovalOptions options;
    options.objects.complete = complete;
    const StreetLabels labels = label_street(street, {MaskSource::labels}, options);
    double equal = 0, moving = 0;
    for (std::size_t scan = 0; scan < labels.truth.size(); ++scan)
      for (std::size_t i = 0; i < labels.truth[scan].size(); ++i) {
        moving += moves(labels.truth[scan][i]);
        equal += moves(labels.truth[scan][i]) && labels.found[scan][i] == labels.truth[scan][i];
      }
    EXPECT_GT(equal, 0.85 * moving) << complete << ": the others are beyond 80 m or on the ground";
    EXPECT_LT(labels.moving_share([](std::uint32_t value) { return !moves(value); }), 0.001) << complete;
  }
}

TEST(ObjectReturns, ThatOnlyAMaskShowsHaveNoNumber) {
  RecordedStreet street(8);
  street.drive.masks = {street.drive.frames.size(), 4, [scene = street.scene](std::size_t i) {
                          const synth::SynthFrame frame = scene->render(static_cast<int>(i));
                          const auto& [image, clean, depth, depth_with_traffic, dynamic] = frame;
                          return cv::Mat1b(depth_with_traffic != depth);
                        }};
  RemovalOptions options;
  options.objects.complete = false;
  const StreetLabels labels = label_street(street, {MaskSource::files}, options);
  EXPECT_EQ(labels.values(), (std::set<std::uint32_t>{0, kUnnumberedInstance << 16U | 20U}));
  double masked = 0, moving = 0;
  for (std::size_t scan = 0; scan < labels.truth.size(); ++scan)
    for (std::size_t i = 0; i < labels.truth[scan].size(); ++i) {
      moving += moves(labels.truth[scan][i]);
      masked += moves(labels.truth[scan][i]) && labels.found[scan][i] != 0;
    }
  EXPECT_GT(masked, 0.6 * moving);
}

TEST(ObjectReturns, KeepTheLabelsOfPoints) {
  RecordedStreet street(8);
  street.drive.point_labels = {street.drive.scans.size(), 8, [scene = street.scene](std::size_t i) {
                                 PointLabels labels{scene->scan(static_cast<int>(i)).label};
                                 for (std::uint32_t& value : labels.values) value = value == kStaticPointClass ? 0 : value;
                                 return labels;
                               }};
  const StreetLabels labels = label_street(street, {MaskSource::points});
  EXPECT_EQ(labels.moving_share(moves), 1);
  std::size_t others = 0;
  for (std::size_t scan = 0; scan < labels.truth.size(); ++scan)
    for (std::size_t i = 0; i < labels.truth[scan].size(); ++i)
      others += moves(labels.truth[scan][i]) && class_of_point(labels.found[scan][i]) != class_of_point(labels.truth[scan][i]);
  EXPECT_EQ(others, 0U);
}

TEST(ObjectReturns, AreUnknownWithoutPoses) {
  RecordedStreet street(4);
  street.drive.poses = Trajectory();
  EXPECT_EQ(label_street(street, {MaskSource::found}).values(), std::set<std::uint32_t>{0});
}

}  // namespace
}  // namespace dvi::objects
