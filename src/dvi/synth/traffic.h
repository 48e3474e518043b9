#pragma once

#include <functional>
#include <vector>

#include "dvi/synth/course.h"
#include "dvi/synth/models.h"
#include "dvi/synth/synth_options.h"

namespace dvi::synth {

/// A moving object: its models and its position (s, d) at a time in seconds after the first frame. Walking people have one
/// model for each part of a stride, and a shadow from the sun; the ground under all others is dark.
struct Mover {
  int track = 0;
  std::vector<Model> models;
  std::function<Eigen::Vector2d(double)> place;

  bool walks() const { return models.size() > 1; }
  const Model& model(double time) const;
  SE3 world_from_mover(const Street& street, double time) const;
};

/// Makes the traffic of the drive: a vehicle ahead that changes lane if there are two (or a truck that stays ahead), a slower
/// van in the second lane, oncoming cars, and pedestrians who cross. All of them move all the time.
std::vector<Mover> make_traffic(const SynthOptions& options, const Course& course, const Noise& noise);

}  // namespace dvi::synth
