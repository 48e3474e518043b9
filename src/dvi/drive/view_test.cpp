#include "dvi/drive/view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/core/random.h"
#include "dvi/drive/near_views.h"

namespace dvi {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// One view a place along x, of the drive given with it.
Views views_at(const std::vector<std::pair<int, double>>& places) {
  Views out;
  for (const auto& [drive, x] : places) {
    View view;
    view.drive = drive;
    view.camera_from_world.t.x() = -x;
    out.views.push_back(view);
  }
  return out;
}

TEST(Views, OfDriveIsItsRange) {
  const Views views = views_at({{0, 0}, {0, 1}, {1, 0}, {2, 0}, {2, 1}, {2, 2}});
  EXPECT_EQ(views.of_drive(0), std::pair(std::size_t{0}, std::size_t{2}));
  EXPECT_EQ(views.of_drive(1), std::pair(std::size_t{2}, std::size_t{3}));
  EXPECT_EQ(views.of_drive(2), std::pair(std::size_t{3}, std::size_t{6}));
}

TEST(Views, OfADriveThatIsNotThereIsEmptyAtTheEnd) {
  const Views views = views_at({{0, 0}, {0, 1}});
  EXPECT_EQ(views.of_drive(1), std::pair(std::size_t{2}, std::size_t{2}));
  EXPECT_EQ(Views().of_drive(0), std::pair(std::size_t{0}, std::size_t{0}));
}

TEST(Views, GainsBringOneLightIntoAnother) {
  View target, source;
  target.gain = {2, 1, 0.5};
  source.gain = {1, 3, 0.5};
  EXPECT_EQ(gain_to(target, source), cv::Vec3f(0.5, 3, 1));
  EXPECT_EQ(gain_to(source, source), cv::Vec3f(1, 1, 1));
}

TEST(Views, OfADriveAreFoundByItsNumber) {
  const Views views = views_at({{0, 0}, {0, 1}, {2, 7}, {2, 1}, {2, 2}});  // drive 1 has no pose
  using Range = std::pair<std::size_t, std::size_t>;
  EXPECT_EQ(views.drives(), 3);
  EXPECT_EQ(views.of_drive(0), Range(0, 2));
  EXPECT_EQ(views.of_drive(1), Range(2, 2));
  EXPECT_EQ(views.of_drive(2), Range(2, 5));
  EXPECT_EQ(Views().drives(), 0);
}

TEST(NearViews, AreInOrderOfDistance) {
  const Views views = views_at({{0, 10}, {0, 0}, {0, 13}, {0, 9}, {0, 5}});
  EXPECT_THAT(nearest_views(views, 0, {1, 5}, 3), ElementsAre(3, 2, 4));
  EXPECT_THAT(nearest_views(views, 0, {1, 5}, 9), ElementsAre(3, 2, 4, 1));
  EXPECT_THAT(nearest_views(views, 0, {1, 5}, 0), IsEmpty());
  EXPECT_THAT(nearest_views(views, 0, {1, 1}, 3), IsEmpty());
}

TEST(NearViews, AsNearTheyAreInOrderOfNumber) {
  const Views views = views_at({{0, 10}, {0, 11}, {0, 9}, {0, 11}});
  EXPECT_THAT(nearest_views(views, 0, {1, 4}, 2), ElementsAre(1, 2));
}

TEST(NearViews, DirectionsCountInMetres) {
  Views views = views_at({{0, 0}, {1, 1}, {1, 3}});
  const auto look_back = [](View& view) {  // where it stands
    const Eigen::Matrix3d turn = so3_exp({0, 3, 0});
    view.camera_from_world = SE3{turn, {0, 0, 0}} * view.camera_from_world;
  };
  look_back(views.views[1]);
  EXPECT_THAT(nearest_views(views, 0, {1, 3}, 1), ElementsAre(1));
  EXPECT_THAT(nearest_views(views, 0, {1, 3}, 1, 10), ElementsAre(2));
}

TEST(NearViews, OfOtherDrivesLeaveOutTheTargetsOwn) {
  const Views views = views_at({{0, 0}, {0, 1}, {1, 7}, {1, 1}, {1, 2}, {2, 9}, {2, 0}});
  EXPECT_THAT(nearest_of_other_drives(views, 0, 2), ElementsAre(3, 4, 6, 5));
  EXPECT_THAT(nearest_of_other_drives(views_at({{0, 0}, {2, 7}}), 0, 2), ElementsAre(1));
  EXPECT_THAT(nearest_of_other_drives(views, 3, 1), ElementsAre(1, 6));
  EXPECT_THAT(nearest_of_other_drives(views_at({{0, 0}, {0, 1}}), 0, 4), IsEmpty());
}

}  // namespace
}  // namespace dvi
