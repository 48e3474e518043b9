#include "dvi/objects/image_masks.h"

#include <optional>
#include <utility>
#include <vector>

#include "dvi/drive/image_returns.h"
#include "dvi/drive/posed_view.h"
#include "dvi/objects/image_tracking.h"
#include "dvi/objects/shadows.h"
#include "dvi/objects/silhouettes.h"
#include "dvi/objects/static_depth.h"

namespace dvi::objects {
namespace {

// The views of the frames that have a pose, with their masks, and the index of the view of each frame, -1 without a pose.
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

  // Both must outlive the views.
  void add_returns(const Drive& drive, const Trajectory& world_from_lidar) {
    views.returns = Lazy<std::vector<ImageReturn>>(views.size(), [&, list = views.views](std::size_t i) {
      return project_returns(drive, list[i].frame, world_from_lidar);
    });
  }

  // Converts masks per view to masks per frame. Frames without a pose get their mask from `unposed`.
  Lazy<cv::Mat1b> to_frames(const Lazy<cv::Mat1b>& masks, const Lazy<cv::Mat1b>& unposed) const {
    return Lazy<cv::Mat1b>::through(view_of.size(), [=, of = view_of](std::size_t i) {
      return of[i] < 0 ? unposed[i] : masks[static_cast<std::size_t>(of[i])];
    });
  }
};

}  // namespace

FrameLabels extend_in_images(const CameraRef& ref, const Lazy<cv::Mat1b>& masks, const SharedLabels& labels,
                             std::span<const Track> tracks) {
  const Drive& drive = ref.camera().drive;
  const Trajectory& world_from_lidar = ref.camera().world_from_lidar;
  const auto ground = ref.ground();
  PosedFrames posed(drive, world_from_lidar, masks);
  posed.views.masks = mask_possible_positions(posed.views, tracks, ground);
  const Lazy<cv::Mat1f> depth = render_static_depth({drive, world_from_lidar, labels, ground}, posed.views);
  return track_in_images(*labels, tracks, BackgroundComparison(posed.views, depth, ground), world_from_lidar);
}

Lazy<cv::Mat1b> refine_masks(const CameraRef& ref, const Lazy<cv::Mat1b>& masks, const MaskRefinement& refinement,
                             Progress& progress) {
  const Drive& drive = ref.camera().drive;
  const Trajectory& world_from_lidar = ref.camera().world_from_lidar;
  const auto ground = ref.ground();
  if (!ground) {
    progress.note(drive.path.filename().string() + ": shadows beside the masks are not removed, which needs poses and scans");
    return masks;
  }
  Lazy<cv::Mat1b> out = masks;
  if (refinement.outlined) {
    const PosedFrames posed(drive, world_from_lidar, out);
    const Lazy<cv::Mat1f> depth = render_static_depth({drive, world_from_lidar, refinement.outlined, ground}, posed.views);
    out = posed.to_frames(refine_silhouettes(posed.views, depth, ground), out);
  }
  if (refinement.shadows) {
    PosedFrames posed(drive, world_from_lidar, out);
    posed.add_returns(drive, world_from_lidar);
    out = posed.to_frames(add_shadows(posed.views, ground), out);
  }
  return out;
}

}  // namespace dvi::objects
