#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace dvi::registration {

/// What the single things of a place say of how it lies on another.
struct Confirmation {
  std::size_t confirmed = 0;  ///< blocks that fit best where they are
  std::size_t moved = 0;      ///< blocks that fit better up to 1.5 m away: parts of another street, or other cars

  std::size_t all() const { return confirmed + moved; }
  double share() const { return all() > 0 ? static_cast<double>(confirmed) / static_cast<double>(all()) : 0; }
};

/// Each block of 6 m of `b` that the other place has something like is shifted by itself, in steps of 15 cm up to 1.5 m. Walls
/// and curbs, which look the same everywhere along a street, do not count: only what would not fit half as well elsewhere. In
/// the right place most blocks do best where they are; in another street that looks alike each has a place of its own, and fits
/// there by chance in one of ten. `a`, `b`: standing points in the same level axes.
Confirmation confirm(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b);

}  // namespace dvi::registration
