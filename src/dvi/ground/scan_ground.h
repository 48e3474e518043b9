#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "dvi/drive/drive.h"

namespace dvi::ground {

/// Parameters of the ground from scans.
struct ScanGroundParams {
  double square_m = 1;            ///< edge of the squares with one height each
  double level_m = 0.1;           ///< height of the bins of returns
  double max_range_m = 80;        ///< largest range at which objects are searched
  std::size_t point_step = 4;     ///< every fourth return of a scan is used
  double max_obstacle_m = 0.3;    ///< height difference in the lane; higher than any curb
  double lane_half_width_m = 3;   ///< distance from the path
  double max_curb_m = 0.1;        ///< height difference between squares ...
  double max_slope = 0.15;        ///< ... plus this share of their distance ...
  double max_rise_m = 0.4;        ///< ... up to this, which is lower than the hood of a car
  double max_bank_m = 4;          ///< length over which a bank may rise
  double max_gap_m = 8;           ///< between rays on the ground, and below a truck
  int max_error_returns = 3;      ///< returns of a square that may be errors
  double max_error_share = 0.02;  ///< likewise, as a share of the square's returns
};
inline constexpr ScanGroundParams kScanGround;

/// The height of a square of the ground.
struct GroundSquare {
  int x = 0, y = 0;     ///< numbers of the square: its edges are at these multiples of square_m and at the next ones
  double height_m = 0;  ///< in the world
};

/// The height of the ground: per square meter, the mean of the lowest level at which scans of the whole drive have repeated
/// returns, interpolated between the squares. Single returns below it, for example from mirrors, do not count.
class ScanGround {
 public:
  ScanGround(const Drive& drive, const Trajectory& world_from_lidar);
  explicit ScanGround(const std::vector<GroundSquare>& squares);

  std::vector<GroundSquare> squares() const;

  /// Returns the height at a position in the world, in meters: interpolated between the adjacent squares, or from the nearest
  /// square within 2 m; nothing if there is none.
  std::optional<double> height(const Eigen::Vector2d& position) const;

 private:
  using Square = std::pair<int, int>;
  std::optional<double> find_nearest(int x, int y) const;

  std::map<Square, double> heights_;
};

}  // namespace dvi::ground
