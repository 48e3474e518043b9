#include "dvi/objects/edges.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/image/region.h"
#include "dvi/objects/half_size.h"
#include "dvi/objects/other_times.h"

namespace dvi::objects {
namespace {

constexpr double kUsualShare = 0.95;     // of what lies farther from the mask differs by less than an edge must
constexpr std::size_t kFewestFar = 100;  // half pixels that tell how much that is
constexpr int kReaches = 155;            // in the width of a view
// Of a pixel and the eight round it: what continues a straight border; a line that leaves it has fewer.
constexpr int kFlat = 6;

// By how much each pixel and what other times show there differ: the pixel from all that is shown around, or what is shown from
// all pixels around, for a dark edge has something alike among leaves, but hides the bright ones. Negative where no source
// observed it.
cv::Mat1f differences(const Usual& usual, const Patch& image, const cv::Mat1b& mask) {
  cv::Mat1f out(image.size(), -1.F);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      if (mask(y, x) != 0 || !usual.seen({x, y})) continue;
      float shown = usual.difference({x, y}, image(y, x)), hidden = shown;
      const cv::Rect beside = cv::Rect(x - 1, y - 1, 3, 3) & cv::Rect({}, image.size());
      for (int v = beside.y; v < beside.br().y; ++v)
        for (int u = beside.x; u < beside.br().x; ++u) {
          if (usual.seen({u, v})) shown = std::min(shown, usual.difference({u, v}, image(y, x)));
          if (mask(v, u) == 0) hidden = std::min(hidden, usual.difference({x, y}, image(v, u)));
        }
      out(y, x) = std::max(shown, hidden);
    }
  return out;
}

// By how much an edge differs at least: noise, poses and light of a view say how much its background does.
std::optional<float> least_of_edges(const cv::Mat1f& differences, const cv::Mat1b& near) {
  std::vector<float> far;
  for (int y = 0; y < near.rows; ++y)
    for (int x = 0; x < near.cols; ++x)
      if (near(y, x) == 0 && differences(y, x) >= 0) far.push_back(differences(y, x));
  if (far.size() < kFewestFar) return std::nullopt;
  const auto at = far.begin() + static_cast<std::ptrdiff_t>(kUsualShare * static_cast<double>(far.size() - 1));
  std::nth_element(far.begin(), at, far.end());
  return std::max(1.F, *at);
}

}  // namespace

int edge_reach(const cv::Size& half_size) { return std::max(1, half_size.width / kReaches); }

cv::Mat1b with_edges(const cv::Mat1b& mask, const Usual& usual, const Patch& image, int reach) {
  const cv::Mat1f off = differences(usual, image, mask);
  const auto least = least_of_edges(off, grown(mask, reach));
  if (!least) return mask.clone();
  const cv::Mat1b differs(off > *least);
  cv::Mat1b out = mask.clone();
  for (int step = 0; step < reach; ++step) {
    const cv::Mat1b next(out | (grown(out, 1) & differs));
    cv::Mat1b around;  // how many of the nine
    cv::boxFilter(cv::Mat1b(next / 255), around, -1, {3, 3}, {-1, -1}, false, cv::BORDER_REPLICATE);
    out |= next & cv::Mat1b(around >= kFlat);
  }
  // Where the strip ends it is as thin as a line; and lens and motion smear it.
  return cv::Mat1b(mask | (grown(cv::Mat1b(out & ~mask), 1)));
}

}  // namespace dvi::objects
