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

/// The virtual traffic in a drive, as named by `--scenario` (docs/holdout.md).
enum class Scenario { lead, oncoming, crossing, parked, truck, banner, far };
inline constexpr std::array kScenarios = {Scenario::lead,  Scenario::oncoming, Scenario::crossing, Scenario::parked,
                                          Scenario::truck, Scenario::banner,   Scenario::far};
const char* name(Scenario scenario);
/// Throws UsageError for an unknown name.
Scenario parse_scenario(const std::string& text);

/// A box that moves on the road. The seed varies distance, speed, and lateral position. `banner` has no vehicle.
class VirtualVehicle {
 public:
  /// `recorded` is the time of the drive.
  VirtualVehicle(Scenario scenario, std::uint64_t seed, std::shared_ptr<const DrivenPath> road, const TimeSpan& recorded);

  /// Moves a parked vehicle along the road by at most 15 m to the nearest position at which no return of the drive's scans is
  /// inside it (obstacles.h); if there is none, to the nearest position with the fewest returns.
  void avoid_obstacles(const Drive& drive, const Trajectory& world_from_lidar);
  /// The result of avoid_obstacles().
  struct Avoidance {
    double moved_m = 0;       ///< displacement along the road
    std::size_t returns = 0;  ///< returns that are still inside
  };
  const std::optional<Avoidance>& avoidance() const { return avoidance_; }

  const std::string& type() const { return type_; }
  const Eigen::Vector3d& size() const { return size_; }
  Box box_at(std::int64_t time_ns) const;  ///< in the world

 private:
  // Position in meters along the road and to its left, with constant velocity. A vehicle that follows keeps its distance to the
  // drive, except for a periodic variation.
  struct Motion {
    double along = 0, along_speed = 0;
    double left = 0, left_speed = 0;
    double turn = 0;  // radians relative to the road's direction
    bool follows = false;
    double sway = 0, phase = 0;
  };

  std::string type_ = "car";
  Eigen::Vector3d size_{4.2, 1.8, 1.55};
  Motion motion_;
  std::shared_ptr<const DrivenPath> road_;
  std::int64_t start_ns_;
  std::optional<Avoidance> avoidance_;
};

}  // namespace dvi::holdout
