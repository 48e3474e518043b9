#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "dvi/align/band_pass.h"
#include "dvi/drive/view.h"

namespace dvi::align {

/// A point on a surface of the map, world axes. The normal is zero where none is known.
struct SurfacePoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero(), normal = Eigen::Vector3f::Zero();
};

/// What two views are compared by: what both see of the map, taken where the moving one has texture.
struct Pair {
  std::size_t moving = 0, fixed = 0;
  std::shared_ptr<const std::vector<SurfacePoint>> points;  ///< of all pairs of the moving view
  std::vector<std::uint32_t> seen;                          ///< those that both see; every fourth is held out
};

/// A view as it is believed to be at this moment.
struct PosedImage {
  Camera camera;
  SE3 camera_from_world;
  std::shared_ptr<const BandPass> image;
};

/// What is refined of a view: its rotation (radians, camera axes) or, after it, its position too (meters, the same axes).
enum class Freedom { rotation = 3, pose = 6 };

/// The photometric cost of a pair as a quadratic of both views' corrections (moving, fixed), near the place where the moving
/// view fits best by its rotation.
struct PairModel {
  std::size_t moving = 0, fixed = 0;
  Eigen::MatrixXd H;  ///< twice as many rows and columns as a view has corrections
  Eigen::VectorXd g;  ///< gradient at corrections zero, the views as given to `fit_pair`
  double scale = 1;   ///< of the residuals
};

/// The best rotation of the moving view by Gauss-Newton from coarse to fine (levels `coarsest` to 0, Cauchy weights, scale from
/// the median residual), and the model there. `expected` is the size of a usual rotation, radians. Nothing where too few points
/// stay in both images.
std::optional<PairModel> fit_pair(const Pair& pair, const PosedImage& moving, const PosedImage& fixed, std::size_t coarsest,
                                  double expected, Freedom freedom = Freedom::rotation);

/// How well the held-out points of a pair agree.
struct HeldOutCost {
  double cost = 0;  ///< mean over the points, Cauchy
  int points = 0;
  std::vector<double> offsets_px;  ///< residual over slope, a point
};
HeldOutCost held_out(const Pair& pair, const PosedImage& moving, const PosedImage& fixed, double scale);

inline constexpr std::size_t kFewestPoints = 40;  ///< of a pair

}  // namespace dvi::align
