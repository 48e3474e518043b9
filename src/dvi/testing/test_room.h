#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "dvi/core/random.h"
#include "dvi/drive/drive.h"
#include "dvi/geometry/se3.h"

namespace dvi {

/// A room with four walls, floor, ceiling, and furniture, observed by a depth camera of 60 x 45 degrees whose noise is
/// proportional to the square of the depth.
struct TestRoom {
  struct Box {
    Eigen::Array3d low, high;
  };
  Box walls{{-1, -2, 0}, {3, 1.5, 2.5}};
  std::vector<Box> furniture{{{1.4, -0.5, 0}, {2.2, 0.4, 0.8}}};

  /// Makes a scan; the camera's axes are x forward, y left, z up.
  Scan scan(const SE3& world_from_camera, std::uint64_t seed) const {
    Random random(seed);
    Scan out;
    for (int v = -45; v <= 45; ++v)
      for (int u = -60; u <= 60; ++u) {
        const Eigen::Vector3d ray(1, 0.01 * u, 0.0092 * v);
        const double depth = hit(world_from_camera.t, world_from_camera.R * ray);
        out.points.push_back(((depth + 0.002 * depth * depth * random.normal()) * ray).cast<float>());
      }
    out.intensity.assign(out.size(), 0.0F);
    out.time.assign(out.size(), 0.0F);
    return out;
  }

  /// Replaces the furniture with random boxes of several heights along the walls; the center of the room is free.
  void furnish(std::uint64_t seed) {
    Random random(seed);
    furniture.clear();
    for (int side = 0; side < 4; ++side)
      for (double at = 0.02; at < 0.9;) {
        const double length = random.uniform(0.08, 0.25), deep = random.uniform(0.1, 0.8), height = random.uniform(0.3, 2.2);
        const int along = side % 2, across = 1 - along;
        Box box{walls.low, walls.high};
        const double size = walls.high[along] - walls.low[along];
        box.low[along] = walls.low[along] + at * size;
        box.high[along] = walls.low[along] + std::min(at + length, 0.98) * size;
        (side < 2 ? box.high : box.low)[across] = side < 2 ? walls.low[across] + deep : walls.high[across] - deep;
        box.high[2] = height;
        furniture.push_back(box);
        at += length + random.uniform(0.02, 0.12);
      }
  }

  /// Returns the distance to the first surface on a ray, in units of the ray's length.
  double hit(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) const {
    double nearest = 100;
    for (int axis = 0; axis < 3; ++axis)
      if (ray[axis] != 0)
        nearest = std::min(nearest, ((ray[axis] > 0 ? walls.high : walls.low)[axis] - from[axis]) / ray[axis]);
    for (const Box& box : furniture) {
      const Eigen::Array3d a = (box.low - from.array()) / ray.array(), b = (box.high - from.array()) / ray.array();
      const double in = a.min(b).maxCoeff(), out = a.max(b).minCoeff();
      if (in > 0 && in <= out) nearest = std::min(nearest, in);
    }
    return nearest;
  }
};

}  // namespace dvi
