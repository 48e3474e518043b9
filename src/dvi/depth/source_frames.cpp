#include "dvi/depth/source_frames.h"

#include <algorithm>

#include "dvi/drive/near_views.h"

namespace dvi::depth {
namespace {

constexpr std::size_t kOfOtherCameras = 1;  // steps each way: the parallax is between the cameras
constexpr std::size_t kOfOtherDrives = 4;

// Steps in time grow: near frames are alike, far ones bring parallax.
std::vector<std::size_t> pool(const Views& views, std::size_t target, int max_frame_gap) {
  const auto [first, last] = views.of_sequence(views[target].sequence);
  std::vector<std::size_t> out;
  for (std::size_t d = 1; d <= static_cast<std::size_t>(max_frame_gap); d += std::max<std::size_t>(1, d / 3)) {
    if (target + d < last) out.push_back(target + d);
    if (target >= first + d) out.push_back(target - d);
  }
  for (const std::size_t view : list_views_of_other_cameras(views, target, kOfOtherCameras)) out.push_back(view);
  for (const std::size_t view : find_nearest_views_of_other_drives(views, target, kOfOtherDrives)) out.push_back(view);
  return out;
}

/// Numbers of the sights, ray by ray and depth by depth, that a view offers.
std::vector<std::size_t> shown(const View& view, const SE3& world_from_target, const SearchRays& search,
                               const VisibilityMap& visibility) {
  const SE3 view_from_target = view.camera_from_world * world_from_target;
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < 2 * search.rays.size(); ++i) {
    const double w = i % 2 == 0 ? 0 : search.nearest;
    const Eigen::Vector3d x = view_from_target.R * search.rays[i / 2] + w * view_from_target.t;
    if (!view.camera.in_front(x)) continue;
    const Eigen::Vector2d at = view.camera.project(x);
    if (view.camera.contains(at) && !visibility.masked({static_cast<float>(at.x()), static_cast<float>(at.y())}))
      out.push_back(i);
  }
  return out;
}

}  // namespace

std::vector<std::size_t> choose_source_frames(const Target& target, const SearchRays& search, int count, int max_frame_gap) {
  const SE3 world_from_target = target.view().camera_from_world.inverse();
  const std::vector<std::size_t> candidates = pool(target.views, target.index, max_frame_gap);
  std::vector<std::vector<std::size_t>> sights;
  for (const std::size_t view : candidates)
    sights.push_back(shown(target.views[view], world_from_target, search, *target.visibility[view]));
  // Greedily the view that adds most, where each further sight of the same counts half of the one before.
  std::vector<double> worth(2 * search.rays.size(), 1);
  std::vector<std::size_t> out;
  while (out.size() < static_cast<std::size_t>(count)) {
    std::size_t best = 0;
    double most = 0;
    for (std::size_t i = 0; i < sights.size(); ++i) {
      double gain = 0;
      for (const std::size_t sight : sights[i]) gain += worth[sight];
      if (gain > most) {
        best = i;
        most = gain;
      }
    }
    if (most == 0) break;
    for (const std::size_t sight : sights[best]) worth[sight] /= 2;
    out.push_back(candidates[best]);
    sights[best].clear();
  }
  return out;
}

}  // namespace dvi::depth
