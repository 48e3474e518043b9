#include "dvi/objects/edges.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/image/region.h"
#include "dvi/objects/background_model.h"
#include "dvi/objects/half_size.h"

namespace dvi::objects {
namespace {

struct EdgeParams {
  double background_quantile = 0.95;    ///< an edge differs by more than this quantile of the differences far from the mask
  std::size_t min_background_px = 100;  ///< pixels of half size far from the mask that the quantile needs
  int view_width_radii = 155;           ///< width of a view in units of the search radius
  /// Smallest number of pixels in the 3 x 3 window of an added pixel. The end of a straight boundary has as many, a line that
  /// leaves the boundary has fewer.
  int min_neighbors = 6;
};
constexpr EdgeParams kEdges{};

// Returns the difference between each pixel and the background. It is the larger one of two: the pixel from the most similar
// background of its neighborhood, and its background from the most similar pixel of its neighborhood. A dark edge resembles
// some of the leaves behind it, but hides the bright ones. Negative where the background is unobserved and in the mask.
cv::Mat1f compute_differences(const BackgroundModel& background, const cv::Mat3b& image, const cv::Mat1b& mask) {
  cv::Mat1f out(image.size(), -1.F);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      if (mask(y, x) != 0 || !background.is_observed({x, y})) continue;
      float shown = background.difference({x, y}, image(y, x)), hidden = shown;
      const cv::Rect neighbors = cv::Rect(x - 1, y - 1, 3, 3) & cv::Rect({}, image.size());
      for (int v = neighbors.y; v < neighbors.br().y; ++v)
        for (int u = neighbors.x; u < neighbors.br().x; ++u) {
          if (background.is_observed({u, v})) shown = std::min(shown, background.difference({u, v}, image(y, x)));
          if (mask(v, u) == 0) hidden = std::min(hidden, background.difference({x, y}, image(v, u)));
        }
      out(y, x) = std::max(shown, hidden);
    }
  return out;
}

// Returns the smallest difference of an edge: larger than those that noise, poses, and exposure cause far from the mask.
std::optional<float> estimate_threshold(const cv::Mat1f& differences, const cv::Mat1b& near) {
  std::vector<float> far;
  for (int y = 0; y < near.rows; ++y)
    for (int x = 0; x < near.cols; ++x)
      if (near(y, x) == 0 && differences(y, x) >= 0) far.push_back(differences(y, x));
  if (far.size() < kEdges.min_background_px) return std::nullopt;
  const auto at = far.begin() + static_cast<std::ptrdiff_t>(kEdges.background_quantile * static_cast<double>(far.size() - 1));
  std::nth_element(far.begin(), at, far.end());
  return std::max(1.F, *at);
}

}  // namespace

int compute_edge_search_radius_px(const cv::Size& half_size) { return std::max(1, half_size.width / kEdges.view_width_radii); }

cv::Mat1b add_missing_edges(const cv::Mat1b& mask, const BackgroundModel& background, const cv::Mat3b& image, int radius_px) {
  const cv::Mat1f differences = compute_differences(background, image, mask);
  const auto threshold = estimate_threshold(differences, grown(mask, radius_px));
  if (!threshold) return mask.clone();
  const cv::Mat1b differs(differences > *threshold);
  cv::Mat1b out = mask.clone();
  for (int step = 0; step < radius_px; ++step) {
    const cv::Mat1b next(out | (grown(out, 1) & differs));
    cv::Mat1b neighbors;
    cv::boxFilter(cv::Mat1b(next / 255), neighbors, -1, {3, 3}, {-1, -1}, false, cv::BORDER_REPLICATE);
    out |= next & cv::Mat1b(neighbors >= kEdges.min_neighbors);
  }
  // The strip is as thin as a line at its ends, and the lens and motion blur smear it.
  return cv::Mat1b(mask | (grown(cv::Mat1b(out & ~mask), 1)));
}

}  // namespace dvi::objects
