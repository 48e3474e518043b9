#include "dvi/inputs/compared_masks.h"

#include <optional>
#include <utility>
#include <vector>

#include "dvi/inputs/make_views.h"
#include "dvi/objects/image_following.h"
#include "dvi/objects/shadows.h"
#include "dvi/objects/silhouettes.h"
#include "dvi/objects/standing.h"

namespace dvi::inputs {
namespace {

// The views of the frames that have a pose, masked as given; and of each frame the number of its view, or -1.
struct PosedFrames {
  Views views;
  std::vector<int> view_of;

  PosedFrames(const Drive& drive, const Trajectory& world_from_lidar, const Lazy<cv::Mat1b>& masks) {
    for (std::size_t i = 0; i < drive.frames.size(); ++i) {
      const std::optional<View> view = posed_view(drive, i, world_from_lidar);
      view_of.push_back(view ? static_cast<int>(views.size()) : -1);
      if (view) views.views.push_back(*view);
    }
    const auto frame = [list = views.views](std::size_t i) { return list[i].frame; };
    views.images = Lazy<cv::Mat3b>::through(views.size(), [=, of = drive.images](std::size_t i) { return of[frame(i)]; });
    views.masks = Lazy<cv::Mat1b>::through(views.size(), [=](std::size_t i) { return masks[frame(i)]; });
  }

  // Masks of the views, as the drive's frames again.
  Lazy<cv::Mat1b> of_frames(const Lazy<cv::Mat1b>& found, const Lazy<cv::Mat1b>& masks) const {
    return Lazy<cv::Mat1b>::through(view_of.size(), [=, of = view_of](std::size_t i) {
      return of[i] < 0 ? masks[i] : found[static_cast<std::size_t>(of[i])];
    });
  }
};

}  // namespace

std::shared_ptr<const ground::ScanGround> Grounds::of(std::size_t recording) const {
  const std::size_t owner = drives_[recording].rig_of.value_or(recording);
  const Drive& drive = drives_[owner].drive;
  const Trajectory& world_from_lidar = poses_[owner].world_from_lidar;
  if (world_from_lidar.empty() || drive.scan_headers.empty()) return nullptr;
  auto& ground = made_[owner];
  if (!ground) ground = std::make_shared<const ground::ScanGround>(drive, world_from_lidar);
  return ground;
}

FrameLabels seen_in_images(const Drive& drive, const Trajectory& world_from_lidar, const SharedLabels& labels,
                           const std::vector<objects::Track>& tracks, const Lazy<cv::Mat1b>& masks,
                           const std::shared_ptr<const ground::ScanGround>& ground) {
  PosedFrames posed(drive, world_from_lidar, masks);
  posed.views.masks = objects::whereabouts(posed.views, tracks, ground);
  const Lazy<cv::Mat1f> standing = objects::standing_depth(drive, world_from_lidar, labels, posed.views, ground);
  const objects::Comparison comparison(posed.views, standing, ground);
  return objects::followed_in_images(*labels, tracks, comparison, world_from_lidar);
}

Lazy<cv::Mat1b> compared(const Drive& drive, const Trajectory& world_from_lidar, const Lazy<cv::Mat1b>& masks,
                         const Compared& what, const std::shared_ptr<const ground::ScanGround>& ground, Progress& progress) {
  if (!ground) {
    progress.note(drive.path.filename().string() + ": without poses and scans, shadows beside the masks are not looked for");
    return masks;
  }
  Lazy<cv::Mat1b> out = masks;
  if (what.found) {
    const PosedFrames posed(drive, world_from_lidar, out);
    const Lazy<cv::Mat1f> standing = objects::standing_depth(drive, world_from_lidar, what.found, posed.views, ground);
    out = posed.of_frames(objects::silhouettes(posed.views, standing, ground), out);
  }
  if (what.shadows) {
    const PosedFrames posed(drive, world_from_lidar, out);
    out = posed.of_frames(objects::with_shadows(posed.views, ground), out);
  }
  return out;
}

}  // namespace dvi::inputs
