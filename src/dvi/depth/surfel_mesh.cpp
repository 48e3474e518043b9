#include "dvi/depth/surfel_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>

#include "dvi/depth/delaunay.h"
#include "dvi/map/visible_points.h"

namespace dvi::depth {
namespace {

/// Parameters of the surfaces of surfels.
struct SurfelParams {
  float noise_m = 0.06F;           ///< Three times the range noise of a LiDAR.
  float max_bend = 0.1F;           ///< Offset from a surfel's plane, per meter of distance, within which a surface is the same.
  float normal_error = 0.03F;      ///< Offset from a plane, per meter of distance, due to errors of normals: 2 degrees.
  float max_offset_m = 0.25F;      ///< Offset from a surfel's plane beyond which a surface is another, at any distance.
  float min_bend_cosine = 0.95F;   ///< Planes at smaller angles, 18 degrees, are one curved surface without a crease.
  float min_ground_cosine = 0.9F;  ///< Normals nearer to the vertical are ground: it is steep in depth without being an edge.
  float min_view_cosine = 0.005F;  ///< Planes at grazing angles below a third of a degree have no usable slope.
  float max_spacing_ratio = 2;     ///< Displacements longer than this many medians cross an area that was not scanned.
  int smoothing_rounds = 8;        ///< Rounds of averaging normals, each of which adds about one return at each side.
};
constexpr SurfelParams kSurfel;

/// Returns the normal of the vertical plane that faces the view, which is assumed for isolated returns, as of a trunk or a
/// twig.
Eigen::Vector3f normal_toward(const Eigen::Vector3f& to_view) {
  const Eigen::Vector3f level(to_view.x(), to_view.y(), 0);
  return level.squaredNorm() > 0 ? level.normalized() : to_view.normalized();
}

void set_slope(Surfel& s, const View& view) {
  const Eigen::Vector3d n = view.camera_from_world.R * s.normal.cast<double>();
  const Eigen::Vector3d ray = view.camera.ray({s.u, s.v});
  const double offset = n.dot(ray) / s.inverse;
  s.cosine = std::max(kSurfel.min_view_cosine, static_cast<float>(std::abs(n.dot(ray)) / ray.norm()));
  if (s.cosine == kSurfel.min_view_cosine) return;
  s.slope_u = static_cast<float>(n.dot(view.camera.ray({s.u + 1, s.v}) - ray) / offset);
  s.slope_v = static_cast<float>(n.dot(view.camera.ray({s.u, s.v + 1}) - ray) / offset);
}

Surfel make_surfel(const map::VisiblePoint& p, const map::StaticMap& map) {
  Surfel s;
  s.u = p.u;
  s.v = p.v;
  s.inverse = 1 / p.z;
  s.world = p.world;
  s.normal = map.points[p.index].normal;
  s.has_normal = !s.normal.isZero();
  return s;
}

/// Calls `visit(i, j)` once for each inner edge of the mesh: its two triangles have it in opposite order. Of the edges of the
/// hull, those with i < j are visited.
template <class Visit>
void for_each_edge(const SurfelMesh& mesh, const Visit& visit) {
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k)
      if (t[k] < t[(k + 1) % 3]) visit(t[k], t[(k + 1) % 3]);
}

/// Returns the offset in meters from a surfel's plane within which a point at a distance belongs to the same surface.
float max_offset(float distance_m) { return std::min(kSurfel.noise_m + kSurfel.max_bend * distance_m, kSurfel.max_offset_m); }

/// The triangles around each surfel: those of surfel i are triangles[first[i]] to triangles[first[i + 1] - 1].
struct Fans {
  explicit Fans(const SurfelMesh& mesh) : first(mesh.surfels.size() + 1, 0), triangles(3 * mesh.triangles.size()) {
    for (const auto& t : mesh.triangles)
      for (const std::size_t k : t) ++first[k + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      for (const std::size_t k : mesh.triangles[i]) triangles[next[k]++] = i;
  }
  std::vector<std::size_t> first, triangles;
};

/// Estimates normals of surfels for which the map has none, because returns are sparse.
class NormalEstimator {
 public:
  /// `max_slope` is the largest slope of planes that are not ground (SurfelMeshOptions).
  NormalEstimator(const SurfelMesh& mesh, const View& view, float max_slope)
      : mesh_(mesh), fans_(mesh), center_(camera_center(view)), max_slope_(max_slope) {}

  /// Selects, among the planes of the triangles around a surfel and of its neighbors, the one that most neighbors lie on.
  /// Returns zero if no plane has a majority.
  Eigen::Vector3f estimate(std::size_t surfel) {
    find_neighbors(surfel);
    sight_ = (center_ - mesh_.surfels[surfel].world).normalized();
    best_ = Eigen::Vector3f::Zero();
    max_sum_ = 0;
    for (std::size_t k = 0; k + 1 < around_.size(); k += 2) {
      const Eigen::Vector3f normal = around_[k].displacement.cross(around_[k + 1].displacement);
      if (normal.squaredNorm() > 0) vote(normal.normalized());
    }
    for (const Neighbor& neighbor : around_)
      if (neighbor.surfel->has_normal) vote(neighbor.surfel->normal);
    return best_;
  }

 private:
  struct Neighbor {
    const Surfel* surfel;
    Eigen::Vector3f displacement;  ///< In world axes, in meters.
    float tolerance;               ///< Offset from a plane in meters within which the neighbor lies on it.
    float weight;                  ///< Distant neighbors are more often of another surface.
  };

  /// Lists the neighbors, each of them once per shared triangle.
  void find_neighbors(std::size_t surfel) {
    around_.clear();
    total_weight_ = 0;
    for (std::size_t f = fans_.first[surfel]; f < fans_.first[surfel + 1]; ++f)
      for (const std::size_t k : mesh_.triangles[fans_.triangles[f]]) {
        if (k == surfel) continue;
        const Eigen::Vector3f displacement = mesh_.surfels[k].world - mesh_.surfels[surfel].world;
        const float distance = displacement.norm();
        around_.push_back({&mesh_.surfels[k], displacement,
                           std::min(kSurfel.noise_m + kSurfel.normal_error * distance, kSurfel.max_offset_m),
                           1 / (1 + distance)});
        total_weight_ += around_.back().weight;
      }
  }

  void vote(const Eigen::Vector3f& normal) {
    if (std::abs(normal.dot(sight_)) * max_slope_ < 1 && std::abs(normal.z()) < kSurfel.min_ground_cosine) return;
    float on = 0, sum = 0;
    for (const Neighbor& neighbor : around_) {
      const float off = std::abs(normal.dot(neighbor.displacement)) / neighbor.tolerance;
      on += off < 1 ? neighbor.weight : 0;
      sum += neighbor.weight * std::max(0.0F, 1 - off);
    }
    if (2 * on <= total_weight_ || sum <= max_sum_) return;
    max_sum_ = sum;
    best_ = normal;
  }

  const SurfelMesh& mesh_;
  const Fans fans_;
  Eigen::Vector3f center_;
  float max_slope_;
  std::vector<Neighbor> around_;  // this and the following are of the surfel that is estimated
  float total_weight_ = 0, max_sum_ = 0;
  Eigen::Vector3f sight_, best_;
};

void set_normals(SurfelMesh& mesh, const View& view, float max_slope) {
  const Eigen::Vector3f center = camera_center(view);
  NormalEstimator estimator(mesh, view, max_slope);
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < mesh.surfels.size(); ++i)
    if (!mesh.surfels[i].has_normal) missing.push_back(i);
  std::vector<Eigen::Vector3f> found(missing.size());
  for (std::size_t b = 0; b < missing.size(); ++b) found[b] = estimator.estimate(missing[b]);
  for (std::size_t b = 0; b < missing.size(); ++b) {
    Surfel& s = mesh.surfels[missing[b]];
    s.has_normal = !found[b].isZero();
    s.normal = s.has_normal ? found[b] : normal_toward(center - s.world);
  }
  // The ground is observed from above. At grazing angles, noise would decide which of its sides faces the view.
  for (Surfel& s : mesh.surfels)
    if (s.is_ground() ? s.normal.z() < 0 : s.normal.dot(center - s.world) < 0) s.normal *= -1;
}

/// A normal with an unused fourth component of 0, so that it is added by one instruction.
using PaddedNormal = Eigen::Vector4f;

/// Two neighboring surfels with normals. It stores the terms of classify_joint() that do not depend on the normals.
struct Link {
  std::uint32_t a, b;
  Eigen::Vector3f b_from_a;
  float max_offset_m;

  bool is_one_surface(const PaddedNormal& normal_a, const PaddedNormal& normal_b) const {
    const float b_before_a = normal_a.head<3>().dot(b_from_a), a_before_b = -normal_b.head<3>().dot(b_from_a);
    return (std::abs(b_before_a) < max_offset_m && std::abs(a_before_b) < max_offset_m) ||
           (b_before_a * a_before_b > 0 && normal_a.head<3>().dot(normal_b.head<3>()) > kSurfel.min_bend_cosine);
  }
};

/// Averages normals within surfaces, because normals that are estimated from a few returns are wrong by degrees.
void smooth_normals(SurfelMesh& mesh) {
  std::vector<Link> links;
  links.reserve(2 * mesh.triangles.size());
  for_each_edge(mesh, [&](std::size_t i, std::size_t j) {
    const Surfel &a = mesh.surfels[i], &b = mesh.surfels[j];
    if (!a.has_normal || !b.has_normal) return;
    const Eigen::Vector3f b_from_a = b.world - a.world;
    links.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j), b_from_a, max_offset(b_from_a.norm())});
  });
  std::vector<PaddedNormal> normal, sum;
  normal.reserve(mesh.surfels.size());
  for (const Surfel& s : mesh.surfels) normal.emplace_back(s.normal.x(), s.normal.y(), s.normal.z(), 0.0F);
  for (int round = 0; round < kSurfel.smoothing_rounds; ++round) {
    sum = normal;
    for (const Link& link : links) {
      if (!link.is_one_surface(normal[link.a], normal[link.b])) continue;
      sum[link.a] += normal[link.b];
      sum[link.b] += normal[link.a];
    }
    for (std::size_t i = 0; i < sum.size(); ++i) normal[i].head<3>() = sum[i].head<3>().normalized();
  }
  for (std::size_t i = 0; i < normal.size(); ++i) mesh.surfels[i].normal = normal[i].head<3>();
}

/// Computes the mean of d d^T over the displacements d that are not much longer than their median. `lengths` is a buffer.
Eigen::Matrix2f compute_scatter(std::span<const Eigen::Vector2f> displacements, std::vector<float>& lengths) {
  lengths.clear();
  for (const Eigen::Vector2f& d : displacements) lengths.push_back(d.norm());
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  const float max_length = kSurfel.max_spacing_ratio * *middle;
  Eigen::Matrix2f sum = Eigen::Matrix2f::Zero();
  float count = 0;
  for (const Eigen::Vector2f& d : displacements) {
    if (d.norm() > max_length) continue;
    sum += d * d.transpose();
    ++count;
  }
  return sum / count;
}

/// Measures the spacing of returns on each surface, which bounds how far the surface extends beyond its last return. It depends
/// on the direction, because the rings of a LiDAR are much farther apart than the returns of a ring.
void set_scatter(SurfelMesh& mesh) {
  std::vector<std::array<std::size_t, 2>> same;
  same.reserve(2 * mesh.triangles.size());
  std::vector<std::size_t> first(mesh.surfels.size() + 1, 0);  // index of the first displacement of each surfel
  for_each_edge(mesh, [&](std::size_t i, std::size_t j) {
    if (classify_joint(mesh.surfels[i], mesh.surfels[j]) != Joint::same) return;
    same.push_back({i, j});
    ++first[i + 1];
    ++first[j + 1];
  });
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<Eigen::Vector2f> displacements(2 * same.size());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (const auto& [i, j] : same) {
    const Surfel &a = mesh.surfels[i], &b = mesh.surfels[j];
    displacements[next[i]++] = displacements[next[j]++] = {a.u - b.u, a.v - b.v};
  }
  std::vector<float> lengths;
  for (std::size_t i = 0; i < mesh.surfels.size(); ++i)
    if (const std::size_t count = first[i + 1] - first[i]; count > 0)
      mesh.surfels[i].scatter = compute_scatter({&displacements[first[i]], count}, lengths);
}

}  // namespace

Joint classify_joint(const Surfel& a, const Surfel& b) {
  const Eigen::Vector3f b_from_a = b.world - a.world;
  const float distance = b_from_a.norm(), tolerance = max_offset(distance);
  const float b_before_a = a.normal.dot(b_from_a), a_before_b = -b.normal.dot(b_from_a);
  const bool on_a = std::abs(b_before_a) < tolerance, on_b = std::abs(a_before_b) < tolerance;
  if (a.has_normal == b.has_normal ? on_a && on_b : (a.has_normal ? on_a : on_b)) return Joint::same;
  if (b_before_a * a_before_b > 0 && a.normal.dot(b.normal) > kSurfel.min_bend_cosine) return Joint::same;
  const float tilt = kSurfel.normal_error * distance;
  if (b_before_a > -tilt && a_before_b > -tilt) return Joint::concave;
  if (b_before_a < tilt && a_before_b < tilt && a.has_normal && b.has_normal) return Joint::convex;
  return Joint::step;
}

SurfelMesh make_surfel_mesh(const map::StaticMap& map, const View& view, const SurfelMeshOptions& options) {
  const std::vector<map::VisiblePoint> points =
      map::find_visible_points(map, view, options.splat_m, options.occlusion_tolerance);
  SurfelMesh mesh;
  mesh.surfels.reserve(points.size());
  for (const map::VisiblePoint& p : points) mesh.surfels.push_back(make_surfel(p, map));
  triangulate(points, [&](const std::array<std::size_t, 3>& corners) { mesh.triangles.push_back(corners); });
  set_normals(mesh, view, static_cast<float>(options.max_slope));
  smooth_normals(mesh);
  for (Surfel& s : mesh.surfels) set_slope(s, view);
  set_scatter(mesh);
  return mesh;
}

}  // namespace dvi::depth
