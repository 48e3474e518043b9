#include "dvi/sample/sample.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "dvi/image/interpolate.h"

namespace dvi {
namespace {

/// A hole pixel that still looks for its source.
struct Seeker {
  std::size_t pixel;
  Eigen::Vector3d world;
};

std::vector<Seeker> seekers(const Region& hole, const View& view, const DepthMap& depth) {
  const SE3 world_from_camera = view.camera_from_world.inverse();
  std::vector<Seeker> out;
  for (std::size_t i = 0; i < hole.size(); ++i) {
    const cv::Point p = hole.pixels[i];
    const float z = depth.z(p);
    if (DepthMap::is_surface(z)) out.push_back({i, world_from_camera * (z * view.camera.ray({p.x, p.y}))});
  }
  return out;
}

}  // namespace

std::vector<std::size_t> search_order(const Views& views, std::size_t target, int reach_frames) {
  const std::size_t reach = reach_frames > 0 ? static_cast<std::size_t>(reach_frames) : views.size();
  const auto [first, last] = views.of_drive(views[target].drive);
  std::vector<std::size_t> order;
  for (std::size_t i = target + 1; i < std::min(last, target + 1 + reach); ++i) order.push_back(i);
  for (std::size_t i = target; i-- > std::max(first, target - std::min(target, reach));) order.push_back(i);
  // Of further drives the nearest places first: time says nothing across drives.
  const auto place = [&](std::size_t i) { return views[i].camera_from_world.inverse().t; };
  for (int drive = 0; views.of_drive(drive).first < views.size(); ++drive) {
    if (drive == views[target].drive) continue;
    std::vector<std::pair<double, std::size_t>> near;
    const auto [begin, end] = views.of_drive(drive);
    for (std::size_t i = begin; i < end; ++i) near.emplace_back((place(i) - place(target)).norm(), i);
    std::sort(near.begin(), near.end());
    near.resize(std::min(near.size(), 2 * reach));
    for (const auto& [distance, view] : near) order.push_back(view);
  }
  return order;
}

Candidates sample(const Views& views, std::size_t target, const DepthMap& depth, const Lazy<VisibilityMap>& visibility,
                  const SampleOptions& options) {
  Candidates out{Region(*views.masks[target]), {}};
  out.of.resize(out.hole.size());
  std::vector<Seeker> open = seekers(out.hole, views[target], depth);
  for (const std::size_t source : search_order(views, target, options.reach_frames)) {
    if (open.empty()) break;
    const View& view = views[source];
    std::shared_ptr<const VisibilityMap> lent;
    std::erase_if(open, [&](const Seeker& seeker) {
      const Eigen::Vector3d p = view.camera_from_world * seeker.world;
      if (!view.camera.in_front(p)) return false;
      const Eigen::Vector2d pixel = view.camera.project(p);
      const cv::Point2f at = quantised(pixel.x(), pixel.y());
      if (!view.camera.contains({at.x, at.y})) return false;
      if (!lent) lent = visibility[source];
      if (lent->masked(at)) return false;
      if (options.occlusion_test && lent->hides(at, p.z(), options.occlusion_tolerance)) return false;
      out.of[seeker.pixel] = {static_cast<int>(source), at};
      return true;
    });
  }
  return out;
}

}  // namespace dvi
