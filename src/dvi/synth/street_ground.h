#pragma once

#include <vector>

#include "dvi/synth/paint.h"
#include "dvi/synth/solid.h"
#include "dvi/synth/street.h"

namespace dvi::synth {

/// A soft dark place on the ground: of a parked car, of a tree, of a house. Corners are (s, d).
struct Shade {
  std::vector<Eigen::Vector2d> corners;
  double strength = 0.5;  ///< share of the light it takes
  double softness_m = 0.3;
};

/// Carriageway and pavements: two planes, one picture every ten meters of the street.
class Ground {
 public:
  Ground() = default;
  Ground(const Street& street, std::uint64_t seed, const Noise& noise, double s_begin, double s_end,
         const std::vector<Shade>& shades, bool wet);

  struct Place {
    double t = std::numeric_limits<double>::infinity();
    bool pavement = false;
    double s = 0, d = 0;
  };
  /// Where a ray meets it; infinite t where it does not.
  Place trace(const Ray& ray) const;
  cv::Vec3f shade(const Ray& ray, const Place& place, const Light& light, double pixel_share = 1) const;

 private:
  Street street_;
  double begin_ = 0;
  std::vector<Texture> chunks_;
};

/// Where pedestrians cross.
double crossing(int number);

}  // namespace dvi::synth
