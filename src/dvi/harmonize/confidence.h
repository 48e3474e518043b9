#pragma once

namespace dvi {

/// What is known about a copied pixel.
struct CopyEvidence {
  double seconds = 0;       ///< between target and source
  double depth_spread = 0;  ///< standard deviation of the depth, relative to the depth; 0 where there is none
  double change = 0;        ///< mean of |result - copy| over the channels, grey levels
};

/// Probability that a pixel is within 10 grey levels of the truth. Priors, monotone in each argument; not yet calibrated.
double copied_confidence(const CopyEvidence& evidence);

/// The same for an interpolated pixel, by its distance in pixels to the nearest pixel that was known or copied.
double interpolated_confidence(double distance);

}  // namespace dvi
