#include "dvi/objects/image_masks.h"

#include <optional>
#include <utility>
#include <vector>

#include "dvi/drive/posed_view.h"
#include "dvi/objects/image_following.h"
#include "dvi/objects/shadows.h"
#include "dvi/objects/silhouettes.h"
#include "dvi/objects/static_depth.h"

namespace dvi::objects {
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

FrameLabels continue_in_images(const EvidenceOf& of, const Lazy<cv::Mat1b>& masks, const SharedLabels& labels,
                               const std::vector<Track>& tracks) {
  const Drive& drive = of.camera().drive;
  const Trajectory& world_from_lidar = of.camera().world_from_lidar;
  const auto ground = of.ground();
  PosedFrames posed(drive, world_from_lidar, masks);
  posed.views.masks = whereabouts(posed.views, tracks, ground);
  const Lazy<cv::Mat1f> depth = static_depth(drive, world_from_lidar, labels, posed.views, ground);
  return followed_in_images(*labels, tracks, Comparison(posed.views, depth, ground), world_from_lidar);
}

Lazy<cv::Mat1b> compare_images(const EvidenceOf& of, const Lazy<cv::Mat1b>& masks, const ImageSearch& search,
                               Progress& progress) {
  const Drive& drive = of.camera().drive;
  const Trajectory& world_from_lidar = of.camera().world_from_lidar;
  const auto ground = of.ground();
  if (!ground) {
    progress.note(drive.path.filename().string() + ": without poses and scans, shadows beside the masks are not looked for");
    return masks;
  }
  Lazy<cv::Mat1b> out = masks;
  if (search.found) {
    const PosedFrames posed(drive, world_from_lidar, out);
    const Lazy<cv::Mat1f> depth = static_depth(drive, world_from_lidar, search.found, posed.views, ground);
    out = posed.of_frames(silhouettes(posed.views, depth, ground), out);
  }
  if (search.shadows) {
    const PosedFrames posed(drive, world_from_lidar, out);
    out = posed.of_frames(with_shadows(posed.views, ground), out);
  }
  return out;
}

}  // namespace dvi::objects
