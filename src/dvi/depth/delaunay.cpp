#include "dvi/depth/delaunay.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <utility>

namespace dvi::depth {
namespace {

constexpr double kStepsPerPixel = 16;

/// A position in steps.
struct Site {
  std::int32_t x, y;
  bool operator==(const Site&) const = default;
};

/// Rounds as std::lround() does, whose argument is exact here.
std::int32_t round_to_step(float px) {
  const double steps = px * kStepsPerPixel;
  return static_cast<std::int32_t>(steps < 0 ? steps - 0.5 : steps + 0.5);
}

std::vector<Site> round_positions(const std::vector<map::VisiblePoint>& points) {
  std::vector<Site> sites;
  sites.reserve(points.size());
  for (const map::VisiblePoint& p : points) sites.push_back({round_to_step(p.u), round_to_step(p.v)});
  return sites;
}

/// Returns the indices of different sites from top to bottom, and from left to right within a row.
std::vector<std::int32_t> sort_sites(const std::vector<Site>& sites) {
  struct Item {
    std::int64_t key;
    std::int32_t site;
  };
  constexpr std::int64_t kRow = std::int64_t{1} << 32;
  std::vector<Item> items;
  items.reserve(sites.size());
  for (std::size_t i = 0; i < sites.size(); ++i)
    items.push_back({sites[i].y * kRow + sites[i].x, static_cast<std::int32_t>(i)});
  std::sort(items.begin(), items.end(), [](const Item& a, const Item& b) { return a.key < b.key; });
  std::vector<std::int32_t> order;
  order.reserve(items.size());
  for (std::size_t i = 0; i < items.size(); ++i)
    if (i == 0 || items[i].key != items[i - 1].key) order.push_back(items[i].site);
  return order;
}

/// Returns twice the area of a triangle, positive if a, b, c are counterclockwise.
std::int64_t area(const Site& a, const Site& b, const Site& c) {
  return std::int64_t{b.x - a.x} * (c.y - a.y) - std::int64_t{b.y - a.y} * (c.x - a.x);
}

/// Computes the determinant that is positive if d is inside the circle through a, b, c, which are counterclockwise.
template <class Integer>
Integer circle_determinant(const Site& a, const Site& b, const Site& c) {
  const auto square = [](const Site& s) { return Integer{s.x} * s.x + Integer{s.y} * s.y; };
  const auto cross = [](const Site& p, const Site& q) { return Integer{p.x} * q.y - Integer{p.y} * q.x; };
  return square(a) * cross(b, c) + square(b) * cross(c, a) + square(c) * cross(a, b);
}

/// Whether d is inside the circle through a, b, c, which are counterclockwise. Exact for positions below 2^29 steps.
bool is_in_circle(const Site& a, const Site& b, const Site& c, const Site& d) {
  __extension__ using Wide = __int128;
  constexpr std::int32_t kSmall = 1 << 14;  // the determinant of differences up to this has less than 63 bits
  const auto from_d = [&](const Site& s) { return Site{s.x - d.x, s.y - d.y}; };
  const auto bits = [](const Site& s) { return (s.x ^ (s.x >> 31)) | (s.y ^ (s.y >> 31)); };
  const Site p = from_d(a), q = from_d(b), r = from_d(c);
  if ((bits(p) | bits(q) | bits(r)) < kSmall) return circle_determinant<std::int64_t>(p, q, r) > 0;
  return circle_determinant<Wide>(p, q, r) > 0;
}

/// The Delaunay triangulation of sites that are inserted from top to bottom: each new site is outside the convex hull of the
/// earlier ones, is connected to all hull edges that face it, and edges are flipped until all circles are empty (C. L. Lawson,
/// Software for C1 surface interpolation, 1977). Directed edge e of triangle e / 4 starts at corner origin_[e]; each triangle
/// has an unused fourth entry, so that its edges are found without a division.
class Triangulation {
 public:
  explicit Triangulation(const std::vector<Site>& sites)
      : sites_(sites), next_(sites.size()), previous_(sites.size()), hull_edge_(sites.size()) {
    origin_.reserve(2 * kStride * sites.size());
    twin_.reserve(2 * kStride * sites.size());
    const std::vector<std::int32_t> order = sort_sites(sites);
    for (std::size_t k = begin_with(order); k < order.size(); ++k) insert(order[k], order[k - 1]);
  }

  static constexpr std::int32_t kStride = 4;  ///< Entries per triangle.

  /// Returns the corners of all triangles, each followed by an unused entry.
  const std::vector<std::int32_t>& corners() const { return origin_; }

 private:
  static constexpr std::int32_t kNone = -1;
  static std::int32_t after(std::int32_t edge) { return edge % kStride == 2 ? edge - 2 : edge + 1; }
  static std::int32_t before(std::int32_t edge) { return edge % kStride == 0 ? edge + 2 : edge - 1; }

  /// Connects the first sites, which are on a line, with the first one beside it. Returns the number of all these; that of all
  /// sites if all are on a line.
  std::size_t begin_with(const std::vector<std::int32_t>& order) {
    std::size_t count = 2;
    while (count < order.size() && area(sites_[order[0]], sites_[order[1]], sites_[order[count]]) == 0) ++count;
    if (count >= order.size()) return order.size();
    // The line as a hull without area: to its end and back. The first site beside it is visible from one of the sides.
    std::vector<std::int32_t> line(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count));
    if (area(sites_[line[0]], sites_[line[1]], sites_[order[count]]) > 0) std::reverse(line.begin(), line.end());
    const std::int32_t top = order[count];
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
      add_triangle(line[i + 1], line[i], top);
      if (const auto first = kStride * static_cast<std::int32_t>(i); i > 0) link(first + 1, first - kStride + 2);
    }
    const auto triangles = static_cast<std::int32_t>(count) - 1;
    for (std::int32_t i = 0; i < triangles; ++i) set_hull_edge(line[i + 1], line[i], kStride * i);
    set_hull_edge(line.front(), top, 1);
    set_hull_edge(top, line.back(), kStride * (triangles - 1) + 2);
    return count + 1;
  }

  void set_hull_edge(std::int32_t from, std::int32_t to, std::int32_t edge) {
    next_[from] = to;
    previous_[to] = from;
    hull_edge_[from] = edge;
  }

  /// Adds a counterclockwise triangle without neighbors. Returns its first edge, from a to b.
  std::int32_t add_triangle(std::int32_t a, std::int32_t b, std::int32_t c) {
    const auto edge = static_cast<std::int32_t>(origin_.size());
    origin_.insert(origin_.end(), {a, b, c, kNone});
    twin_.insert(twin_.end(), kStride, kNone);
    return edge;
  }
  void link(std::int32_t edge, std::int32_t twin) {
    twin_[edge] = twin;
    if (twin == kNone)
      hull_edge_[origin_[edge]] = edge;
    else
      twin_[twin] = edge;
  }

  /// Inserts a site below all others; `last` is the one inserted before, which faces it.
  void insert(std::int32_t site, std::int32_t last) {
    const auto is_visible = [&](std::int32_t from) { return area(sites_[from], sites_[next_[from]], sites_[site]) < 0; };
    std::int32_t first = last;
    while (is_visible(previous_[first])) first = previous_[first];
    std::int32_t end = first, edge = kNone;
    while (is_visible(end)) {
      const std::int32_t to = next_[end], inner = hull_edge_[end], added = add_triangle(to, end, site);
      link(added, inner);
      if (edge == kNone)
        hull_edge_[first] = added + 1;
      else
        link(added + 1, edge);
      edge = added + 2;
      unchecked_.push_back(added);
      end = to;
    }
    set_hull_edge(first, site, hull_edge_[first]);
    set_hull_edge(site, end, edge);
    flip();
  }

  /// Flips edges until no circle of a triangle contains the opposite corner of a neighbor.
  void flip() {
    while (!unchecked_.empty()) {
      const std::int32_t a = unchecked_.back(), b = twin_[a];
      unchecked_.pop_back();
      if (b == kNone) continue;
      const std::int32_t a_before = before(a), b_before = before(b);
      const std::int32_t new_site = origin_[a_before], opposite = origin_[b_before];
      if (!is_in_circle(sites_[new_site], sites_[origin_[a]], sites_[origin_[b]], sites_[opposite])) continue;
      origin_[a] = opposite;
      origin_[b] = new_site;
      link(a, twin_[b_before]);
      link(b, twin_[a_before]);
      link(a_before, b_before);
      unchecked_.push_back(after(b));
      unchecked_.push_back(a);
    }
  }

  const std::vector<Site>& sites_;
  std::vector<std::int32_t> origin_, twin_;                // per directed edge
  std::vector<std::int32_t> next_, previous_, hull_edge_;  // per site on the hull, which is counterclockwise
  std::vector<std::int32_t> unchecked_;
};

}  // namespace

void triangulate(const std::vector<map::VisiblePoint>& points,
                 const std::function<void(const std::array<std::size_t, 3>&)>& visit) {
  const std::vector<Site> sites = round_positions(points);
  const Triangulation made(sites);
  const std::vector<std::int32_t>& corners = made.corners();
  for (std::size_t i = 0; i < corners.size(); i += Triangulation::kStride)
    visit({static_cast<std::size_t>(corners[i]), static_cast<std::size_t>(corners[i + 1]),
           static_cast<std::size_t>(corners[i + 2])});
}

}  // namespace dvi::depth
