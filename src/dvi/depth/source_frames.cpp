#include "dvi/depth/source_frames.h"

#include <algorithm>
#include <memory>

#include "dvi/core/lazy.h"
#include "dvi/drive/near_views.h"

namespace dvi::depth {
namespace {

/// Parameters of the list of candidates.
struct CandidateFrameParams {
  std::size_t other_camera_gap = 1;    ///< Frames before and after, of each other camera: its parallax is that of the mounting.
  std::size_t other_drive_frames = 4;  ///< Nearest frames of other drives.
};
constexpr CandidateFrameParams kCandidateFrames;

/// Lists candidates for source frames. Gaps in time grow, because near frames are similar and distant ones have parallax.
std::vector<std::size_t> list_candidates(const Views& views, std::size_t target, int max_frame_gap) {
  const auto [first, last] = views.of_sequence(views[target].sequence);
  std::vector<std::size_t> out;
  for (std::size_t d = 1; d <= static_cast<std::size_t>(max_frame_gap); d += std::max<std::size_t>(1, d / 3)) {
    if (target + d < last) out.push_back(target + d);
    if (target >= first + d) out.push_back(target - d);
  }
  for (const std::size_t view : list_views_of_other_cameras(views, target, kCandidateFrames.other_camera_gap))
    out.push_back(view);
  for (const std::size_t view : find_nearest_views_of_other_drives(views, target, kCandidateFrames.other_drive_frames))
    out.push_back(view);
  return out;
}

/// Lists the points that a view observes: point 2i is at infinity on ray i, point 2i + 1 at the largest inverse depth.
std::vector<std::size_t> find_observed_points(const View& view, const SE3& world_from_target, const SearchRays& search,
                                              const VisibilityMap& visibility) {
  const SE3 view_from_target = view.camera_from_world * world_from_target;
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < 2 * search.rays.size(); ++i) {
    const double w = i % 2 == 0 ? 0 : search.max_inverse_depth;
    const Eigen::Vector3d x = view_from_target.R * search.rays[i / 2] + w * view_from_target.t;
    if (!view.camera.in_front(x)) continue;
    const Eigen::Vector2d at = view.camera.project(x);
    if (view.camera.contains(at) && !visibility.is_masked({static_cast<float>(at.x()), static_cast<float>(at.y())}))
      out.push_back(i);
  }
  return out;
}

}  // namespace

std::vector<std::size_t> choose_source_frames(const Target& target, const SearchRays& search, int count, int max_frame_gap) {
  const SE3 world_from_target = target.view().camera_from_world.inverse();
  const std::vector<std::size_t> candidates = list_candidates(target.views, target.index, max_frame_gap);
  std::vector<std::vector<std::size_t>> observed(candidates.size());
  for_each_item(target.visibility, candidates, [&](std::size_t i, const std::shared_ptr<const VisibilityMap>& visible) {
    observed[i] = find_observed_points(target.views[candidates[i]], world_from_target, search, *visible);
  });
  // Greedy: each further observation of a point counts half as much as the one before.
  std::vector<double> weight(2 * search.rays.size(), 1);
  std::vector<std::size_t> out;
  while (out.size() < static_cast<std::size_t>(count)) {
    std::size_t best = 0;
    double max_gain = 0;
    for (std::size_t i = 0; i < observed.size(); ++i) {
      double gain = 0;
      for (const std::size_t point : observed[i]) gain += weight[point];
      if (gain > max_gain) {
        best = i;
        max_gain = gain;
      }
    }
    if (max_gain == 0) break;
    for (const std::size_t point : observed[best]) weight[point] /= 2;
    out.push_back(candidates[best]);
    observed[best].clear();
  }
  return out;
}

}  // namespace dvi::depth
