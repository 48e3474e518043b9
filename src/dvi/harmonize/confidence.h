#pragma once

#include <vector>

namespace dvi::harmonize {

/// Quantities that predict the error of a copied pixel. Gray levels are means over the channels.
struct CopyEvidence {
  double position_error_px = 0;  ///< Expected displacement of the copy.
  double texture = 0;      ///< Largest difference to a neighbor in gray levels: the error due to a displacement of one pixel.
  double spread = 0;       ///< Mean difference of the further sources to the leading one, in gray levels.
  bool is_single = false;  ///< Whether there is no further source.
  bool is_other_drive = false;  ///< Whether the source is a frame of another drive, with another illumination.
  double change = 0;            ///< Difference between copy and result, in gray levels.
  double seconds = 0;           ///< Time between target and source; used if they belong to one drive.
};

/// Estimates the error of a copied pixel in gray levels: the root of the sum of squares of its parts.
double estimate_error_levels(const CopyEvidence& evidence);

/// Returns the probability that a pixel with an expected error is within 10 gray levels of the truth: a logistic function of
/// the logarithm of the error.
double confidence_of_copy(double error_levels);

/// A copy whose truth is known.
struct KnownCopy {
  double expected_levels = 0;  ///< Expected error in gray levels, by estimate_error_levels().
  bool is_within = false;      ///< Whether it is within 10 gray levels of the truth.
};

/// Calibrates expected errors by copies whose truth is known. The factor at an expected error makes the share of copies with
/// similar errors (weights are a Gaussian of 0.6 in the logarithm) that are within 10 gray levels equal to their mean
/// confidence. It is limited to 1/4 to 4, and nearer to 1 the fewer copies there are.
class ErrorScale {
 public:
  explicit ErrorScale(const std::vector<KnownCopy>& copies);
  /// Returns the factor for an expected error in gray levels.
  double at(double expected_levels) const;

 private:
  std::vector<double> logarithms_;  // logarithm of the factor, by steps of the logarithm of the expected error, from 0
};

/// Returns the confidence of an interpolated pixel from its distance in pixels to the nearest known or copied pixel.
double confidence_of_interpolation(double distance_px);

}  // namespace dvi::harmonize
