#include "dvi/pipeline/shadowed_masks.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "dvi/pipeline/make_views.h"
#include "dvi/traffic/shadows.h"

namespace dvi::pipeline {
namespace {

// The views of the frames that have a pose, masked as given; and of each frame the number of its view, or -1.
std::pair<Views, std::vector<int>> posed_views(const Drive& drive, const Trajectory& world_from_lidar,
                                               const Lazy<cv::Mat1b>& masks) {
  Views views;
  std::vector<int> view_of;
  for (std::size_t i = 0; i < drive.frames.size(); ++i) {
    const std::optional<View> view = posed_view(drive, 0, i, world_from_lidar);
    view_of.push_back(view ? static_cast<int>(views.size()) : -1);
    if (view) views.views.push_back(*view);
  }
  const auto frame = [list = views.views](std::size_t i) { return list[i].frame; };
  views.images = Lazy<cv::Mat3b>::through(views.size(), [=, of = drive.images](std::size_t i) { return of[frame(i)]; });
  views.masks = Lazy<cv::Mat1b>::through(views.size(), [=](std::size_t i) { return masks[frame(i)]; });
  return {views, view_of};
}

}  // namespace

Lazy<cv::Mat1b> with_shadows(const Drive& drive, const Trajectory& world_from_lidar, const Lazy<cv::Mat1b>& masks,
                             Progress& progress) {
  if (world_from_lidar.empty() || drive.scan_headers.empty()) {
    progress.note(drive.path.filename().string() + ": without poses and scans, shadows beside the masks are not looked for");
    return masks;
  }
  const auto ground = std::make_shared<const traffic::Ground>(drive, world_from_lidar);
  const auto [views, view_of] = posed_views(drive, world_from_lidar, masks);
  const Lazy<cv::Mat1b> shadowed = traffic::with_shadows(views, ground);
  return Lazy<cv::Mat1b>::through(drive.frames.size(), [=, view_of = view_of](std::size_t i) {
    return view_of[i] < 0 ? masks[i] : shadowed[static_cast<std::size_t>(view_of[i])];
  });
}

}  // namespace dvi::pipeline
