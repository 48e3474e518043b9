#include "dvi/objects/cluster_returns.h"

#include <cmath>

#include "dvi/core/median.h"

namespace dvi::objects {
namespace {

constexpr double kStepsPerMeter = 65536;
constexpr std::int64_t kStepNs = 100;

std::int64_t to_steps(double meters) { return std::llround(kStepsPerMeter * meters); }
double to_meters(std::int64_t steps) { return static_cast<double>(steps) / kStepsPerMeter; }

}  // namespace

void ClusterReturns::push_back(const ClusterReturn& added) {
  const std::array<std::int64_t, 3> point{to_steps(added.point.x()), to_steps(added.point.y()), to_steps(added.point.z())};
  const std::int64_t time = added.time_ns / kStepNs;
  if (returns_.empty()) origin_ = point, origin_time_ = time;
  const auto offset = [](std::int64_t value, std::int64_t origin) { return static_cast<std::int32_t>(value - origin); };
  returns_.push_back({{offset(point[0], origin_[0]), offset(point[1], origin_[1]), offset(point[2], origin_[2])},
                      offset(to_steps(added.ground), origin_[2]),
                      offset(time, origin_time_),
                      static_cast<float>(added.ray_spacing_m)});
}

ClusterReturn ClusterReturns::operator[](std::size_t i) const {
  const Packed& packed = returns_[i];
  return {{to_meters(origin_[0] + packed.point[0]), to_meters(origin_[1] + packed.point[1]),
           to_meters(origin_[2] + packed.point[2])},
          kStepNs * (origin_time_ + packed.time),
          to_meters(origin_[2] + packed.ground),
          packed.ray_spacing_m};
}

double ClusterReturns::median_ground() const {
  std::vector<std::int32_t> values;
  values.reserve(size());
  for (const Packed& packed : returns_) values.push_back(packed.ground);
  return to_meters(origin_[2] + median(std::move(values)));
}

double ClusterReturns::median_ray_spacing_m() const {
  std::vector<float> values;
  values.reserve(size());
  for (const Packed& packed : returns_) values.push_back(packed.ray_spacing_m);
  return median(std::move(values));
}

}  // namespace dvi::objects
