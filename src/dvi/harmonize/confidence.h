#pragma once

#include <vector>

namespace dvi::harmonize {

/// What is known about a copied pixel. Gray levels are means over the channels.
struct CopyEvidence {
  double shift = 0;        ///< px by which the copy is expected to be off
  double texture = 0;      ///< gray levels by which it differs most from a neighbor: what a pixel of shift costs
  double spread = 0;       ///< gray levels by which the further sources differ from the leading one
  bool alone = false;      ///< there is no further source
  bool elsewhere = false;  ///< another drive shows it, in another light
  double change = 0;       ///< gray levels from the copy to the result
  double seconds = 0;      ///< between target and source, if they are of one drive
};

/// Gray levels by which a copied pixel is expected to be off: the pieces of evidence add up.
double expected_error(const CopyEvidence& evidence);

/// Probability that a pixel is within 10 gray levels of the truth whose expected error is `error`: a logistic curve of its
/// logarithm.
double copied_confidence(double error);

/// A copy whose truth is known.
struct KnownCopy {
  double expected = 0;  ///< gray levels, see expected_error()
  bool within = false;  ///< 10 gray levels of the truth
};

/// What expected errors are to be multiplied by, so that of the copies that are expected to be off about as much (a Gaussian
/// of 0.6 over the logarithm) as many are within 10 gray levels as they say. Within 1/4 and 4, and the nearer to 1 the fewer
/// there are.
class ErrorScale {
 public:
  explicit ErrorScale(const std::vector<KnownCopy>& copies);
  double at(double expected) const;

 private:
  std::vector<double> logarithms_;  // of the scale, at steps of the logarithm of the expected error, from that of 1
};

/// The confidence of an interpolated pixel, by its distance in pixels to the nearest pixel that was known or copied.
double interpolated_confidence(double distance);

}  // namespace dvi::harmonize
