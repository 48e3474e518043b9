#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "dvi/geometry/box.h"
#include "dvi/holdout/driven_path.h"

namespace dvi::holdout {

/// What is put into a drive, as `--scenario` names it (docs/holdout.md).
enum class Scenario { lead, oncoming, crossing, parked, truck, banner, far };
inline constexpr std::array kScenarios = {Scenario::lead,  Scenario::oncoming, Scenario::crossing, Scenario::parked,
                                          Scenario::truck, Scenario::banner,   Scenario::far};
const char* name(Scenario scenario);
/// UsageError for an unknown one.
Scenario parse_scenario(const std::string& text);

/// A box that moves on the road. Its seed varies distances, speeds and sideways place. Not for `banner`, which is none.
class VirtualVehicle {
 public:
  /// The drive is recorded from `start_ns` to `end_ns`.
  VirtualVehicle(Scenario scenario, std::uint64_t seed, std::shared_ptr<const DrivenPath> road, std::int64_t start_ns,
                 std::int64_t end_ns);

  /// Moves a parked one along the road, by 15 m at most, to the place nearest to the one drawn at which no return of the
  /// drive's scans is inside it (obstacles.h); where there is none, to the nearest with the fewest.
  void stand_clear(const Drive& drive, const Trajectory& world_from_lidar);
  /// How stand_clear() went.
  struct Stand {
    double moved = 0;         ///< meters ahead
    std::size_t returns = 0;  ///< still inside
  };
  const std::optional<Stand>& stand() const { return stand_; }

  const std::string& type() const { return type_; }
  const Eigen::Vector3d& size() const { return size_; }
  Box at(std::int64_t time_ns) const;  ///< in the world

 private:
  // Place: meters along the road and to its left, each even in time; some keep their distance to the drive, and sway about it.
  struct Motion {
    double along = 0, along_speed = 0;
    double left = 0, left_speed = 0;
    double turn = 0;  // radians against the road's direction
    bool follows = false;
    double sway = 0, phase = 0;
  };

  std::string type_ = "car";
  Eigen::Vector3d size_{4.2, 1.8, 1.55};
  Motion motion_;
  std::shared_ptr<const DrivenPath> road_;
  std::int64_t start_ns_;
  std::optional<Stand> stand_;
};

}  // namespace dvi::holdout
