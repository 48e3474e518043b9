#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/depth/target.h"
#include "dvi/harmonize/confidence.h"
#include "dvi/harmonize/fuse.h"
#include "dvi/image/color_difference.h"
#include "dvi/image/neighbors.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {

/// Properties of a pixel that is copied to, in gray levels.
struct CopyTarget {
  float texture;  ///< The result of measure_texture() in the image with the copies.
  double change;  ///< The difference between the copy and the result.
};

/// Computes the largest difference of a pixel to a neighbor.
template <class Image>
float measure_texture(const Image& image, cv::Point p) {
  float texture = 0;
  for (const cv::Point q : four_neighbors(p))
    if (cv::Rect({}, image.size()).contains(q)) texture = std::max(texture, mean_difference(image(p), image(q)));
  return texture;
}

/// Gathers the evidence on the error of one fused copy; `pixel` is its index in the hole.
CopyEvidence gather_evidence(const depth::Target& target, const Fused& fused, std::size_t pixel, const CopyTarget& to);

/// Copies known pixels, by sample::sample_known(), as if they were removed, and compares them with the target. Their local mean
/// difference is subtracted as a change of illumination, as the solution of eq. 5 does in the hole.
std::vector<KnownCopy> measure_known_copies(const depth::Target& target, const sample::Candidates& known);

}  // namespace dvi::harmonize
