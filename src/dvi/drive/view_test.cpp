#include "dvi/drive/view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/core/random.h"
#include "dvi/drive/near_views.h"
#include "dvi/drive/vignetting.h"

namespace dvi {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Makes one view per position along x, of the given drive.
Views views_at(const std::vector<std::pair<int, double>>& places) {
  Views out;
  for (const auto& [drive, x] : places) {
    View view;
    view.sequence = view.drive = drive;
    view.camera_from_world.t.x() = -x;
    out.views.push_back(view);
  }
  return out;
}

TEST(Views, HaveARangePerSequence) {
  const Views views = views_at({{0, 0}, {0, 1}, {1, 0}, {2, 0}, {2, 1}, {2, 2}});
  EXPECT_EQ(views.of_sequence(0), std::pair(std::size_t{0}, std::size_t{2}));
  EXPECT_EQ(views.of_sequence(1), std::pair(std::size_t{2}, std::size_t{3}));
  EXPECT_EQ(views.of_sequence(2), std::pair(std::size_t{3}, std::size_t{6}));
}

TEST(Views, HaveAnEmptyRangeForAMissingDrive) {
  const Views views = views_at({{0, 0}, {0, 1}});
  EXPECT_EQ(views.of_sequence(1), std::pair(std::size_t{2}, std::size_t{2}));
  EXPECT_EQ(Views().of_sequence(0), std::pair(std::size_t{0}, std::size_t{0}));
}

TEST(Vignetting, IsTheCos4LawAndConvertsBetweenPositions) {
  View view;
  view.camera = {200, 200, 100, 100, 100, 100, {}};
  EXPECT_EQ(vignetting(view, {200, 100}), 1);
  view.vignetting = 2;
  EXPECT_EQ(vignetting(view, {100, 100}), 1);
  EXPECT_NEAR(vignetting(view, {200, 100}), 0.25, 1e-6) << "45 degrees";
  EXPECT_NEAR(vignetting_to(view, {100, 100}, view, {200, 100}), 4, 1e-5);
  EXPECT_EQ(vignetting_to(view, {30, 40}, view, {30, 40}), 1);
}

TEST(Vignetting, DarkensNothingSaturated) {
  const cv::Vec3f wall(255, 240, 200), paint(240, 240, 200);
  EXPECT_EQ(apply_vignetting(wall, 0.5F), wall);
  EXPECT_EQ(apply_vignetting(wall, 2), 2 * wall);
  EXPECT_EQ(apply_vignetting(paint, 0.5F), 0.5F * paint);
}

TEST(Views, ConvertIlluminationByGains) {
  View target, source;
  target.gain = {2, 1, 0.5};
  source.gain = {1, 3, 0.5};
  EXPECT_EQ(gain_to(target, source), cv::Vec3f(0.5, 3, 1));
  EXPECT_EQ(gain_to(source, source), cv::Vec3f(1, 1, 1));
}

TEST(Views, AreFoundByTheNumberOfTheDrive) {
  const Views views = views_at({{0, 0}, {0, 1}, {2, 7}, {2, 1}, {2, 2}});  // drive 1 has no pose
  using Range = std::pair<std::size_t, std::size_t>;
  EXPECT_EQ(views.sequences(), 3);
  EXPECT_EQ(views.of_sequence(0), Range(0, 2));
  EXPECT_EQ(views.of_sequence(1), Range(2, 2));
  EXPECT_EQ(views.of_sequence(2), Range(2, 5));
  EXPECT_EQ(Views().sequences(), 0);
}

TEST(NearViews, AreInOrderOfDistance) {
  const Views views = views_at({{0, 10}, {0, 0}, {0, 13}, {0, 9}, {0, 5}});
  EXPECT_THAT(find_nearest_views(views, 0, {1, 5}, {3}), ElementsAre(3, 2, 4));
  EXPECT_THAT(find_nearest_views(views, 0, {1, 5}, {9}), ElementsAre(3, 2, 4, 1));
  EXPECT_THAT(find_nearest_views(views, 0, {1, 5}, {0}), IsEmpty());
  EXPECT_THAT(find_nearest_views(views, 0, {1, 1}, {3}), IsEmpty());
}

TEST(NearViews, AreInOrderOfNumberForEqualDistances) {
  const Views views = views_at({{0, 10}, {0, 11}, {0, 9}, {0, 11}});
  EXPECT_THAT(find_nearest_views(views, 0, {1, 4}, {2}), ElementsAre(1, 2));
}

TEST(NearViews, CountDirectionsInMeters) {
  Views views = views_at({{0, 0}, {1, 1}, {1, 3}});
  const auto look_back = [](View& view) {  // at its position
    const Eigen::Matrix3d turn = so3_exp({0, 3, 0});
    view.camera_from_world = SE3{turn, {0, 0, 0}} * view.camera_from_world;
  };
  look_back(views.views[1]);
  EXPECT_THAT(find_nearest_views(views, 0, {1, 3}, {1}), ElementsAre(1));
  EXPECT_THAT(find_nearest_views(views, 0, {1, 3}, {1, 10}), ElementsAre(2));
}

TEST(NearViews, OfOtherDrivesExcludeThatOfTheTarget) {
  const Views views = views_at({{0, 0}, {0, 1}, {1, 7}, {1, 1}, {1, 2}, {2, 9}, {2, 0}});
  EXPECT_THAT(find_nearest_views_of_other_drives(views, 0, 2), ElementsAre(3, 4, 6, 5));
  EXPECT_THAT(find_nearest_views_of_other_drives(views_at({{0, 0}, {2, 7}}), 0, 2), ElementsAre(1));
  EXPECT_THAT(find_nearest_views_of_other_drives(views, 3, 1), ElementsAre(1, 6));
  EXPECT_THAT(find_nearest_views_of_other_drives(views_at({{0, 0}, {0, 1}}), 0, 4), IsEmpty());
}

TEST(NearViews, OfOtherCamerasAreThoseOfTheSameTime) {
  constexpr std::int64_t kStepNs = 100;
  Views views;
  for (int sequence = 0; sequence < 3; ++sequence)  // the second camera is triggered later; the third one is of another drive
    for (int i = 0; i < 5; ++i) {
      View view;
      view.sequence = sequence;
      view.drive = sequence == 2 ? 2 : 0;
      view.time_ns = i * kStepNs + (sequence == 1 ? 40 : 0);
      views.views.push_back(view);
    }
  EXPECT_THAT(list_views_of_other_cameras(views, 2, 0), ElementsAre(7));
  EXPECT_THAT(list_views_of_other_cameras(views, 2, 1), ElementsAre(6, 7, 8));
  EXPECT_THAT(list_views_of_other_cameras(views, 0, 9), ElementsAre(5, 6, 7, 8, 9));
  EXPECT_THAT(list_views_of_other_cameras(views, 12, 9), IsEmpty());
}

}  // namespace
}  // namespace dvi
