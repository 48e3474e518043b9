#pragma once

namespace dvi::harmonize {

/// What is known about a copied pixel. Grey levels are means over the channels.
struct CopyEvidence {
  double shift = 0;        ///< px by which the copy is expected to be off
  double texture = 0;      ///< grey levels by which it differs most from a neighbour: what a pixel of shift costs
  double spread = 0;       ///< grey levels by which the further sources differ from the leading one
  bool alone = false;      ///< there is no further source
  bool elsewhere = false;  ///< another drive shows it, in another light
  double change = 0;       ///< grey levels from the copy to the result
  double seconds = 0;      ///< between target and source, if they are of one drive
};

/// Probability that a pixel is within 10 grey levels of the truth, falling with each piece of evidence: they add up to an
/// expected error, and its logarithm goes through a logistic curve.
double copied_confidence(const CopyEvidence& evidence);

/// The same for an interpolated pixel, by its distance in pixels to the nearest pixel that was known or copied.
double interpolated_confidence(double distance);

}  // namespace dvi::harmonize
