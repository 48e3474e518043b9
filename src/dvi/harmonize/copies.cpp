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
#include "dvi/image/neighbors.h"
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

  /// Reads the color of a pixel of the target, corrected for vignetting but not for the gain.
  cv::Vec3f read_color(cv::Point p, cv::Point2f at, cv::Vec2b footprint) const {
    return apply_vignetting(box_mean(*image, at, footprint), vignetting_to(target, p, view, at));
  }
};

/// A copied pixel of the target and its candidate in a source.
struct CopiedPixel {
  cv::Point at;
  const sample::Candidate& candidate;
};

/// Reads the color of q, a neighbor of a pixel that was copied from the source. Returns nothing if the source does not show it.
std::optional<cv::Vec3f> read_neighbor(const Source& source, const CopiedPixel& p, cv::Point q, const depth::DepthMap& depth) {
  const auto& [at, candidate] = p;
  const cv::Point2f by_depth =
      find_neighbor_in_source({at, source.warp(at, depth.z(at))}, candidate.position, {q, source.warp(q, depth.z(q))});
  const cv::Point2f by_image = candidate.position + cv::Point2f(q - at);
  for (const cv::Point2f position : {by_depth, by_image})
    if (can_sample(*source.mask, position, candidate.footprint)) return source.read_color(q, position, candidate.footprint);
  return std::nullopt;
}

/// Adds the colors of both pixels of a seam in one source.
void add_source(Seam& seam, const cv::Vec3f& first, const cv::Vec3f& second) {
  const cv::Vec3f step = first - second, middle = 0.5F * (first + second);
  if (seam.sources == 1) seam.spread = std::hypot(mean_difference(2 * seam.step, step), mean_difference(seam.middle, middle));
  seam.middle = middle;
  seam.step += 0.5F * step;
  ++seam.sources;
}

}  // namespace

float Seam::weight() const {
  const float root = 1 + spread * spread / (kSeam.inconsistent_seam_levels * kSeam.inconsistent_seam_levels);
  return 1 / (root * root);
}

Copies read_copies(const depth::Target& target, const Fused& fused, const IlluminationChange& illumination) {
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
    out.from_other_drives |= views[view].drive != target.view().drive;
    const Source source{target.view(), views[view], Warp(target.view(), views[view]), views.images[view], views.masks[view]};
    for (const std::size_t i : pixels) {
      const cv::Point p = hole.pixels[i];
      const sample::Candidate& candidate = candidates.leading[i];
      const cv::Vec3f gain = illumination.gain_to(target.view(), views[view], i);
      const auto own = [&] { return source.read_color(p, candidate.position, candidate.footprint).mul(gain); };
      for (const cv::Point q : four_neighbors(p)) {
        if (!frame.contains(q)) continue;
        const int j = hole.index(q);
        const bool seam = j >= 0 && candidates.leading[j].found() && candidates.leading[j].view != view;
        if (j >= 0 && !seam) continue;
        const std::optional<cv::Vec3f> shown = read_neighbor(source, {p, candidate}, q, target.depth);
        if (!shown) continue;
        const cv::Vec3f neighbor = shown->mul(gain);
        if (seam) {
          const bool first = q.x > p.x || q.y > p.y;
          add_source((first ? out.seams[i] : out.seams[j])[q.y == p.y ? 0 : 1], first ? own() : neighbor,
                     first ? neighbor : own());
        } else {
          out.outward[i] += own() - neighbor;
          out.boundary.push_back({q, view, cv::Vec3f((*known)(q)) - neighbor});
        }
      }
    }
  }
  return out;
}

}  // namespace dvi::harmonize
