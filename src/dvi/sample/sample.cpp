#include "dvi/sample/sample.h"

#include <algorithm>
#include <cstdlib>
#include <memory>

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

bool near_mask(const cv::Mat1b& mask, cv::Point2f at, int margin) {
  const int x = cvRound(at.x), y = cvRound(at.y);
  const cv::Rect window = cv::Rect(x - margin, y - margin, 2 * margin + 1, 2 * margin + 1) & cv::Rect({}, mask.size());
  for (int row = window.y; row < window.br().y; ++row)
    if (std::any_of(mask[row] + window.x, mask[row] + window.br().x, [](uchar m) { return m != 0; })) return true;
  return false;
}

// The source's depth round the position, the farthest of the four: at a depth edge a pixel counts for either side.
float farthest(const DepthMap& depth, cv::Point2f at) {
  const int x = static_cast<int>(at.x), x1 = std::min(x + 1, depth.z.cols - 1);
  const int y = static_cast<int>(at.y), y1 = std::min(y + 1, depth.z.rows - 1);
  return std::max({depth.z(y, x), depth.z(y, x1), depth.z(y1, x), depth.z(y1, x1)});
}

}  // namespace

std::vector<std::size_t> search_order(const Views& views, std::size_t target) {
  std::vector<std::size_t> order;
  const auto [first, last] = views.of_drive(views[target].drive);
  for (std::size_t i = target + 1; i < last; ++i) order.push_back(i);
  for (std::size_t i = target; i-- > first;) order.push_back(i);
  // Of further drives the nearest places first: time says nothing across drives.
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < views.size(); ++i)
    if (views[i].drive != views[target].drive) others.push_back(i);
  const auto distance = [&](std::size_t i) {
    return (views[i].camera_from_world.inverse().t - views[target].camera_from_world.inverse().t).norm();
  };
  std::stable_sort(others.begin(), others.end(), [&](std::size_t a, std::size_t b) {
    return views[a].drive != views[b].drive ? views[a].drive < views[b].drive : distance(a) < distance(b);
  });
  order.insert(order.end(), others.begin(), others.end());
  return order;
}

Candidates sample(const Views& views, std::size_t target, const Lazy<DepthMap>& depths, const SampleOptions& options) {
  Candidates out{Region(*views.masks[target]), {}};
  out.of.resize(out.hole.size());
  std::vector<Seeker> open = seekers(out.hole, views[target], *depths[target]);
  for (const std::size_t source : search_order(views, target)) {
    if (open.empty()) break;
    const View& view = views[source];
    std::shared_ptr<const cv::Mat1b> mask;
    std::shared_ptr<const DepthMap> depth;
    std::erase_if(open, [&](const Seeker& seeker) {
      const Eigen::Vector3d p = view.camera_from_world * seeker.world;
      if (!view.camera.in_front(p)) return false;
      const Eigen::Vector2d pixel = view.camera.project(p);
      const cv::Point2f at = quantised(pixel.x(), pixel.y());
      if (!view.camera.contains({at.x, at.y})) return false;
      if (!mask) mask = views.masks[source];
      if (near_mask(*mask, at, options.mask_margin_px)) return false;
      if (options.occlusion_test) {
        if (!depth) depth = depths[source];
        const float seen = farthest(*depth, at);
        if (DepthMap::is_surface(seen) && p.z() > seen * (1 + options.occlusion_tolerance)) return false;
      }
      out.of[seeker.pixel] = {static_cast<int>(source), at};
      return true;
    });
  }
  return out;
}

}  // namespace dvi
