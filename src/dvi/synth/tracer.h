#pragma once

#include <vector>

#include "dvi/synth/static_world.h"
#include "dvi/synth/traffic.h"

namespace dvi::synth {

/// A mover at one time.
struct PlacedMover {
  const Mover* mover;
  const Model* model;
  SE3 world_from_mover, mover_from_world;
};

/// Places the movers that are near the recording car at a time in seconds after the first frame.
std::vector<PlacedMover> place_movers(const std::vector<Mover>& movers, const Street& street, double time, double own_s);

/// Traces rays in the static world and among the movers of one time.
class Tracer {
 public:
  Tracer(const StaticWorld& world, std::vector<PlacedMover> movers) : world_(world), movers_(std::move(movers)) {}

  struct Seen {
    double t = std::numeric_limits<double>::infinity();  ///< infinite: sky
    int id = 0;  ///< of the surface; neighboring rays with equal ids hit one smooth surface
    bool dynamic = false;
    bool shaded = false;  ///< in the shadow of a walking person
    int mover = -1;
    Hit hit;
    Ground::Place ground;
  };
  Seen trace(const Ray& ray, double t_max = std::numeric_limits<double>::infinity()) const;
  /// Computes the color; `pixel_share` is the side of the averaged area as a share of a pixel.
  cv::Vec3f shade(const Ray& ray, const Seen& seen, double pixel_share = 1) const;

  const std::vector<PlacedMover>& movers() const { return movers_; }

 private:
  float light_left(const Eigen::Vector3d& x) const;
  bool in_shadow(const Eigen::Vector3d& x) const;

  const StaticWorld& world_;
  std::vector<PlacedMover> movers_;
};

/// The distance in meters that the soft shadow under a mover extends beyond its box.
inline constexpr double kShadowReachM = 0.4;

}  // namespace dvi::synth
