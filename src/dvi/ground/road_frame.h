#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "dvi/drive/view.h"

namespace dvi::ground {

/// Coordinates along the road: meters along the way of a drive's cameras, and to the left of it. The way goes on straight
/// before its first and behind its last camera. Where two cameras in a row are hundreds of meters apart, it consists of pieces
/// that follow each other in these coordinates, so that its cost does not depend on how far poses are off.
class RoadFrame {
 public:
  static constexpr double kOnward = 70;  ///< meters the way goes on, at either end
  static constexpr double kReach = 20;   ///< meters to either side

  /// Of the target's cameras.
  explicit RoadFrame(const Views& views);

  /// Meters: of the whole way; its first camera is at kOnward.
  double length() const { return static_cast<double>(way_.size() - 1); }
  /// World x and y of a place.
  Eigen::Vector2d place(double along, double left) const;
  /// The unit vector along the road.
  Eigen::Vector2d direction(double along) const;
  /// Meters along and to the left; none beyond the road's reach.
  std::optional<Eigen::Vector2d> locate(const Eigen::Vector2d& place) const;

 private:
  using Square = std::pair<int, int>;
  struct Piece {
    int first, last;  // of way_, both included
  };

  void add_piece(const std::vector<Eigen::Vector2d>& way, const Views& views);
  void find_near();
  int meter(double along) const;               // that begins before a place
  Eigen::Vector2d middle(double along) const;  // place(along, 0)

  std::vector<Eigen::Vector2d> way_, directions_;  // a meter apart
  std::vector<Piece> pieces_;                      // in order
  std::map<Square, std::vector<int>> near_;        // those that may be the nearest of a place in the square
};

}  // namespace dvi::ground
