#include "dvi/harmonize/copies.h"

#include <cstddef>
#include <map>
#include <memory>
#include <vector>

#include "dvi/depth/depth_map.h"
#include "dvi/drive/view.h"
#include "dvi/drive/warp.h"
#include "dvi/image/interpolate.h"
#include "dvi/image/region.h"
#include "dvi/sample/candidates.h"

namespace dvi {
namespace {

struct Source {
  Warp warp;
  std::shared_ptr<const cv::Mat3b> image;
  std::shared_ptr<const cv::Mat1b> mask;
};

/// The source's own gradient from a neighbour it was not copied for to p; zero where the source cannot show the neighbour.
cv::Vec3f gradient(const Source& source, cv::Point p, cv::Point2f shown, const cv::Vec3f& colour, cv::Point q,
                   const DepthMap& depth) {
  const cv::Point2f by_depth = beside(p, shown, source.warp(p, depth.z(p)), q, source.warp(q, depth.z(q)));
  const cv::Point2f by_image = shown + cv::Point2f(q - p);
  for (const cv::Point2f at : {by_depth, by_image})
    if (can_sample(*source.mask, at)) return colour - bilinear(*source.image, at);
  return {};
}

}  // namespace

Copies copy(const Candidates& candidates, const Views& views, std::size_t target, const DepthMap& depth) {
  const Region& hole = candidates.hole;
  const std::vector<cv::Vec3f> zeros(hole.size());
  Copies out{zeros, zeros, zeros};
  std::map<int, std::vector<std::size_t>> of_view;
  for (std::size_t i = 0; i < hole.size(); ++i)
    if (candidates.of[i].found()) of_view[candidates.of[i].view].push_back(i);
  const cv::Rect frame({}, hole.index.size());
  for (const auto& [view, pixels] : of_view) {
    const Source source{Warp(views[target], views[view]), views.images[view], views.masks[view]};
    for (const std::size_t i : pixels) {
      const cv::Point p = hole.pixels[i];
      const cv::Point2f shown = candidates.of[i].position;
      out.colour[i] = bilinear(*source.image, shown);
      for (const cv::Point q : {p + cv::Point(-1, 0), p + cv::Point(0, -1), p + cv::Point(1, 0), p + cv::Point(0, 1)}) {
        if (!frame.contains(q)) continue;
        const int j = hole.index(q);
        if (j < 0) {
          out.outward[i] += gradient(source, p, shown, out.colour[i], q, depth);
        } else if (candidates.of[j].found() && candidates.of[j].view != view) {
          const cv::Vec3f half = 0.5F * gradient(source, p, shown, out.colour[i], q, depth);
          out.seam[i] += half;
          out.seam[j] -= half;
        }
      }
    }
  }
  return out;
}

}  // namespace dvi
