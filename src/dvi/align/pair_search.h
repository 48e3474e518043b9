#pragma once

#include <optional>
#include <vector>

#include "dvi/align/align.h"

namespace dvi {

/// World points in the ring round a view's mask (in the whole image where there is none), evenly thinned.
using RingPoints = std::vector<Eigen::Vector3d>;

/// What comparing views needs of each, read lazily: blurred images and a coarse z-buffer for visibility.
class Comparison {
 public:
  Comparison(const Views& views, const StaticMap& map, const AlignOptions& options);

  Comparison(const Comparison&) = delete;
  Comparison& operator=(const Comparison&) = delete;

  struct Match {
    Eigen::Vector2d angle = Eigen::Vector2d::Zero();   ///< pitch, yaw to apply to `moving` to match `fixed`
    Eigen::Vector2d weight = Eigen::Vector2d::Zero();  ///< curvature of the energy times points: how well each is known
    double energy = 0;                                 ///< eq. 1 at angle zero, mean over points
    int points = 0;
  };
  /// Search of the moving view's pitch and yaw against the colours the fixed view gives its ring. Nothing where they share
  /// too few points. `corrections` are the rotations found so far.
  std::optional<Match> match(std::size_t moving, std::size_t fixed, const std::vector<Eigen::Vector2d>& corrections) const;

  /// The energy alone.
  std::optional<Match> energy(std::size_t moving, std::size_t fixed, const std::vector<Eigen::Vector2d>& corrections) const;

 private:
  struct Sample {
    Eigen::Vector3d in_camera;      ///< of the moving view
    std::vector<cv::Vec3f> colour;  ///< a level, as the fixed view has it
  };
  std::vector<Sample> samples(std::size_t moving, std::size_t fixed, const std::vector<Eigen::Vector2d>& corrections) const;
  double energy_at(const std::vector<Sample>& samples, std::size_t view, std::size_t level, const Eigen::Vector2d& angle) const;
  SE3 pose(std::size_t view, const std::vector<Eigen::Vector2d>& corrections) const;

  const Views& views_;
  const StaticMap& map_;
  const AlignOptions& options_;
  Lazy<std::vector<cv::Mat3b>> levels_;  ///< blurred images, coarsest first
  Lazy<cv::Mat1f> z_buffers_;            ///< at a quarter of the image's size
  Lazy<RingPoints> rings_;
};

}  // namespace dvi
