#pragma once

#include <vector>

#include "dvi/align/pair_model.h"

namespace dvi::align {

/// The corrections of the views of a sequence: camera_from_world = (exp(rotation), position) * given. Radians and meters, in
/// camera axes.
struct Corrections {
  std::vector<Eigen::Vector3d> rotations, positions;   ///< one per view
  Eigen::Vector3d mounting = Eigen::Vector3d::Zero();  ///< common part of the rotations

  explicit Corrections(std::size_t views = 0) : rotations(views, Eigen::Vector3d::Zero()), positions(rotations) {}
};

/// Standard deviations of the unknowns, in radians and meters.
struct Expected {
  double rotation = 0;  ///< of a view, in addition to the mounting
  double mounting = 0;  ///< constant over the drive
  double pair = 0;      ///< systematic error of a pair in the rotation between its views
  bool common = true;   ///< false: the corrections of all views sum to zero, and so does the mounting
  double position = 0;  ///< of a view; 0: positions are not refined, and the models have none
  double pair_m = 0;    ///< systematic error of a pair in the position
};

/// Solves for the corrections that fit all pairs best. The models were made at `now`; their views are numbered from 0. The
/// fixed view of a model may be an anchor, with a number after the views, which does not move.
Corrections solve_jointly(const std::vector<PairModel>& models, const Corrections& now, const Expected& expected);

}  // namespace dvi::align
