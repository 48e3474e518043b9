#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/image/region.h"

namespace dvi {

/// For each pixel p of the region: diagonal(p) x(p) - sum of w x(q) over its 4-neighbors q in the region = right(p), w being 1
/// along rows and `vertical` along columns, or what `beside` says of the left and `below` of the upper pixel of both. A
/// diagonal is at least the sum of those w, and greater somewhere in each connected part.
struct PoissonSystem {
  Region region;
  std::vector<float> diagonal;
  std::vector<cv::Vec3f> right;
  float vertical = 1;
  std::vector<float> beside{}, below{};  ///< as region.pixels; empty: 1 and `vertical` everywhere
};

/// Solves for x from the values it comes with; conjugate gradients, preconditioned by one multigrid cycle on blocks of
/// 2 x 2 pixels. Stops once the estimated error is below `tolerance` everywhere. Returns the iterations.
int solve_poisson(const PoissonSystem& system, std::vector<cv::Vec3f>& x, double tolerance = 0.02);

}  // namespace dvi
