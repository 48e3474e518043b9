#pragma once

#include <vector>

#include "dvi/core/interrupt.h"
#include "dvi/core/options.h"
#include "dvi/drive/view.h"
#include "dvi/map/static_map.h"

namespace dvi::exposure {

struct ExposureOptions {
  bool enabled = true;

  void describe(OptionTable& table) {
    table.section("exposure");
    table.add("enabled", enabled, "Bring all frames into one light: a gain a frame and channel, from the map's points.");
  }
};

/// Finds each view's gain: views are compared in the colours that both show of the same points of the map, unmasked, unhidden,
/// neither black nor saturated; the gains of all views are then solved for jointly and robustly from these ratios (least
/// squares on their logarithms, reweighted). Their logarithms have mean 0. Poses good to some pixels will do. Returns for each
/// view the number of views it could be compared with: where that is 0, its gain stays 1. One tick a view.
std::vector<int> estimate_exposure(Views& views, const map::StaticMap& map, const Tick& tick = [] {});

}  // namespace dvi::exposure
