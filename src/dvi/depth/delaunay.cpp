#include "dvi/depth/delaunay.h"

#include <cmath>

#include <boost/polygon/voronoi.hpp>

namespace dvi::depth {
namespace {

constexpr double kStepsPerPixel = 16;

struct Site {
  int x, y;
};

}  // namespace
}  // namespace dvi::depth

template <>
struct boost::polygon::geometry_concept<dvi::depth::Site> {
  using type = point_concept;
};

template <>
struct boost::polygon::point_traits<dvi::depth::Site> {
  using coordinate_type = int;
  static int get(const dvi::depth::Site& site, const orientation_2d& axis) { return axis == HORIZONTAL ? site.x : site.y; }
};

namespace dvi::depth {

void triangulate(const std::vector<map::VisiblePoint>& points,
                 const std::function<void(const std::array<std::size_t, 3>&)>& visit) {
  std::vector<Site> sites;
  sites.reserve(points.size());
  for (const map::VisiblePoint& p : points)
    sites.push_back({static_cast<int>(std::lround(p.u * kStepsPerPixel)), static_cast<int>(std::lround(p.v * kStepsPerPixel))});
  boost::polygon::voronoi_diagram<double> diagram;
  boost::polygon::construct_voronoi(sites.begin(), sites.end(), &diagram);
  // The cells around a Voronoi vertex are the corners of a Delaunay polygon. If more than three are cocircular, it is a fan.
  for (const auto& vertex : diagram.vertices()) {
    const auto* first = vertex.incident_edge();
    std::array<std::size_t, 3> corners{first->cell()->source_index(), 0, 0};
    int count = 1;
    for (const auto* edge = first->rot_next(); edge != first; edge = edge->rot_next()) {
      corners[2] = edge->cell()->source_index();
      if (++count > 2) visit(corners);
      corners[1] = corners[2];
    }
  }
}

}  // namespace dvi::depth
