#include "dvi/scan_match/features.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "dvi/scan_match/voxel_key.h"

namespace dvi::scan_match {
namespace {

// The thresholds of edges and planes.
struct FeatureParams {
  std::size_t neighbors = 5;     // on either side
  float min_range_jump = 0.03F;  // fraction of the range, between two objects along a beam
  float max_smooth_m = 0.03F;    // distance from the chord up to which a beam is smooth
  float min_corner_m = 0.12F;    // distance from the chord from which on it has a corner
  float max_pole_m = 0.4F;       // width of the widest pole
};
constexpr FeatureParams kFeatureParams;

// One beam with the ends of its continuous runs.
class Beam {
 public:
  Beam(const Scan& scan, const std::vector<std::uint32_t>& order, const FeatureOptions& options)
      : scan_(scan), options_(options) {
    for (const std::uint32_t i : order) {
      const float range = scan.points[i].norm();
      if (range < options.min_range_m || range > options.max_range_m) continue;
      index_.push_back(i);
      range_.push_back(range);
    }
  }

  void find(Features& out) const {
    for (std::size_t first = 0, last; first < index_.size(); first = last) {
      last = first + 1;
      while (last < index_.size() && !breaks_after(last - 1)) ++last;
      run(first, last, out);
    }
  }

 private:
  const Eigen::Vector3f& at(std::size_t k) const { return scan_.points[index_[k]]; }
  Feature feature(std::size_t k) const { return {at(k), scan_.time[index_[k]]}; }

  bool breaks_after(std::size_t k) const {
    const float step = std::max(0.15F, kFeatureParams.min_range_jump * range_[k]);
    return (at(k + 1) - at(k)).squaredNorm() > step * step;
  }

  // Finds the features of the run [first, last) without a jump.
  void run(std::size_t first, std::size_t last, Features& out) const {
    if (stands_free(first, last)) out.edges.push_back(feature((first + last) / 2));
    if (last - first < 2 * kFeatureParams.neighbors + 1) return;
    Eigen::Vector3f before = Eigen::Vector3f::Zero(), after = Eigen::Vector3f::Zero();
    for (std::size_t k = 0; k < kFeatureParams.neighbors; ++k)
      before += at(first + k), after += at(first + kFeatureParams.neighbors + 1 + k);
    const float apart2 = static_cast<float>(options_.spacing_m * options_.spacing_m);
    Eigen::Vector3f taken = Eigen::Vector3f::Constant(1e9F);
    float sharpest = 0;
    std::size_t corner = 0;
    for (std::size_t k = first + kFeatureParams.neighbors;; ++k) {
      const Eigen::Vector3f a = before / kFeatureParams.neighbors, chord = after / kFeatureParams.neighbors - a,
                            from_a = at(k) - a;
      const float off = from_a.cross(chord).norm() / std::max(chord.norm(), 1e-6F);
      if (off < kFeatureParams.max_smooth_m) {
        if ((at(k) - taken).squaredNorm() > apart2) out.planes.push_back(feature(k)), taken = at(k);
      } else if (off > kFeatureParams.min_corner_m && off > 0.25F * chord.norm() && off > sharpest) {
        sharpest = off, corner = k;
      }
      if (sharpest > 0 && k >= corner + kFeatureParams.neighbors) out.edges.push_back(feature(corner)), sharpest = 0;
      if (k + kFeatureParams.neighbors + 1 >= last) break;
      before += at(k) - at(k - kFeatureParams.neighbors);
      after += at(k + kFeatureParams.neighbors + 1) - at(k + 1);
    }
  }

  // Returns whether a short run is in front of the surfaces on either side of it.
  bool stands_free(std::size_t first, std::size_t last) const {
    if (first == 0 || last >= index_.size() || last - first < 3) return false;
    const float width = (at(last - 1) - at(first)).norm();
    const float near = range_[(first + last) / 2];
    return width < kFeatureParams.max_pole_m && range_[first - 1] > near + 0.5F && range_[last] > near + 0.5F;
  }

  const Scan& scan_;
  const FeatureOptions& options_;
  std::vector<std::uint32_t> index_;
  std::vector<float> range_;
};

}  // namespace

Features find_features(const Scan& scan, const Rings& rings, const FeatureOptions& options) {
  Features out;
  for (const auto& ring : rings.points) Beam(scan, ring, options).find(out);
  if (rings.source == Rings::Source::none) {
    for (std::size_t i = 0; i < scan.size(); ++i) {
      const float range = scan.points[i].norm();
      if (range >= options.min_range_m && range <= options.max_range_m) out.planes.push_back({scan.points[i], scan.time[i]});
    }
    out.planes = thin_features(out.planes, options.spacing_m);
  }
  return out;
}

std::vector<Feature> thin_features(const std::vector<Feature>& features, double cell_m) {
  std::vector<Feature> out;
  std::unordered_set<VoxelKey, VoxelHash> taken;
  taken.reserve(features.size());
  for (const Feature& f : features)
    if (taken.insert(voxel_key(f.point.cast<double>(), cell_m)).second) out.push_back(f);
  return out;
}

}  // namespace dvi::scan_match
