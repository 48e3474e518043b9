#include "dvi/harmonize/adapt_fill.h"

#include <vector>

#include "dvi/image/neighbors.h"
#include "dvi/image/poisson.h"
#include "dvi/image/region.h"

namespace dvi::harmonize {
namespace {

/// Returns for each connected part of a hole whether it has a known neighbor; the index is its label, from 1.
std::vector<char> find_bounded_parts(const Region& hole, const cv::Mat1i& parts, int count) {
  std::vector<char> bounded(static_cast<std::size_t>(count) + 1, 0);
  const cv::Rect image({}, parts.size());
  for (const cv::Point p : hole.pixels)
    for (const cv::Point q : four_neighbors(p))
      if (image.contains(q) && hole.index(q) < 0) bounded[static_cast<std::size_t>(parts(p))] = 1;
  return bounded;
}

/// Makes the Laplace equation of the correction, whose values at the pixels around the hole are frame - fill.
PoissonSystem make_system(const cv::Mat3b& frame, const cv::Mat3b& fill, const cv::Mat1b& hole) {
  PoissonSystem system;
  system.region = Region(hole);
  cv::Mat1i parts;
  const int count = label_connected_parts(hole, parts);
  const std::vector<char> bounded = find_bounded_parts(system.region, parts, count);
  const cv::Rect image({}, frame.size());
  for (const cv::Point p : system.region.pixels) {
    float diagonal = bounded[static_cast<std::size_t>(parts(p))] != 0 ? 0 : 1;  // 1: the solution of an unbounded part is 0
    cv::Vec3f right;
    for (const cv::Point q : four_neighbors(p)) {
      if (!image.contains(q)) continue;
      ++diagonal;
      if (system.region.index(q) < 0) right += cv::Vec3f(frame(q)) - cv::Vec3f(fill(q));
    }
    system.diagonal.push_back(diagonal);
    system.right.push_back(right);
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
