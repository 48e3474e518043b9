#include "dvi/geometry/earth_place.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "dvi/core/median.h"
#include "dvi/geometry/angles.h"

namespace dvi {
namespace {

// The meters per radian of latitude and of longitude at a latitude of the WGS84 ellipsoid.
struct Radii {
  double north, east;

  explicit Radii(double latitude_deg) {
    constexpr double kEquatorRadiusM = 6378137, kEccentricity2 = 6.69437999014e-3;
    const double sine = std::sin(latitude_deg * kRadPerDegree), w = std::sqrt(1 - kEccentricity2 * sine * sine);
    north = kEquatorRadiusM * (1 - kEccentricity2) / (w * w * w);
    east = kEquatorRadiusM / w * std::cos(latitude_deg * kRadPerDegree);
  }
};

using Plane = std::complex<double>;  // x + iy of the world, or east + i north on Earth

// The transform earth = origin + turn * world.
struct Fit {
  Plane origin, turn = 1;
};

Fit fit_least_squares(const std::vector<Plane>& world, const std::vector<Plane>& earth, const std::vector<double>& weights) {
  Plane world_mean = 0, earth_mean = 0, product = 0;
  double sum = 0;
  for (std::size_t i = 0; i < world.size(); ++i)
    world_mean += weights[i] * world[i], earth_mean += weights[i] * earth[i], sum += weights[i];
  world_mean /= sum, earth_mean /= sum;
  for (std::size_t i = 0; i < world.size(); ++i)
    product += weights[i] * (earth[i] - earth_mean) * std::conj(world[i] - world_mean);
  const Plane turn = std::abs(product) > 0 ? product / std::abs(product) : 1;
  return {earth_mean - turn * world_mean, turn};
}

std::vector<double> compute_residuals(const Fit& fit, const std::vector<Plane>& world, const std::vector<Plane>& earth) {
  std::vector<double> out;
  for (std::size_t i = 0; i < world.size(); ++i) out.push_back(std::abs(fit.origin + fit.turn * world[i] - earth[i]));
  return out;
}

// A fix under a bridge may be off by meters, so fixes get Cauchy weights scaled by the median residual.
Fit fit_robustly(const std::vector<Plane>& world, const std::vector<Plane>& earth) {
  constexpr int kIterations = 10;
  constexpr double kMinScaleM = 0.01;  // the best accuracy of receivers
  std::vector<double> weights(world.size(), 1);
  Fit fit = fit_least_squares(world, earth, weights);
  for (int round = 0; round < kIterations; ++round) {
    const std::vector<double> off = compute_residuals(fit, world, earth);
    const double scale = std::max(2 * median(off), kMinScaleM);
    for (std::size_t i = 0; i < off.size(); ++i) weights[i] = 1 / (1 + (off[i] / scale) * (off[i] / scale));
    fit = fit_least_squares(world, earth, weights);
  }
  return fit;
}

double compute_extent(const std::vector<Plane>& path) {
  double most = 0;
  for (const Plane& p : path) most = std::max(most, std::abs(p - path.front()));
  return most;
}

}  // namespace

std::optional<FoundPlace> find_place(const Trajectory& world_from_body, const std::vector<GeoFix>& fixes) {
  constexpr std::size_t kMinFixes = 3;
  constexpr double kMinErrorM = 0.05, kMaxHeadingErrorDeg = 5;  // the former between fixes of one drive
  if (fixes.empty()) return std::nullopt;
  const GeoFix& first = fixes.front();
  const Radii radii(first.latitude_deg);
  std::vector<Plane> world, earth;
  for (const GeoFix& fix : fixes) {
    const std::optional<SE3> pose = world_from_body.at(fix.time_ns);
    if (!pose) continue;
    const Eigen::Vector3d antenna = *pose * fix.antenna;
    const double east_deg = std::remainder(fix.longitude_deg - first.longitude_deg, 360);
    world.emplace_back(antenna.x(), antenna.y());
    earth.emplace_back(radii.east * east_deg * kRadPerDegree,
                       radii.north * (fix.latitude_deg - first.latitude_deg) * kRadPerDegree);
  }
  if (world.size() < kMinFixes) return std::nullopt;
  const Fit fit = fit_robustly(world, earth);
  FoundPlace out;
  out.fixes = world.size();
  out.residual_m = median(compute_residuals(fit, world, earth));
  out.heading_bound_deg = std::atan2(4 * std::max(out.residual_m, kMinErrorM), compute_extent(world)) / kRadPerDegree;
  if (out.heading_bound_deg > kMaxHeadingErrorDeg) return std::nullopt;
  out.place.latitude_deg = first.latitude_deg + fit.origin.imag() / radii.north / kRadPerDegree;
  out.place.longitude_deg = std::remainder(first.longitude_deg + fit.origin.real() / radii.east / kRadPerDegree, 360);
  out.place.heading_deg = std::fmod(450 - std::arg(fit.turn) / kRadPerDegree, 360);  // x points east at angle 0
  return out;
}

}  // namespace dvi
