#pragma once

#include <vector>

#include "dvi/map/static_map.h"
#include "dvi/synthesize/road.h"

namespace dvi::synthesize {

/// Height of the ground along the road, from the map's level surfaces.
class Ground {
 public:
  Ground(const map::StaticMap& map, const Road& road, const Views& views);

  /// Whether there is any: level surfaces below the cameras.
  bool found() const { return !lane_.empty(); }
  /// Metres, world axes.
  double height(double along, double left) const;

 private:
  double square(int along, int left) const;

  std::vector<float> lane_;    // by kSquare of the way
  std::vector<float> beside_;  // relative to it, kAcross a square of the way
};

}  // namespace dvi::synthesize
