#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/depth/target.h"
#include "dvi/harmonize/confidence.h"
#include "dvi/harmonize/fuse.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {

/// What the copies of a frame are compared with: the image that they are copied to, and by how many gray levels one is changed
/// to be in the light of that image.
struct CopiedTo {
  const cv::Mat3f& image;
  double change;
};

/// The evidence for how far one fused copy, a pixel of the hole, is off.
CopyEvidence evidence_of(const depth::Target& target, const Fused& fused, std::size_t pixel, const CopiedTo& to);

/// Copies known pixels (sample::sample_known) as if they were removed, and compares them with what the target shows there. As
/// the solution of eq. 5 does in the hole, their mean difference nearby is subtracted as a change of light.
std::vector<KnownCopy> known_copies(const depth::Target& target, const sample::Candidates& known);

}  // namespace dvi::harmonize
