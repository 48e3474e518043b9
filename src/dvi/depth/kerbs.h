#pragma once

#include <array>
#include <vector>

#include "dvi/depth/surfel_mesh.h"

namespace dvi::depth {

/// Straight steps of the ground, all in one direction: kerbs. They go on where nothing was scanned.
class Kerbs {
 public:
  /// None.
  Kerbs() = default;
  /// From the steps between returns of the ground within 40 m of `eye` (world axes); none if there are few.
  Kerbs(const SurfelMesh& mesh, const Eigen::Vector3f& eye);

  bool empty() const { return lines_.empty(); }
  /// Inverse depth of the ground between three of its surfels at a pixel with these weights.
  float inverse(const std::array<const Surfel*, 3>& corners, const std::array<float, 3>& w) const;

 private:
  struct Line {
    float at = 0, height = 0;  ///< metres across; how much higher the ground is beyond it
  };
  /// `steps`: places of steps, metres; `ground`: returns.
  void find_direction(const std::vector<Eigen::Vector2f>& steps);
  void find_lines(const std::vector<Eigen::Vector2f>& steps, const std::vector<Eigen::Vector3f>& ground);
  float across(const Eigen::Vector3f& world) const { return across_.dot(world.head<2>()); }
  /// How much higher the ground is at `to` than at `from`.
  float rise(float from, float to) const;

  Eigen::Vector3f eye_ = Eigen::Vector3f::Zero();
  Eigen::Vector2f across_ = Eigen::Vector2f::UnitX();
  std::vector<Line> lines_;
};

}  // namespace dvi::depth
