#include "dvi/synth/traffic.h"

#include <algorithm>
#include <cmath>

#include "dvi/synth/street_ground.h"

namespace dvi::synth {
namespace {

using Eigen::Vector2d;

double smooth_step(double from, double to, double x) {
  const double u = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

// Changes to the other lane in the first meters and back before the slower van there is reached, repeatedly.
double lane_change(double length) {
  const double phase = length - 112 * std::floor(length / 112);
  return smooth_step(2.4, 18, phase) - smooth_step(34, 50, phase);
}

}  // namespace

const Model& Mover::model(double time) const {
  if (!walks()) return models.front();
  const double walked = (place(time) - place(0)).norm(), strides = walked / kStrideM;
  return models[static_cast<std::size_t>((strides - std::floor(strides)) * kGaitPhases) % kGaitPhases];
}

SE3 Mover::world_from_mover(const Street& street, double time) const {
  constexpr double kStepS = 1e-3;
  const Vector2d here = place(time), motion = place(time + kStepS) - place(time - kStepS);
  return street.world_from_place(here.x(), here.y(), 0, std::atan2(motion.y(), motion.x()));
}

std::vector<Mover> make_traffic(const SynthOptions& options, const Course& course, const Noise& noise) {
  std::vector<Mover> movers;
  const std::uint64_t seed = static_cast<std::uint64_t>(options.seed) + 1000003ULL * options.day;
  const auto random = [&] { return make_random(seed, options.reverse ? 22 : 21, static_cast<std::int64_t>(movers.size())); };
  const auto add_all = [&](std::vector<Model> models, std::function<Vector2d(double)> place) {
    movers.push_back({static_cast<int>(movers.size()), std::move(models),
                      [course, place = std::move(place)](double t) { return course.place(place(t).x(), place(t).y()); }});
  };
  const auto add = [&](Model model, std::function<Vector2d(double)> place) { add_all({std::move(model)}, std::move(place)); };
  const double lane = course.lane(), other = course.other_lane(), shift = std::fmod(9.0 * (options.day - 1), 48.0);
  const double duration = options.frames / options.rate_hz;
  const auto path_length = [course](double time) { return course.path_length(time); };

  if (options.truck)
    add(make_truck(random(), noise), [=](double t) { return Vector2d(path_length(t) + 13.5, lane); });
  else
    add(make_car(random(), noise), [=](double t) {
      return Vector2d(path_length(t) + 0.05 * t + 16 + 2.5 * std::sin(0.5 * t),
                      lane + (other - lane) * lane_change(path_length(t)));
    });
  if (other != lane)
    add(make_van(random(), noise),
        [=](double t) { return Vector2d(46 - 0.2 * shift + 0.6 * path_length(t) + 0.1 * t, other); });
  for (int k = 0; 48.0 * k < 60 + (options.speed_mps + 9) * duration; ++k) {
    const double start = 43 + 48 * k + shift;
    Model model = k % 3 == 2 ? make_van(random(), noise) : make_car(random(), noise);
    add(std::move(model), [=](double t) { return Vector2d(start - 9 * t, 0.5 * kLaneWidthM); });
  }
  // People who cross in front of the recording car would be hidden by the truck.
  const double ahead = options.truck ? 36 : 9.5;
  for (int k = 0; crossing(k) < options.distance() + 80; ++k) {
    const double there = course.path_length_at(crossing(k)), when = (there - ahead) / std::max(options.speed_mps, 1.0),
                 crossing_length = course.path_length_at(crossing(k) + 1.2 + 0.6 * (k % 2));
    if (there < 0 || there >= path_length(duration) + 60) continue;
    add(make_pedestrian(random(), noise), [=](double t) { return Vector2d(crossing_length, lane - 1.5 * (t - when)); });
    if (!options.walker) continue;
    const double later = (there - 13) / std::max(options.speed_mps, 1.0), beside = course.path_length_at(crossing(k) + 3.2);
    add_all(make_walker(random(), noise), [=](double t) { return Vector2d(beside, lane + 1.3 * (t - later)); });
  }
  return movers;
}

}  // namespace dvi::synth
