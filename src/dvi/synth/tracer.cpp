#include "dvi/synth/tracer.h"

#include <algorithm>
#include <cmath>

namespace dvi::synth {
namespace {

constexpr double kMaxMoverDistanceM = 150;  // along the street
constexpr double kShadowDepth = 0.62;
constexpr int kSkyId = 0, kRoadId = 1, kPavementId = 2, kFirstSurfaceId = 3, kFirstMoverId = 1 << 24, kShadedId = 1 << 30;

}  // namespace

std::vector<PlacedMover> place_movers(const std::vector<Mover>& movers, const Street& street, double time, double own_s) {
  std::vector<PlacedMover> out;
  for (const Mover& mover : movers) {
    const Eigen::Vector2d at = mover.place(time);
    const bool indoors = at.y() > kLeftFacadeM - 0.4 || at.y() < kRightFacadeM + 0.4;
    if (indoors || std::abs(at.x() - own_s) > kMaxMoverDistanceM) continue;
    const SE3 pose = mover.world_from_mover(street, time);
    out.push_back({&mover, &mover.model(time), pose, pose.inverse()});
  }
  return out;
}

Tracer::Seen Tracer::trace(const Ray& ray, double t_max) const {
  Seen seen;
  const Ground::Place ground = world_.ground.trace(ray);
  if (ground.t < t_max) {
    seen.t = t_max = ground.t;
    seen.ground = ground;
    seen.id = ground.pavement ? kPavementId : kRoadId;
  }
  if (const Hit hit = world_.solid.trace(ray, t_max)) {
    seen.t = t_max = hit.t;
    seen.hit = hit;
    seen.id = kFirstSurfaceId + hit.surface;
  }
  for (std::size_t i = 0; i < movers_.size(); ++i) {
    const SE3& from_world = movers_[i].mover_from_world;
    const Hit hit = movers_[i].model->solid.trace({from_world * ray.origin, from_world.R * ray.direction}, t_max);
    if (!hit) continue;
    seen.t = t_max = hit.t;
    seen.hit = hit;
    seen.id = kFirstMoverId + 4096 * static_cast<int>(i) + hit.surface;
    seen.dynamic = true;
    seen.mover = static_cast<int>(i);
  }
  if (!seen.dynamic && seen.id != kSkyId && in_shadow(ray.at(seen.t))) {
    seen.shaded = true;
    seen.id |= kShadedId;  // marks an edge
  }
  return seen;
}

bool Tracer::in_shadow(const Eigen::Vector3d& x) const {
  return std::any_of(movers_.begin(), movers_.end(), [&](const PlacedMover& placed) {
    if (!placed.mover->walks()) return false;
    const Ray to_sun{placed.mover_from_world * x, placed.mover_from_world.R * world_.light.to_sun};
    return static_cast<bool>(placed.model->solid.trace(to_sun, 5, 0.01));
  });
}

float Tracer::light_left(const Eigen::Vector3d& x) const {
  double left = 1;
  for (const PlacedMover& placed : movers_) {
    const Eigen::Vector3d local = placed.mover_from_world * x;
    const Eigen::Vector2d outside = (local.head<2>().cwiseAbs() - 0.5 * placed.model->size.head<2>()).cwiseMax(-kShadowReachM);
    // The shadow decreases from full depth well inside the outline to none at the distance kShadowReachM outside it.
    const double distance = outside.cwiseMax(0).norm() + std::min(outside.maxCoeff(), 0.0);
    const double u = std::clamp((kShadowReachM - distance) / (2 * kShadowReachM), 0.0, 1.0);
    left *= 1 - kShadowDepth * u * u * (3 - 2 * u);
  }
  return static_cast<float>(left);
}

cv::Vec3f Tracer::shade(const Ray& ray, const Seen& seen, double pixel_share) const {
  if (seen.mover >= 0) {
    const PlacedMover& placed = movers_[static_cast<std::size_t>(seen.mover)];
    const SE3& from_world = placed.mover_from_world;
    const Ray local{from_world * ray.origin, from_world.R * ray.direction, from_world.R * ray.step_x,
                    from_world.R * ray.step_y};
    Light light = world_.light;
    light.to_sun = from_world.R * light.to_sun;
    return placed.model->solid.shade(local, seen.hit, light, pixel_share);
  }
  if (seen.id == kSkyId) return world_.sky.shade(ray, pixel_share);
  Light light = world_.light;
  if (seen.shaded) light.sun = {};
  if (seen.hit) return world_.solid.shade(ray, seen.hit, light, pixel_share);
  return world_.ground.shade(ray, seen.ground, light, pixel_share) * light_left(ray.at(seen.t));
}

}  // namespace dvi::synth
