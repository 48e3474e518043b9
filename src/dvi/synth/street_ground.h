#pragma once

#include <vector>

#include "dvi/synth/paint.h"
#include "dvi/synth/solid.h"
#include "dvi/synth/street.h"

namespace dvi::synth {

/// A soft shadow on the ground, such as that of a parked car, a tree, or a house. Corners are (s, d).
struct Shade {
  std::vector<Eigen::Vector2d> corners;
  double strength = 0.5;  ///< share of the light that it absorbs
  double softness_m = 0.3;
};

/// The part of the street whose ground is painted, and its look.
struct GroundPlan {
  std::uint64_t seed = 0;
  double s_begin = 0, s_end = 0;
  std::vector<Shade> shades;
  bool wet = false;
};

/// The carriageway and pavements: two planes, with one picture per ten meters of the street.
class Ground {
 public:
  Ground() = default;
  Ground(const Street& street, const Noise& noise, const GroundPlan& plan);

  struct Place {
    double t = std::numeric_limits<double>::infinity();
    bool pavement = false;
    double s = 0, d = 0;
  };
  /// Returns the intersection of a ray with the ground; t is infinite if there is none.
  Place trace(const Ray& ray) const;
  cv::Vec3f shade(const Ray& ray, const Place& place, const Light& light, double pixel_share = 1) const;

 private:
  Street street_;
  double begin_ = 0;
  std::vector<Texture> chunks_;
};

/// Returns the position s of a pedestrian crossing.
double crossing(int number);

}  // namespace dvi::synth
