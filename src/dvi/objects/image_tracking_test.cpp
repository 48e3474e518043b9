#include <gtest/gtest.h>

#include <memory>

#include <opencv2/core.hpp>

#include "dvi/drive/outline.h"
#include "dvi/image/region.h"
#include "dvi/objects/image_tracking.h"
#include "dvi/objects/motion_segmentation.h"
#include "dvi/objects/static_depth.h"
#include "dvi/synth/scene.h"

namespace dvi::objects {
namespace {

// A street whose scans have no returns of moving objects from scan `blind` on.
struct BlindStreet {
  std::shared_ptr<const synth::Scene> scene;
  Drive drive;
  std::shared_ptr<const ground::ScanGround> ground;

  explicit BlindStreet(int frames, std::size_t blind) {
    synth::SynthOptions options;
    options.frames = frames;
    options.columns = 600;
    options.width = 480;
    options.height = 270;
    scene = std::make_shared<const synth::Scene>(options);
    drive = synth::drive_of(scene);
    for (Frame& frame : drive.frames) frame.labels.clear();
    const auto count = static_cast<std::size_t>(frames);
    drive.scans = Lazy<Scan>(count, count, [of = scene, blind](std::size_t i) {
      const synth::SynthScan all = of->scan(static_cast<int>(i));
      if (i < blind) return all.scan;
      Scan out;
      for (std::size_t k = 0; k < all.scan.size(); ++k) {
        if (all.dynamic[k] != 0) continue;
        out.points.push_back(all.scan.points[k]);
        out.time.push_back(all.scan.time[k]);
        out.intensity.push_back(all.scan.intensity[k]);
      }
      return out;
    });
    ground = std::make_shared<const ground::ScanGround>(drive, drive.poses);
  }

  Views views(const FrameLabels& labels) const {
    Views out = synth::views_of(scene);
    out.images = drive.images;
    out.masks = Lazy<cv::Mat1b>(out.size(), out.size(), [this, labels](std::size_t i) { return draw_labels(labels[i]); });
    return out;
  }
  BackgroundComparison comparison(const Views& views, const FrameLabels& labels) const {
    return {views, render_static_depth({drive, drive.poses, shared(labels), ground}, views), ground};
  }
  std::vector<Track> find_tracks() const {
    MovingReturns returns(drive, {drive.poses}, *ground);
    return segment_motion(returns, [] {}).tracks;
  }
  cv::Mat1b draw_labels(const std::vector<Label>& labels) const {
    return draw_instances(labels, {scene->camera().width, scene->camera().height});
  }
};

TEST(ImageTracking, ContinuesWhereNoScanShowsTheObject) {
  constexpr std::size_t kBlind = 7;
  const BlindStreet street(14, kBlind);
  const std::vector<Track> tracks = street.find_tracks();
  ASSERT_FALSE(tracks.empty());
  const FrameLabels labels = draw_outlines(tracks, street.drive, street.drive.poses, 0.3);
  Views views = street.views(labels);
  views.masks = mask_possible_positions(views, tracks, street.ground);
  const FrameLabels tracked = track_in_images(labels, tracks, street.comparison(views, labels), street.drive.poses);
  double all = 0, before = 0, after = 0;
  for (std::size_t i = kBlind + 3; i < labels.size(); ++i) {
    const cv::Mat1b truth = street.scene->render(static_cast<int>(i)).dynamic;
    all += cv::countNonZero(truth);
    before += cv::countNonZero(truth & grown(street.draw_labels(labels[i]), 3));
    after += cv::countNonZero(truth & grown(street.draw_labels(tracked[i]), 3));
    EXPECT_LT(cv::countNonZero(street.draw_labels(tracked[i])), 3 * cv::countNonZero(truth)) << "frame " << i;
  }
  RecordProperty("recall", std::to_string(after / all));
  EXPECT_LT(before / all, 0.3);
  EXPECT_GT(after / all, 0.5);  // shadows are part of the truth, not of the outlines
}

}  // namespace
}  // namespace dvi::objects
