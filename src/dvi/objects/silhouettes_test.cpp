#include "dvi/objects/silhouettes.h"

#include <gtest/gtest.h>

#include <cmath>

#include <opencv2/imgproc.hpp>

#include "dvi/image/region.h"
#include "dvi/objects/static_depth.h"
#include "dvi/objects/test_plain_drive.h"
#include "dvi/testing/memory_views.h"

namespace dvi::objects {
namespace {

constexpr std::size_t kFrame = 20;
const cv::Vec3b kSky(200, 180, 160), kRed(30, 30, 200);

// Images of the plain with an upright board that moves away ahead and to the left, so that all of the background around it is
// observed at other times.
struct FilmedBoard {
  PlainDrive plain{40, 0};
  std::shared_ptr<const ground::ScanGround> ground = std::make_shared<const ground::ScanGround>(plain.drive, plain.drive.poses);
  std::vector<View> views;
  std::vector<cv::Mat3b> images;
  std::vector<cv::Mat1b> boards;

  explicit FilmedBoard(const cv::Vec3b& color, double exposure_step = 0) {
    const Drive& drive = plain.drive;
    for (std::size_t i = 0; i < drive.frames.size(); ++i) {
      const SE3 camera_from_world = drive.camera_from_lidar * drive.poses.at(drive.frames[i].time_ns)->inverse();
      views.push_back({0, i, drive.frames[i].time_ns, drive.camera, camera_from_world});
      film(views.back(), {7 + 1.1 * static_cast<double>(i), 0.3 * (static_cast<double>(i) - kFrame)}, color,
           1 + exposure_step * static_cast<double>(i));
    }
  }

  cv::Mat1b refine(const std::vector<cv::Mat1b>& outlines) const {
    const Views masked = memory_views(views, images, outlines);
    const StaticScene scene{plain.drive, plain.drive.poses, shared(FrameLabels(views.size())), ground};
    return refine_silhouettes(masked, render_static_depth(scene, masked), ground)[kFrame]->clone();
  }
  std::vector<cv::Mat1b> dilate_boards(int radius_px) const {
    std::vector<cv::Mat1b> out;
    for (const cv::Mat1b& board : boards) out.push_back(grown(board, radius_px));
    return out;
  }

 private:
  void film(const View& view, const Eigen::Vector2d& board_at, const cv::Vec3b& color, double exposure) {
    const SE3 world_from_camera = view.camera_from_world.inverse();
    cv::Mat3b image(view.camera.height, view.camera.width, kSky);
    cv::Mat1b board(image.size(), uchar{0});
    for (int y = 0; y < image.rows; ++y)
      for (int x = 0; x < image.cols; ++x) {
        const Eigen::Vector3d ray = world_from_camera.R * view.camera.ray({x, y});
        const Eigen::Vector3d on_board = world_from_camera.t + (board_at.x() - world_from_camera.t.x()) / ray.x() * ray;
        if (std::abs(on_board.y() - board_at.y()) < 0.9 && on_board.z() > 0 && on_board.z() < 2.2) {
          board(y, x) = 255;
          image(y, x) = color;
        } else if (ray.z() < 0) {
          const Eigen::Vector2d foot = (world_from_camera.t - world_from_camera.t.z() / ray.z() * ray).head<2>();
          image(y, x) = cv::Vec3b::all(cv::saturate_cast<uchar>(sample_road(foot) * exposure));
        }
      }
    images.push_back(image);
    boards.push_back(board);
  }
};

TEST(Silhouettes, EndWithTheirObjectsAlsoIfTheExposureDrifts) {
  for (const double drift : {0.0, 0.01}) {
    const FilmedBoard filmed(kRed, drift);
    const cv::Mat1b found = filmed.refine(filmed.dilate_boards(14)), board = filmed.boards[kFrame];
    EXPECT_EQ(cv::countNonZero(board & ~found), 0);
    const cv::Mat1b boundary(grown(board, 14) & ~grown(board, 8));
    EXPECT_LT(cv::countNonZero(found & boundary), cv::countNonZero(boundary) / 20);
    EXPECT_EQ(cv::countNonZero(found & ~grown(board, 14)), 0);
  }
}

TEST(Silhouettes, IncludePartsThatTheirOutlinesMiss) {
  const FilmedBoard filmed(kRed);
  std::vector<cv::Mat1b> outlines = filmed.dilate_boards(0);
  for (std::size_t i = 0; i < outlines.size(); ++i) {  // the upper fifth is glass
    const cv::Rect box = cv::boundingRect(outlines[i]);
    outlines[i].rowRange(box.y, box.y + box.height / 5) = 0;
  }
  const cv::Mat1b board = filmed.boards[kFrame];
  ASSERT_GT(cv::countNonZero(board & ~outlines[kFrame]), 100);
  const cv::Mat1b found = filmed.refine(outlines);
  EXPECT_EQ(cv::countNonZero(board & ~found), 0);
  EXPECT_EQ(cv::countNonZero(found & ~grown(board, 10)), 0);
}

TEST(Silhouettes, KeepOutlinesOfObjectsWithTheColorOfTheBackground) {
  const FilmedBoard filmed(kSky);
  const std::vector<cv::Mat1b> outlines = filmed.dilate_boards(8);
  const cv::Mat1b found = filmed.refine(outlines), board = filmed.boards[kFrame];
  EXPECT_EQ(cv::countNonZero(board & ~found), 0);
}

TEST(Silhouettes, KeepNarrowObjectsBesideWideOnes) {
  const FilmedBoard filmed(kRed);
  std::vector<cv::Mat1b> outlines = filmed.dilate_boards(4);
  const cv::Rect narrow = cv::boundingRect(outlines[kFrame]), feet(narrow.x, narrow.br().y - 8, 3 * narrow.width, 8);
  const cv::Rect wide(feet.br().x, narrow.y - narrow.height, 200, 2 * narrow.height);  // hides its background in all views
  for (cv::Mat1b& outline : outlines)
    for (const cv::Rect& part : {feet, wide}) outline(part & cv::Rect({}, outline.size())) = 255;
  const cv::Mat1b board = filmed.boards[kFrame];
  EXPECT_EQ(cv::countNonZero(board & ~filmed.refine(outlines)), 0);
}

TEST(Silhouettes, KeepOutlinesWithAnUnobservedBackground) {
  FilmedBoard filmed(kRed);
  const std::vector<cv::Mat1b> outlines = filmed.dilate_boards(8);
  std::vector<cv::Mat1b> hidden(outlines.size(), cv::Mat1b(outlines[0].size(), uchar{255}));
  hidden[kFrame] = outlines[kFrame];
  EXPECT_EQ(cv::norm(filmed.refine(hidden), outlines[kFrame], cv::NORM_INF), 0);
}

TEST(Silhouettes, RejectOutlinesThatShowTheRoad) {
  const FilmedBoard filmed(kRed);
  std::vector<cv::Mat1b> outlines = filmed.dilate_boards(8);
  const cv::Mat1b real = filmed.refine(outlines);
  const cv::Rect phantom(220, 120, 60, 50);
  ASSERT_EQ(cv::countNonZero(outlines[kFrame](phantom)), 0);
  outlines[kFrame](phantom) = 255;
  EXPECT_EQ(cv::norm(filmed.refine(outlines), real, cv::NORM_INF), 0);
}

// A wall ahead, and an object before it within the box of a label.
TEST(StaticDepth, ExcludesReturnsWithinBoxes) {
  PlainDrive plain(3, 0);
  plain.drive.scans = Lazy<Scan>(3, 3, [](std::size_t i) {
    Scan scan;
    const auto put = [&](double x, double y, double z) {
      scan.points.emplace_back(static_cast<float>(x - 0.8 * static_cast<double>(i)), static_cast<float>(y),
                               static_cast<float>(z));
      scan.time.push_back(0);
    };
    for (double y = -6; y <= 6; y += 0.1)
      for (double z = -1; z <= 2; z += 0.1) {
        put(20, y, z);
        if (std::abs(y) < 1 && z < 0) put(10, y, z);
      }
    return scan;
  });
  const std::shared_ptr<const ground::ScanGround> ground =
      std::make_shared<const ground::ScanGround>(PlainDrive(3, 0).drive, PlainDrive(3, 0).drive.poses);
  Views views;
  for (std::size_t i = 0; i < 3; ++i)
    views.views.push_back({0, i, plain.drive.frames[i].time_ns, plain.drive.camera,
                           plain.drive.camera_from_lidar * plain.drive.poses.at(plain.drive.frames[i].time_ns)->inverse()});
  const auto depth_with = [&](bool boxed) {
    FrameLabels labels(3);
    for (std::size_t i = 0; i < 3 && boxed; ++i) {
      Label label;
      label.box = Box{SE3{Eigen::Matrix3d::Identity(), {10 - 0.8 * static_cast<double>(i), 0, -0.5}}, {1, 2.2, 1.4}};
      labels[i].push_back(label);
    }
    return render_static_depth({plain.drive, plain.drive.poses, shared(labels), ground}, views)[0]->clone();
  };
  const cv::Point low(80, 46);  // half size: 0.5 m below the sensor at 10 m
  EXPECT_NEAR(depth_with(false)(low), 10, 0.1);
  EXPECT_NEAR(depth_with(true)(low), 20, 0.1);
  EXPECT_EQ(depth_with(true)(cv::Point(80, 5)), 0) << "sky";
}

}  // namespace
}  // namespace dvi::objects
