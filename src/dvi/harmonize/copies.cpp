#include "dvi/harmonize/copies.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "dvi/depth/depth_map.h"
#include "dvi/drive/view.h"
#include "dvi/drive/vignetting.h"
#include "dvi/drive/warp.h"
#include "dvi/image/interpolate.h"
#include "dvi/image/region.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {
namespace {

struct Source {
  const View& target;
  const View& view;
  Warp warp;
  std::shared_ptr<const cv::Mat3b> image;
  std::shared_ptr<const cv::Mat1b> mask;

  /// What it shows of a pixel of the target, in its light but for the gain.
  cv::Vec3f shown(cv::Point p, cv::Point2f at, cv::Vec2b footprint) const {
    return apply_vignetting(box_mean(*image, at, footprint), vignetting_to(target, p, view, at));
  }
};

/// What the source that shows p shows of its neighbor q, which was not copied from it, in the light of the target; none where
/// it cannot.
std::optional<cv::Vec3f> neighbor(const Source& source, cv::Point p, const sample::Candidate& shown, const cv::Vec3f& gain,
                                  cv::Point q, const depth::DepthMap& depth) {
  const cv::Point2f by_depth =
      find_neighbor_in_source(p, shown.position, source.warp(p, depth.z(p)), q, source.warp(q, depth.z(q)));
  const cv::Point2f by_image = shown.position + cv::Point2f(q - p);
  for (const cv::Point2f at : {by_depth, by_image})
    if (can_sample(*source.mask, at, shown.footprint)) return source.shown(q, at, shown.footprint).mul(gain);
  return std::nullopt;
}

void add(Seam& seam, const cv::Vec3f& first, const cv::Vec3f& second) {
  const cv::Vec3f step = first - second, middle = 0.5F * (first + second);
  if (seam.shown == 1) seam.doubt = std::hypot(mean_difference(2 * seam.step, step), mean_difference(seam.middle, middle));
  seam.middle = middle;
  seam.step += 0.5F * step;
  ++seam.shown;
}

}  // namespace

float Seam::weight() const {
  const float root = 1 + doubt * doubt / (kDoubtfulSeam * kDoubtfulSeam);
  return 1 / (root * root);
}

Copies copy(const depth::Target& target, const Fused& fused, const DayLight& light) {
  const Views& views = target.views;
  const sample::Candidates& candidates = fused.candidates;
  const Region& hole = candidates.hole;
  const std::vector<cv::Vec3f> zeros(hole.size());
  Copies out{fused.color, zeros, std::vector<std::array<Seam, 2>>(hole.size())};
  std::map<int, std::vector<std::size_t>> of_view;
  for (std::size_t i = 0; i < hole.size(); ++i)
    if (candidates.leading[i].found()) of_view[candidates.leading[i].view].push_back(i);
  const cv::Rect frame({}, hole.index.size());
  const std::shared_ptr<const cv::Mat3b> known = target.image();
  for (const auto& [view, pixels] : of_view) {
    out.of_other_days |= views[view].drive != target.view().drive;
    const Source source{target.view(), views[view], Warp(target.view(), views[view]), views.images[view], views.masks[view]};
    for (const std::size_t i : pixels) {
      const cv::Point p = hole.pixels[i];
      const sample::Candidate& shown = candidates.leading[i];
      const cv::Vec3f gain = light.gain_to(target.view(), views[view], i);
      const auto own = [&] { return source.shown(p, shown.position, shown.footprint).mul(gain); };
      for (const cv::Point q : {p + cv::Point(-1, 0), p + cv::Point(0, -1), p + cv::Point(1, 0), p + cv::Point(0, 1)}) {
        if (!frame.contains(q)) continue;
        const int j = hole.index(q);
        const bool seam = j >= 0 && candidates.leading[j].found() && candidates.leading[j].view != view;
        if (j >= 0 && !seam) continue;
        const std::optional<cv::Vec3f> beside = neighbor(source, p, shown, gain, q, target.depth);
        if (!beside) continue;
        if (seam) {
          const bool first = q.x > p.x || q.y > p.y;
          add((first ? out.seams[i] : out.seams[j])[q.y == p.y ? 0 : 1], first ? own() : *beside, first ? *beside : own());
        } else {
          out.outward[i] += own() - *beside;
          out.rim.push_back({q, view, cv::Vec3f((*known)(q)) - *beside});
        }
      }
    }
  }
  return out;
}

}  // namespace dvi::harmonize
