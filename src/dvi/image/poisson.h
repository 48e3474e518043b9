#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/image/region.h"

namespace dvi {

/// The system of equations diagonal(p) x(p) - sum of w x(q) = right(p) for each pixel p of a region, over its 4-neighbors q in
/// the region. The weight w is 1 along rows and `vertical` along columns, or `beside` of the left and `below` of the upper
/// pixel of the pair. Each diagonal must be at least the sum of its weights, and greater somewhere in each connected part.
struct PoissonSystem {
  Region region;
  std::vector<float> diagonal;
  std::vector<cv::Vec3f> right;
  float vertical = 1;
  std::vector<float> beside{}, below{};  ///< per pixel of the region; empty: 1 and `vertical` everywhere
};

/// Solves for x from its initial values by conjugate gradients, preconditioned by one multigrid cycle on blocks of 2 x 2
/// pixels. Stops when the estimated error is below `tolerance` everywhere. Returns the number of iterations.
int solve_poisson(const PoissonSystem& system, std::vector<cv::Vec3f>& x, double tolerance = 0.02);

}  // namespace dvi
