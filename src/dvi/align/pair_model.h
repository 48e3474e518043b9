#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "dvi/align/band_pass.h"
#include "dvi/drive/view.h"

namespace dvi::align {

/// A point on a surface of the map, in the world. The normal is zero if it is unknown.
struct SurfacePoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero(), normal = Eigen::Vector3f::Zero();
};

/// Two views and the map points by which they are compared: visible in both, with texture in the moving view.
struct Pair {
  std::size_t moving = 0, fixed = 0;
  std::shared_ptr<const std::vector<SurfacePoint>> points;  ///< shared by all pairs of the moving view
  std::vector<std::uint32_t> visible;                       ///< points visible in both views; every fourth is held out
};

/// A view with its current pose.
struct PosedImage {
  Camera camera;
  SE3 camera_from_world;
  std::shared_ptr<const BandPass> image;
};

/// A pair with the images and current poses of its views. It holds references only, and is constructed for one call.
struct PosedPair {
  const Pair& pair;
  const PosedImage& moving;
  const PosedImage& fixed;
};

/// The corrections of a view: rotation (radians, camera axes), or rotation and position (meters, camera axes).
enum class Freedom { rotation = 3, pose = 6 };

/// The photometric cost of a pair as a quadratic function of the corrections of both views (moving, fixed), near the best
/// rotation of the moving view.
struct PairModel {
  std::size_t moving = 0, fixed = 0;
  Eigen::MatrixXd H;  ///< square, with the corrections of both views
  Eigen::VectorXd g;  ///< gradient at zero corrections, for the poses given to `fit_pair`
  double scale = 1;   ///< of the residuals
};

/// Finds the best rotation of the moving view by Gauss-Newton from coarse to fine (levels `coarsest` to 0, Cauchy weights,
/// scale from the median residual) and returns the model there. `expected` is the standard deviation of the rotation in
/// radians. Returns nothing if too few points are in both images.
std::optional<PairModel> fit_pair(const PosedPair& pair, std::size_t coarsest, double expected,
                                  Freedom freedom = Freedom::rotation);

/// The agreement of the held-out points of a pair.
struct HeldOutCost {
  double cost = 0;  ///< mean Cauchy loss of the points
  int points = 0;
  std::vector<double> offsets_px;  ///< residual over slope, per point
};
HeldOutCost evaluate_held_out(const PosedPair& pair, double scale);

inline constexpr std::size_t kMinPairPoints = 40;

}  // namespace dvi::align
