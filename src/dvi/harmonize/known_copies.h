#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/drive/view.h"
#include "dvi/harmonize/confidence.h"
#include "dvi/harmonize/fuse.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {

/// What the fused copies of a frame have as evidence. `image` is what they are copied to, `light` by how many gray levels each
/// is changed to be in the frame's light.
CopyEvidence evidence_of(const Fused& fused, std::size_t pixel, const Views& views, std::size_t target, const cv::Mat3f& image,
                         double light);

/// Known pixels (sample::sample_known), copied as if they were removed, against what the target shows there. As the solution of
/// eq. 5 does in the hole, what they differ by on average nearby is taken off as light.
std::vector<KnownCopy> known_copies(const sample::Candidates& known, const Views& views, std::size_t target);

}  // namespace dvi::harmonize
