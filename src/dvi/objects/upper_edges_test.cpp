#include "dvi/objects/upper_edges.h"

#include <gtest/gtest.h>

#include <memory>

#include <opencv2/imgproc.hpp>

#include "dvi/drive/outline.h"
#include "dvi/image/region.h"
#include "dvi/objects/motion_segmentation.h"
#include "dvi/synth/scene.h"

namespace dvi::objects {
namespace {

// A street with a truck of 3.5 m close ahead, above the highest rays of a LiDAR on a car.
struct TruckStreet {
  std::shared_ptr<const synth::Scene> scene;
  Drive drive;
  std::vector<Track> tracks;

  explicit TruckStreet(int frames, const cv::Mat3b& image = {}) {
    synth::SynthOptions options;
    options.frames = frames;
    options.seed = 5;
    options.width = 480;
    options.height = 270;
    options.beams = 16;
    options.columns = 900;
    options.truck = true;
    scene = std::make_shared<const synth::Scene>(options);
    drive = synth::drive_of(scene);
    for (Frame& frame : drive.frames) frame.labels.clear();
    if (!image.empty())
      drive.images = Lazy<cv::Mat3b>(drive.frames.size(), drive.frames.size(), [image](std::size_t) { return image.clone(); });
    const ground::ScanGround ground(drive, drive.poses);
    MovingReturns returns(drive, {drive.poses}, ground);
    tracks = segment_motion(returns, [] {}).tracks;
    find_upper_edges({drive, drive.poses, "street", {MaskSource::found}}, returns, tracks);
  }

  // Returns the track of the truck, which is the widest object.
  const Track* truck() const {
    const auto widest = std::max_element(tracks.begin(), tracks.end(),
                                         [](const Track& a, const Track& b) { return a.size_m.y() < b.size_m.y(); });
    return widest == tracks.end() ? nullptr : &*widest;
  }
};

TEST(UpperEdges, OfATruckIsFoundInTheImages) {
  const TruckStreet street(12);
  ASSERT_NE(street.truck(), nullptr);
  EXPECT_TRUE(street.truck()->reaches_above_scans);
  EXPECT_NEAR(street.truck()->height_m, 3.5, 0.2);
  const FrameLabels labels = draw_outlines(street.tracks, street.drive, street.drive.poses, 0.3);
  for (const std::size_t frame : {2U, 8U}) {
    const synth::SynthFrame truth = street.scene->render(static_cast<int>(frame));
    const cv::Rect upper(0, 0, truth.dynamic.cols, truth.dynamic.rows / 2);  // without shadows
    const cv::Mat1b found = draw_instances(labels[frame], truth.dynamic.size())(upper), traffic = truth.dynamic(upper);
    EXPECT_GT(cv::countNonZero(found & traffic), 0.98 * cv::countNonZero(traffic)) << "frame " << frame;
    EXPECT_EQ(cv::countNonZero(found & ~grown(traffic, 16)), 0) << "frame " << frame;
  }
  for (const Track& track : street.tracks)
    if (&track != street.truck()) {
      EXPECT_FALSE(track.reaches_above_scans);
      EXPECT_LT(track.height_m, 2.2);
    }
}

TEST(UpperEdges, AreNotInventedWithoutEdges) {
  const TruckStreet street(8, cv::Mat3b(270, 480, cv::Vec3b(90, 100, 110)));
  ASSERT_NE(street.truck(), nullptr);
  EXPECT_FALSE(street.truck()->reaches_above_scans);
  EXPECT_LT(street.truck()->height_m, 2.6);
}

}  // namespace
}  // namespace dvi::objects
