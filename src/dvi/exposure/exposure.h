#pragma once

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
              "Estimate how lenses darken, and a gain per frame and channel, from map points that several frames show.");
  }
};

/// One gain a view, and how its lens darkens.
struct Gains {
  std::vector<cv::Vec3f> of_view;  ///< BGR; a view's colors times this are in the light common to all views
  std::vector<int> compared;       ///< with how many views; where it is 0 the gain is 1
  std::vector<float> vignetting;   ///< as View::vignetting

  explicit Gains(std::size_t views = 0) : of_view(views, cv::Vec3f(1, 1, 1)), compared(views, 0), vignetting(views, 0) {}
};

/// Estimates how each camera's lens darkens (vignetting.h), then each view's gain: views are compared in the colors that both
/// show of the same points of the map, unmasked, unhidden, neither black nor saturated; the gains of all views are then solved
/// for jointly and robustly from these ratios (least squares on their logarithms, reweighted). Their logarithms have mean 0.
/// Poses good to some pixels will do. Gray views among colored ones, whose colors nobody takes, stay as they are (and
/// colored ones among gray). One tick a view.
Gains estimate_exposure(const Views& views, const map::VisibleMap& map, const Tick& tick = [] {});

}  // namespace dvi::exposure
