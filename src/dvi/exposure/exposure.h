#pragma once

#include <cstddef>
#include <vector>

#include "dvi/core/interrupt.h"
#include "dvi/core/options.h"
#include "dvi/drive/view.h"
#include "dvi/map/visible_points.h"

namespace dvi::exposure {

struct ExposureOptions {
  bool enabled = true;

  void describe(OptionTable& table) {
    table.section("stages");
    table.developer();
    table.add("exposure", enabled,
              "Estimate vignetting and a gain per frame and channel from map points that several frames show.");
  }
};

/// One gain per view, and the vignetting of its lens.
struct Gains {
  std::vector<cv::Vec3f> of_view;  ///< BGR; the colors of a view times its gain have the common exposure
  std::vector<int> compared;       ///< number of views that a view was compared with; if it is 0, the gain is 1
  std::vector<float> vignetting;   ///< as View::vignetting

  explicit Gains(std::size_t views = 0) : of_view(views, cv::Vec3f(1, 1, 1)), compared(views, 0), vignetting(views, 0) {}
};

/// Parameters of the gains.
struct ExposureParams {
  std::size_t anchors = 3;       ///< views of earlier sequences, the nearest ones, that a view is compared with
  double radian_m = 10;          ///< distance in meters that counts as much as a radian between viewing directions
  std::size_t min_points = 50;   ///< of a pair of views
  double max_sigmas = 3;         ///< from the median of the ratios of points to that of a point that counts
  double min_sigma = 0.005;      ///< of a ratio, in logarithms; more points do not make it more precise
  double outlier = 0.03;         ///< scale of the robust weight of a pair, in logarithms
  double prior_weight = 1e-5;    ///< of "gain 1", relative to a precise pair; bounds drift over several thousand views
  int iterations = 10;           ///< of reweighting
  double max_log_gain = 1.3863;  ///< gains are between 1/4 and 4
};
inline constexpr ExposureParams kExposure;

/// Estimates the vignetting of each camera (estimate_vignetting.h) and then the gain of each view. Pairs of views are compared
/// by the sums of the colors of the map points that both show, without outliers; points are unmasked, visible, and neither
/// black nor saturated. The gains of all views are solved jointly from these ratios by reweighted least squares on their
/// logarithms, whose mean is 0. Poses with errors of some pixels suffice. Gray views among colored views are not compared, and
/// vice versa. Calls `tick` once per view.
Gains estimate_exposure(const Views& views, const map::VisibleMap& map, const Tick& tick = [] {});

}  // namespace dvi::exposure
