#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "dvi/drive/view.h"

namespace dvi::ground {

/// Coordinates along the road: meters along the path of a drive's cameras, and meters to its left. The path is extended by a
/// straight line before its first and after its last camera. Between consecutive cameras that are hundreds of meters apart, the
/// path is split; its pieces follow each other in these coordinates, so that wrong poses do not increase its cost.
class RoadFrame {
 public:
  static constexpr double kExtensionM = 150;  ///< length of the straight line at each end
  static constexpr double kHalfWidthM = 20;   ///< largest distance from the path

  /// Follows the cameras of the target.
  explicit RoadFrame(const Views& views);

  /// Returns the length of the extended path in meters; the first camera is at kExtensionM.
  double length() const { return static_cast<double>(path_.size() - 1); }
  /// Returns the x and y of a position in the world.
  Eigen::Vector2d to_world(double along, double left) const;
  /// Returns the unit vector along the road.
  Eigen::Vector2d direction(double along) const;
  /// Converts a position in the world to meters along the path and to its left; nothing beyond kHalfWidthM.
  std::optional<Eigen::Vector2d> locate(const Eigen::Vector2d& position) const;

 private:
  using Square = std::pair<int, int>;
  struct Piece {
    int first, last;  // indices in path_, both included
  };

  void add_piece(const std::vector<Eigen::Vector2d>& path, const Views& views);
  void index_squares();
  int meter(double along) const;               // the last path point before a position
  Eigen::Vector2d middle(double along) const;  // to_world(along, 0)

  std::vector<Eigen::Vector2d> path_, directions_;  // points at intervals of one meter
  std::vector<Piece> pieces_;                       // in order
  std::map<Square, std::vector<int>> near_;         // path points that may be the nearest to a position in the square
};

}  // namespace dvi::ground
