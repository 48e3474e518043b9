#include "dvi/harmonize/adapt_fill.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <vector>

#include "dvi/core/median.h"
#include "dvi/image/neighbors.h"
#include "dvi/image/poisson.h"
#include "dvi/image/region.h"

namespace dvi::harmonize {
namespace {

/// Parameters of the boundary of an imported fill. Where frame and fill show different objects, their difference must not
/// change the colors inside.
struct FillBoundaryParams {
  float outlier_levels = 30;  ///< The difference from the median at which a boundary pixel has a quarter of its weight.
};
constexpr FillBoundaryParams kFillBoundary;

/// A pair of a hole pixel and a known neighbor.
struct BoundaryPair {
  std::size_t pixel = 0;  ///< Index of the hole pixel in the region.
  int part = 0;           ///< Label of its connected part.
  cv::Vec3f difference;   ///< Color of the known neighbor in the frame minus its color in the fill.
};

std::vector<BoundaryPair> find_boundary(const cv::Mat3b& frame, const cv::Mat3b& fill, const Region& hole,
                                        const cv::Mat1i& parts) {
  std::vector<BoundaryPair> boundary;
  const cv::Rect image({}, frame.size());
  for (std::size_t i = 0; i < hole.size(); ++i)
    for (const cv::Point q : four_neighbors(hole.pixels[i]))
      if (image.contains(q) && hole.index(q) < 0)
        boundary.push_back({i, parts(hole.pixels[i]), cv::Vec3f(frame(q)) - cv::Vec3f(fill(q))});
  return boundary;
}

/// Returns the median difference per channel of each part, by its label; none for parts without known neighbors.
std::map<int, cv::Vec3f> compute_medians(const std::vector<BoundaryPair>& boundary) {
  std::map<int, std::array<std::vector<float>, 3>> differences;
  for (const BoundaryPair& pair : boundary)
    for (int c = 0; c < 3; ++c) differences[pair.part][static_cast<std::size_t>(c)].push_back(pair.difference[c]);
  std::map<int, cv::Vec3f> medians;
  for (const auto& [part, channels] : differences)
    medians[part] = {median(channels[0]), median(channels[1]), median(channels[2])};
  return medians;
}

/// Returns the weight of a pair by the robust function of Geman and McClure.
float compute_weight(const cv::Vec3f& difference, const cv::Vec3f& usual) {
  float largest = 0;
  for (int c = 0; c < 3; ++c) largest = std::max(largest, std::abs(difference[c] - usual[c]));
  const float ratio = largest / kFillBoundary.outlier_levels, denominator = 1 + ratio * ratio;
  return 1 / (denominator * denominator);
}

/// Makes the Laplace equation of the correction.
PoissonSystem make_system(const cv::Mat3b& frame, const cv::Mat3b& fill, const cv::Mat1b& hole) {
  PoissonSystem system;
  system.region = Region(hole);
  cv::Mat1i parts;
  label_connected_parts(hole, parts);
  const std::vector<BoundaryPair> boundary = find_boundary(frame, fill, system.region, parts);
  const std::map<int, cv::Vec3f> medians = compute_medians(boundary);
  const cv::Rect image({}, frame.size());
  for (const cv::Point p : system.region.pixels) {
    float diagonal = medians.contains(parts(p)) ? 0 : 1;  // 1: the solution of a part without known neighbors is 0
    for (const cv::Point q : four_neighbors(p))
      if (image.contains(q) && system.region.index(q) >= 0) ++diagonal;
    system.diagonal.push_back(diagonal);
    system.right.emplace_back();
  }
  for (const BoundaryPair& pair : boundary) {
    const float weight = compute_weight(pair.difference, medians.at(pair.part));
    system.diagonal[pair.pixel] += weight;
    system.right[pair.pixel] += weight * pair.difference;
  }
  return system;
}

}  // namespace

cv::Mat3b adapt_fill(const cv::Mat3b& frame, const cv::Mat3b& fill, const cv::Mat1b& hole) {
  const PoissonSystem system = make_system(frame, fill, hole);
  std::vector<cv::Vec3f> correction(system.region.size());
  solve_poisson(system, correction);
  cv::Mat3b out = frame.clone();
  for (std::size_t i = 0; i < correction.size(); ++i) {
    const cv::Point p = system.region.pixels[i];
    for (int c = 0; c < 3; ++c) out(p)[c] = cv::saturate_cast<uchar>(static_cast<float>(fill(p)[c]) + correction[i][c]);
  }
  return out;
}

}  // namespace dvi::harmonize
