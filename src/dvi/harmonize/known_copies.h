#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/depth/target.h"
#include "dvi/harmonize/confidence.h"
#include "dvi/harmonize/fuse.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {

/// The image that a pixel is copied to, and the difference between copy and result in gray levels.
struct CopyTarget {
  const cv::Mat3f& image;
  double change;
};

/// Gathers the evidence on the error of one fused copy; `pixel` is its index in the hole.
CopyEvidence gather_evidence(const depth::Target& target, const Fused& fused, std::size_t pixel, const CopyTarget& to);

/// Copies known pixels, by sample::sample_known(), as if they were removed, and compares them with the target. Their local mean
/// difference is subtracted as a change of illumination, as the solution of eq. 5 does in the hole.
std::vector<KnownCopy> measure_known_copies(const depth::Target& target, const sample::Candidates& known);

}  // namespace dvi::harmonize
