#pragma once

#include <vector>

#include "dvi/align/pair_model.h"

namespace dvi::align {

/// Corrections of a drive's views: camera_from_world = (exp(rotation), position) * given. Radians and meters, in the camera's
/// axes.
struct Corrections {
  std::vector<Eigen::Vector3d> rotations, positions;   ///< a view
  Eigen::Vector3d mounting = Eigen::Vector3d::Zero();  ///< what the rotations have in common

  explicit Corrections(std::size_t views = 0) : rotations(views, Eigen::Vector3d::Zero()), positions(rotations) {}
};

/// Expected sizes (standard deviations, radians and meters) of what is sought.
struct Expected {
  double rotation = 0;  ///< of a view, beside the mounting
  double mounting = 0;  ///< constant over the drive
  double pair = 0;      ///< by how much a pair may mislead about the rotation between its views
  bool common = true;   ///< false: the corrections of all views add up to none, and the mounting is none
  double position = 0;  ///< of a view; 0: positions are right, and the models have none
  double pair_m = 0;    ///< as `pair`, about the position
};

/// The corrections that fit all pairs best. `now` is where the models were made; their views are numbered from 0. The fixed
/// view of a model may be an anchor, numbered behind them: it stays where it is.
Corrections solve(const std::vector<PairModel>& models, const Corrections& now, const Expected& expected);

}  // namespace dvi::align
