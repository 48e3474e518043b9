#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "dvi/depth/depth_map.h"
#include "dvi/geometry/camera.h"
#include "dvi/geometry/se3.h"
#include "dvi/image/region.h"

namespace dvi::sample {

/// A hole pixel on its surface.
struct SurfacePixel {
  std::size_t pixel = 0;  ///< its number in the hole
  /// What it and, on the same plane, the next pixels to its right and below it show, in the axes of the target's camera.
  Eigen::Vector3d at, right, below;
  Eigen::Vector3d deeper;  ///< what it shows if its depth is one sigma more
  double sigma = 0;        ///< meters, of its depth
};

/// The hole's pixels that show a surface.
std::vector<SurfacePixel> surface_pixels(const Region& hole, const Camera& camera, const depth::DepthMap& depth);

/// Where a source sees a pixel of the target.
struct SourcePosition {
  Eigen::Vector2d position;  ///< within the source's image
  double z = 0;              ///< depth in the source
};

/// None where the source's image does not hold it.
std::optional<SourcePosition> locate(const SurfacePixel& pixel, const Camera& source, const SE3& source_from_target);

/// How it sees it there.
struct SourceFootprint {
  double across = 1, down = 1;  ///< source pixels that the pixel spans in x and y
  double smallest = 1;          ///< and in the direction in which it spans least
  double misplaced = 0;         ///< px of the target by which an error of one sigma in depth moves it
};

/// None where an error of one sigma takes the pixel behind the source.
std::optional<SourceFootprint> sight(const SurfacePixel& pixel, const SourcePosition& place, const Camera& source,
                                     const SE3& source_from_target);

/// By how many pixels of the target a copy may be off, one sigma: by its depth, and by what is left of errors of the poses,
/// which grows with the time between the frames.
double expected_shift(const SourceFootprint& sighting, double seconds);

/// By how many it may be off or blurred, sqrt(shift^2 + blur^2). `blur` is the detail lost by a source that is farther away, as
/// half of what its pixel exceeds one of the target.
double expected_error(const SourceFootprint& sighting, double seconds);

/// 0..1, how good a source is: c / (c + 1) / (1 + error^2 / (0.3 px)^2). `c` is the middle of a pixel that is `clear_px` pixels
/// away from the source's own mask, depth edges and border: near them colors are blends.
double trust(const SourceFootprint& sighting, double seconds, double clear_px);

/// The most that any source so far away in time can be trusted, anywhere or where it is so clear.
double most_trust(double seconds);
double most_trust(double seconds, double clear_px);

/// Frames of other drives are taken to be so far away: another light, and poses that were registered to each other.
inline constexpr double kSecondsElsewhere = 10;
/// Those of another camera of the drive, besides the time between them: its mounting, response and sharpness are not the
/// target's.
inline constexpr double kSecondsOfRig = 4;

}  // namespace dvi::sample
