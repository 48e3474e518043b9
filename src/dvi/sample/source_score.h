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

/// A hole pixel with its surface, in the axes of the target's camera, in meters.
struct SurfacePixel {
  std::size_t pixel = 0;             ///< Index of the pixel in the hole.
  Eigen::Vector3d at, right, below;  ///< The points of the pixel and of its right and lower neighbor, on one plane.
  Eigen::Vector3d deeper;            ///< The point of the pixel if its depth is larger by one sigma.
  double sigma = 0;                  ///< Standard deviation of the depth.
  double depth_m = 0;                ///< The depth.
};

/// Lists the pixels of a hole whose depth is that of a surface.
std::vector<SurfacePixel> find_surface_pixels(const Region& hole, const Camera& camera, const depth::DepthMap& depth);

/// The projection of a pixel of the target into a source.
struct SourcePosition {
  Eigen::Vector2d position;  ///< Image coordinates, inside the source's image.
  double z = 0;              ///< Depth in the source, in meters.
};

/// Projects a pixel into a source. Returns nothing if the projection is outside the source's image.
std::optional<SourcePosition> locate(const SurfacePixel& pixel, const Camera& source, const SE3& source_from_target);

/// The area of a source that a pixel of the target covers.
struct SourceFootprint {
  double across = 1, down = 1;  ///< Extent in x and y, in source pixels.
  double smallest = 1;          ///< Extent in the direction in which it is smallest, in source pixels.
  double depth_error_px = 0;    ///< Displacement by an error of one sigma in depth, in pixels of the target.
};

/// Computes the footprint of a pixel. Returns nothing if an error of one sigma in depth places the point behind the source.
std::optional<SourceFootprint> measure_footprint(const SurfacePixel& pixel, const SourcePosition& place, const Camera& source,
                                                 const SE3& source_from_target);

/// Estimates the position error of a copy in pixels of the target (one sigma): from the error of the depth, and from errors of
/// the poses, which grow with the time between the frames.
double estimate_position_error_px(const SourceFootprint& footprint, double seconds);

/// Estimates the error of a copy in pixels of the target, sqrt(position_error^2 + blur^2). `blur` is the loss of detail of a
/// source that is farther away: half of the size, in target pixels, by which its pixels exceed one.
double estimate_copy_error_px(const SourceFootprint& footprint, double seconds);

/// Scores a source, 0..1: c / (c + 1) / (1 + error^2 / (0.3 px)^2), where the error is estimate_copy_error_px() and c is
/// `clearance_px` + 0.5. `clearance_px` is the distance to the source's mask, depth edges, and border, where colors are mixed.
double score_source(const SourceFootprint& footprint, double seconds, double clearance_px);

/// Returns the upper bound of the score of a source at a distance in time, for any clearance, or for a given one.
double max_score(double seconds);
double max_score(double seconds, double clearance_px);

/// Parameters of the score.
struct SourceScoreParams {
  double tolerance_px = 0.3;  ///< Error at which the score is halved. Smaller errors are below the blur of the camera itself.
  double drift_px = 0.3;      ///< Position error between frames one second apart. It grows with the square root of time.
  /// Time difference of frames of other drives, by which changes of illumination and of poses count.
  double other_drive_s = 10;
  double other_camera_s = 4;  ///< Time added for other cameras of a drive: their mounting, response, and sharpness differ.
  double max_sky_distance_m = 2000;  ///< Distance beyond which cameras do not show the same sky, nor share a heading.
};
inline constexpr SourceScoreParams kSourceScore;

}  // namespace dvi::sample
