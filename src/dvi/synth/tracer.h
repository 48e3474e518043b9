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

/// The movers on the street at a time, in seconds after the first frame, that are near the recording car.
std::vector<PlacedMover> placed(const std::vector<Mover>& movers, const Street& street, double time, double own_s);

/// What a ray sees in the static world and among the movers of one time.
class Tracer {
 public:
  Tracer(const StaticWorld& world, std::vector<PlacedMover> movers) : world_(world), movers_(std::move(movers)) {}

  struct Seen {
    double t = std::numeric_limits<double>::infinity();  ///< infinite: sky
    int id = 0;  ///< of the surface; neighboring rays with equal ids see one smooth surface
    bool dynamic = false;
    bool shaded = false;  ///< from the sun, by someone who walks
    int mover = -1;
    Hit hit;
    Ground::Place ground;
  };
  Seen trace(const Ray& ray, double t_max = std::numeric_limits<double>::infinity()) const;
  /// `pixel_share`: side of the area to average over, as a share of a pixel.
  cv::Vec3f shade(const Ray& ray, const Seen& seen, double pixel_share = 1) const;

  const std::vector<PlacedMover>& movers() const { return movers_; }

 private:
  float light_left(const Eigen::Vector3d& x) const;
  bool in_shadow(const Eigen::Vector3d& x) const;

  const StaticWorld& world_;
  std::vector<PlacedMover> movers_;
};

/// How far the soft shadow under a mover reaches beyond its box, meters.
inline constexpr double kShadowReach = 0.4;

}  // namespace dvi::synth
