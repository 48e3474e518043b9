#include "dvi/depth/surfel_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "dvi/depth/delaunay.h"
#include "dvi/map/visible_points.h"

namespace dvi::depth {
namespace {

constexpr float kSurfelNoise = 0.06F;   // meters: three times the range noise of a LiDAR
constexpr float kBend = 0.1F;           // how far one surface may leave a plane of a point of it, a meter of way
constexpr float kTilt = 0.03F;          // the same for what normals are off by: 2 degrees
constexpr float kApart = 0.25F;         // meters: no surface is so uneven, however long the way
constexpr float kAlike = 0.95F;         // cosine: planes at less than 18 degrees do not make a crease but a bend
constexpr float kGroundLike = 0.9F;     // cosine to up: grazing ground is steep in depth without being an edge
constexpr float kLeastCosine = 0.005F;  // planes seen at less than a third of a degree have no slope to go by
constexpr float kLong = 2;              // times the median way to neighbors: nothing was scanned in between
constexpr int kRounds = 8;              // of averaging normals: some eight returns to either side

// The upright plane that faces the view: what is known of a trunk or a twig.
Eigen::Vector3f facing(const Eigen::Vector3f& to_view) {
  const Eigen::Vector3f level(to_view.x(), to_view.y(), 0);
  return level.squaredNorm() > 0 ? level.normalized() : to_view.normalized();
}

void set_slope(Surfel& s, const View& view) {
  const Eigen::Vector3d n = view.camera_from_world.R * s.normal.cast<double>();
  const Eigen::Vector3d ray = view.camera.ray({s.u, s.v});
  const double offset = n.dot(ray) / s.inverse;
  s.cosine = std::max(kLeastCosine, static_cast<float>(std::abs(n.dot(ray)) / ray.norm()));
  if (s.cosine == kLeastCosine) return;  // seen edge-on
  s.slope_u = static_cast<float>(n.dot(view.camera.ray({s.u + 1, s.v}) - ray) / offset);
  s.slope_v = static_cast<float>(n.dot(view.camera.ray({s.u, s.v + 1}) - ray) / offset);
}

Surfel surfel(const map::VisiblePoint& p, const map::StaticMap& map) {
  Surfel s;
  s.u = p.u;
  s.v = p.v;
  s.inverse = 1 / p.z;
  s.world = p.world;
  s.normal = map.points[p.index].normal;
  s.flat = !s.normal.isZero();
  return s;
}

template <class Edge>
void for_edges(const SurfelMesh& mesh, const Edge& edge) {
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k)
      if (t[k] < t[(k + 1) % 3]) edge(t[k], t[(k + 1) % 3]);
}

// How far one surface may leave a plane of a point of it.
float allowed_off(float way) { return std::min(kSurfelNoise + kBend * way, kApart); }

// The triangles round each surfel: those of surfel i are [first[i], first[i + 1]).
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

// Where returns are too sparse for the map to tell their surface: the plane of a triangle round a surfel, or that of a
// neighbor, which most of its neighbors lie on. Planes that leave the view more steeply than `max_slope` are none, but the
// ground is.
Eigen::Vector3f plane_of_neighbors(const SurfelMesh& mesh, const Fans& fans, std::size_t i, const Eigen::Vector3f& to_view,
                                   float max_slope, std::vector<std::size_t>& round) {
  const Eigen::Vector3f& at = mesh.surfels[i].world;
  const Eigen::Vector3f sight = to_view.normalized();
  round.clear();
  for (std::size_t f = fans.first[i]; f < fans.first[i + 1]; ++f)
    for (const std::size_t k : mesh.triangles[fans.triangles[f]])
      if (k != i) round.push_back(k);
  Eigen::Vector3f best = Eigen::Vector3f::Zero();
  float most = 0;
  const auto vote = [&](const Eigen::Vector3f& normal) {
    if (std::abs(normal.dot(sight)) * max_slope < 1 && std::abs(normal.z()) < kGroundLike) return;
    float on = 0, all = 0, sum = 0;  // a neighbor counts once for either triangle it shares
    for (const std::size_t k : round) {
      const Eigen::Vector3f way = mesh.surfels[k].world - at;
      const float off = std::abs(normal.dot(way)) / std::min(kSurfelNoise + kTilt * way.norm(), kApart);
      const float weight = 1 / (1 + way.norm());  // what is meters away may well be another surface
      all += weight;
      on += off < 1 ? weight : 0;
      sum += weight * std::max(0.0F, 1 - off);
    }
    if (2 * on <= all || sum <= most) return;
    most = sum;
    best = normal;
  };
  for (std::size_t k = 0; k + 1 < round.size(); k += 2) {
    const Eigen::Vector3f normal = (mesh.surfels[round[k]].world - at).cross(mesh.surfels[round[k + 1]].world - at);
    if (normal.squaredNorm() > 0) vote(normal.normalized());
  }
  for (const std::size_t k : round)
    if (mesh.surfels[k].flat) vote(mesh.surfels[k].normal);
  return best;
}

void set_planes(SurfelMesh& mesh, const View& view, float max_slope) {
  const Eigen::Vector3f eye = eye_of(view);
  const Fans fans(mesh);
  std::vector<std::size_t> bare;
  for (std::size_t i = 0; i < mesh.surfels.size(); ++i)
    if (!mesh.surfels[i].flat) bare.push_back(i);
  std::vector<Eigen::Vector3f> found(bare.size());
  std::vector<std::size_t> round;
  for (std::size_t b = 0; b < bare.size(); ++b)
    found[b] = plane_of_neighbors(mesh, fans, bare[b], eye - mesh.surfels[bare[b]].world, max_slope, round);
  for (std::size_t b = 0; b < bare.size(); ++b) {
    Surfel& s = mesh.surfels[bare[b]];
    s.flat = !found[b].isZero();
    s.normal = s.flat ? found[b] : facing(eye - s.world);
  }
  // The ground is seen from above, however grazing: there the side toward the view is a matter of noise.
  for (Surfel& s : mesh.surfels)
    if (s.is_ground() ? s.normal.z() < 0 : s.normal.dot(eye - s.world) < 0) s.normal *= -1;
}

/// What joint() asks of two surfels that both know their planes, with what does not change when the planes turn.
struct Link {
  std::size_t a, b;
  Eigen::Vector3f way;
  float allowed;

  bool same(const Eigen::Vector3f& normal_a, const Eigen::Vector3f& normal_b) const {
    const float b_before_a = normal_a.dot(way), a_before_b = -normal_b.dot(way);
    return (std::abs(b_before_a) < allowed && std::abs(a_before_b) < allowed) ||
           (b_before_a * a_before_b > 0 && normal_a.dot(normal_b) > kAlike);
  }
};

// Normals of a few returns are off by degrees; those of one surface agree.
void smooth_normals(SurfelMesh& mesh) {
  std::vector<Link> links;
  links.reserve(2 * mesh.triangles.size());
  for_edges(mesh, [&](std::size_t i, std::size_t j) {
    const Surfel &a = mesh.surfels[i], &b = mesh.surfels[j];
    if (!a.flat || !b.flat) return;
    const Eigen::Vector3f way = b.world - a.world;
    links.push_back({i, j, way, allowed_off(way.norm())});
  });
  std::vector<Eigen::Vector3f> normal(mesh.surfels.size()), sum;
  for (std::size_t i = 0; i < normal.size(); ++i) normal[i] = mesh.surfels[i].normal;
  for (int round = 0; round < kRounds; ++round) {
    sum = normal;
    for (const Link& link : links) {
      if (!link.same(normal[link.a], normal[link.b])) continue;
      sum[link.a] += normal[link.b];
      sum[link.b] += normal[link.a];
    }
    for (std::size_t i = 0; i < sum.size(); ++i) normal[i] = sum[i].normalized();
  }
  for (std::size_t i = 0; i < normal.size(); ++i) mesh.surfels[i].normal = normal[i];
}

// The mean of w w^T over the ways that are no longer than usual.
Eigen::Matrix2f mean_square(const Eigen::Vector2f* first, const Eigen::Vector2f* last, std::vector<float>& lengths) {
  lengths.clear();
  for (const Eigen::Vector2f* way = first; way != last; ++way) lengths.push_back(way->norm());
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  const float most = kLong * *middle;
  Eigen::Matrix2f sum = Eigen::Matrix2f::Zero();
  float count = 0;
  for (const Eigen::Vector2f* way = first; way != last; ++way) {
    if (way->norm() > most) continue;
    sum += *way * way->transpose();
    ++count;
  }
  return sum / count;
}

// What lies between returns of one surface tells how far it may reach beyond its last one. Rings are much farther apart than
// their returns, so it depends on the direction. Ways across what was not scanned tell nothing.
void set_ways(SurfelMesh& mesh) {
  std::vector<std::array<std::size_t, 2>> same;
  same.reserve(2 * mesh.triangles.size());
  std::vector<std::size_t> first(mesh.surfels.size() + 1, 0);  // the ways of surfel i are [first[i], first[i + 1])
  for_edges(mesh, [&](std::size_t i, std::size_t j) {
    if (joint(mesh.surfels[i], mesh.surfels[j]) != Joint::same) return;
    same.push_back({i, j});
    ++first[i + 1];
    ++first[j + 1];
  });
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<Eigen::Vector2f> ways(2 * same.size());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (const auto& [i, j] : same) {
    const Surfel &a = mesh.surfels[i], &b = mesh.surfels[j];
    ways[next[i]++] = ways[next[j]++] = {a.u - b.u, a.v - b.v};
  }
  std::vector<float> lengths;
  for (std::size_t i = 0; i < mesh.surfels.size(); ++i)
    if (first[i] < first[i + 1]) mesh.surfels[i].ways = mean_square(&ways[first[i]], ways.data() + first[i + 1], lengths);
}

}  // namespace

Joint joint(const Surfel& a, const Surfel& b) {
  const Eigen::Vector3f way = b.world - a.world;
  const float length = way.norm(), allowed = allowed_off(length);
  const float b_before_a = a.normal.dot(way), a_before_b = -b.normal.dot(way);
  const bool on_a = std::abs(b_before_a) < allowed, on_b = std::abs(a_before_b) < allowed;
  if (a.flat == b.flat ? on_a && on_b : (a.flat ? on_a : on_b)) return Joint::same;
  if (b_before_a * a_before_b > 0 && a.normal.dot(b.normal) > kAlike) return Joint::same;  // bends
  const float tilt = kTilt * length;
  if (b_before_a > -tilt && a_before_b > -tilt) return Joint::concave;
  if (b_before_a < tilt && a_before_b < tilt && a.flat && b.flat) return Joint::convex;
  return Joint::step;
}

SurfelMesh surfel_mesh(const map::StaticMap& map, const View& view, double splat_m, double occlusion_tolerance,
                       double max_slope) {
  const std::vector<map::VisiblePoint> points = map::find_visible_points(map, view, splat_m, occlusion_tolerance);
  SurfelMesh mesh;
  mesh.surfels.reserve(points.size());
  for (const map::VisiblePoint& p : points) mesh.surfels.push_back(surfel(p, map));
  delaunay(points, [&](const std::array<std::size_t, 3>& corners) { mesh.triangles.push_back(corners); });
  set_planes(mesh, view, static_cast<float>(max_slope));
  smooth_normals(mesh);
  for (Surfel& s : mesh.surfels) set_slope(s, view);
  set_ways(mesh);
  return mesh;
}

}  // namespace dvi::depth
