#include "dvi/holdout/virtual_vehicle.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/core/error.h"
#include "dvi/core/random.h"
#include "dvi/holdout/obstacles.h"

namespace dvi::holdout {
namespace {

constexpr double kLaneWidthM = 3.5;
constexpr double kSwayPeriodS = 6;
constexpr double kMinParkedM = 10;  // ahead of the first frame, so that its camera shows the vehicle
constexpr double kPi = std::numbers::pi;

}  // namespace

const char* name(Scenario scenario) {
  constexpr std::array kNames = {"lead", "oncoming", "crossing", "parked", "truck", "banner", "far"};
  return kNames[static_cast<std::size_t>(scenario)];
}

Scenario parse_scenario(const std::string& text) {
  std::vector<std::string> names;
  for (const Scenario scenario : kScenarios) {
    if (text == name(scenario)) return scenario;
    names.emplace_back(name(scenario));
  }
  throw UsageError(fmt::format("--scenario {}: unknown; the scenarios are {}", text, fmt::join(names, ", ")));
}

VirtualVehicle::VirtualVehicle(Scenario scenario, std::uint64_t seed, std::shared_ptr<const DrivenPath> road,
                               const TimeSpan& recorded)
    : road_(std::move(road)), start_ns_(recorded.first) {
  Random random(seed);
  const double first = road_->path_length_at(recorded.first), traveled = road_->path_length_at(recorded.last) - first;
  const double seconds = std::max(0.1, 1e-9 * static_cast<double>(recorded.last - recorded.first));
  const double speed = traveled / seconds;
  switch (scenario) {
    case Scenario::lead:
      motion_ = {.along = random.uniform(10.2, 10.8),
                 .left = random.uniform(-0.3, 0.3),
                 .follows = true,
                 .sway = 1.2,
                 .phase = random.uniform(0, 2 * kPi)};
      break;
    case Scenario::truck:
      type_ = "truck", size_ = {9, 2.5, 3.5};
      motion_ = {.along = 4.5 + random.uniform(9, 10), .left = random.uniform(-0.2, 0.2), .follows = true};
      break;
    case Scenario::far:  // always hides the vanishing point
      type_ = "van", size_ = {5.5, 2, 2.4};
      motion_ = {.along = random.uniform(30, 35),
                 .left = random.uniform(-0.2, 0.2),
                 .follows = true,
                 .sway = 5,
                 .phase = random.uniform(0, 2 * kPi)};
      break;
    case Scenario::oncoming: {
      // Passes near the end of a short recording.
      const double own = random.uniform(8, 10), closing = own + speed;
      motion_ = {.along = first + std::clamp(0.7 * seconds * closing, 25.0, 60.0) + random.uniform(-2, 2),
                 .along_speed = -own,
                 .left = kLaneWidthM + random.uniform(-0.2, 0.2),
                 .turn = kPi};
      break;
    }
    case Scenario::parked:
      motion_ = {.along = first + std::clamp(0.8 * traveled, kMinParkedM + 2, 30.0) + random.uniform(-2, 2),
                 .left = -random.uniform(2.9, 3.3)};
      break;
    case Scenario::crossing: {
      type_ = "pedestrian", size_ = {0.8, 0.6, 1.8};
      // In the middle of the lane at half the recording, or early enough to leave the lane before the drive arrives.
      const double ahead = std::clamp(0.9 * traveled, 12.0, 35.0) + random.uniform(-1, 1), walk = random.uniform(1.3, 1.5);
      const double arrival = ahead / std::max(speed, 0.1), middle = std::min(0.5 * seconds, arrival - 1.8);
      motion_ = {.along = first + ahead, .left = -walk * middle, .left_speed = walk, .turn = kPi / 2};
      break;
    }
    case Scenario::banner:
      break;
  }
}

void VirtualVehicle::avoid_obstacles(const Drive& drive, const Trajectory& world_from_lidar) {
  constexpr double kStepM = 0.25;
  constexpr int kMaxSteps = 60;
  const double drawn = motion_.along, nearest = road_->path_length_at(start_ns_) + kMinParkedM;
  std::vector<double> along{drawn};
  for (int step = 1; step <= kMaxSteps; ++step) {
    along.push_back(drawn + step * kStepM);
    if (drawn - step * kStepM >= nearest) along.push_back(drawn - step * kStepM);
  }
  const std::vector<std::size_t> returns = count_returns_inside(drive, world_from_lidar, {*road_, size_, along, motion_.left});
  const auto fewest = std::min_element(returns.begin(), returns.end());
  motion_.along = along[static_cast<std::size_t>(fewest - returns.begin())];
  avoidance_ = {motion_.along - drawn, *fewest};
}

Box VirtualVehicle::box_at(std::int64_t time_ns) const {
  const double seconds = 1e-9 * static_cast<double>(time_ns - start_ns_);
  const double sway = motion_.sway * std::sin(2 * kPi * seconds / kSwayPeriodS + motion_.phase);
  const double along =
      (motion_.follows ? road_->path_length_at(time_ns) : 0) + motion_.along + motion_.along_speed * seconds + sway;
  const SE3 world_from_road = road_->road_pose(along, motion_.left + motion_.left_speed * seconds, time_ns);
  return {world_from_road * SE3{so3_exp({0, 0, motion_.turn}), {0, 0, 0.5 * size_.z()}}, size_};
}

}  // namespace dvi::holdout
