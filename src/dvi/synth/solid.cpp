#include "dvi/synth/solid.h"

#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

namespace dvi::synth {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kLeafSize = 3;

AlignedBox3d find_bounds(const Surface& surface) {
  AlignedBox3d box(surface.origin);
  if (surface.radius > 0) {
    box.extend(Vector3d(surface.origin + surface.down));
    const Vector3d round(surface.radius, surface.radius, 0);
    return {box.min() - round, box.max() + round};
  }
  for (const Vector3d& corner : {surface.right, surface.down, Vector3d(surface.right + surface.down)})
    box.extend(Vector3d(surface.origin + corner));
  return box;
}

void complete_surface(Surface& surface) {
  surface.normal = surface.down.cross(surface.right).normalized();
  // The duals are vectors whose dot products are the coordinates along the two edges.
  const double rr = surface.right.squaredNorm(), dd = surface.down.squaredNorm(), rd = surface.right.dot(surface.down);
  const double det = rr * dd - rd * rd;
  surface.dual_right = (dd * surface.right - rd * surface.down) / det;
  surface.dual_down = (rr * surface.down - rd * surface.right) / det;
}

// Returns the nearest intersection in the span with the wall of an upright cylinder, by a quadratic equation; its end for none.
double meet_cylinder(const Surface& surface, const Ray& ray, const RaySpan& span) {
  const Vector2d o = (ray.origin - surface.origin).head<2>(), d = ray.direction.head<2>();
  const double a = d.squaredNorm(), b = o.dot(d), c = o.squaredNorm() - surface.radius * surface.radius;
  const double root = b * b - a * c;
  if (root < 0 || a == 0) return span.far;
  const double top = surface.origin.z(), bottom = top + surface.down.z();
  for (const double t : {(-b - std::sqrt(root)) / a, (-b + std::sqrt(root)) / a}) {
    const double z = ray.origin.z() + t * ray.direction.z();
    if (span.contains(t) && z <= top && z >= bottom) return t;
  }
  return span.far;
}

}  // namespace

Surface& Solid::add(const Corners& corners, TexturePtr texture) {
  const auto& [lower_left, lower_right, upper_left, upper_right] = corners;
  Surface surface;
  surface.right = lower_right - lower_left;
  const double length2 = surface.right.squaredNorm();
  surface.taper_left = (upper_left - lower_left).dot(surface.right) / length2;
  surface.taper_right = (lower_right - upper_right).dot(surface.right) / length2;
  if (surface.taper_left < 0 || surface.taper_right < 0) {  // its bound is a sheared parallelogram
    surface.taper_right += surface.taper_left;
    surface.taper_left = 0;
  }
  surface.origin = upper_left - surface.taper_left * surface.right;
  surface.down = lower_left - surface.origin;
  surface.part = cv::Rect2d(0, 0, texture->width(), texture->height());
  surface.texture = std::move(texture);
  complete_surface(surface);
  return surfaces_.emplace_back(std::move(surface));
}

Surface& Solid::add_cylinder(const Vector3d& foot, double radius, double height, TexturePtr texture) {
  Surface surface;
  surface.origin = foot + Vector3d(0, 0, height);
  surface.down = {0, 0, -height};
  surface.right = Vector3d::Zero();
  surface.radius = radius;
  surface.part = cv::Rect2d(0, 0, texture->width(), texture->height());
  surface.texture = std::move(texture);
  return surfaces_.emplace_back(std::move(surface));
}

void Solid::add(const Solid& other, const SE3& this_from_other) {
  for (Surface surface : other.surfaces_) {
    surface.origin = this_from_other * surface.origin;
    surface.right = this_from_other.R * surface.right;
    surface.down = this_from_other.R * surface.down;
    if (surface.radius == 0) complete_surface(surface);
    surfaces_.push_back(std::move(surface));
  }
}

void Solid::finish() {
  std::vector<AlignedBox3d> boxes;
  for (const Surface& surface : surfaces_) boxes.push_back(find_bounds(surface));
  order_.resize(surfaces_.size());
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.assign(1, {});
  split(0, 0, static_cast<int>(order_.size()), boxes);
}

void Solid::split(int node, int first, int count, const std::vector<AlignedBox3d>& boxes) {
  AlignedBox3d box, centers;
  for (int i = first; i < first + count; ++i) {
    box.extend(boxes[order_[i]]);
    centers.extend(boxes[order_[i]].center());
  }
  // The margin allows for the rounding of floats at the far end of a street.
  nodes_[node].low = (box.min().array() - 1e-3).cast<float>();
  nodes_[node].high = (box.max().array() + 1e-3).cast<float>();
  nodes_[node].first = first;
  nodes_[node].count = count;
  if (count <= kLeafSize) return;
  int axis = 0;
  centers.sizes().maxCoeff(&axis);
  const auto begin = order_.begin() + first;
  std::stable_sort(begin, begin + count, [&](int a, int b) { return boxes[a].center()[axis] < boxes[b].center()[axis]; });
  const int left = static_cast<int>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[node].first = left;
  nodes_[node].count = 0;
  split(left, first, count / 2, boxes);
  split(left + 1, first + count / 2, count - count / 2, boxes);
}

bool Solid::meet(const Surface& surface, const Ray& ray, const RaySpan& span, Hit& hit) {
  double t = 0, a = 0, b = 0;
  if (surface.radius > 0) {
    t = meet_cylinder(surface, ray, span);
    if (t >= span.far) return false;
    const Vector3d p = ray.at(t) - surface.origin;
    a = 0.5 + std::atan2(p.y(), p.x()) / (2 * std::numbers::pi);
    b = p.z() / surface.down.z();
  } else {
    t = surface.normal.dot(surface.origin - ray.origin) / surface.normal.dot(ray.direction);
    if (!span.contains(t)) return false;
    const Vector3d p = ray.at(t) - surface.origin;
    b = surface.dual_down.dot(p);
    if (b < 0 || b > 1) return false;
    a = surface.dual_right.dot(p);
    if (a < surface.taper_left * (1 - b) || a > 1 - surface.taper_right * (1 - b)) return false;
  }
  const double x = surface.part.x + a * surface.part.width, y = surface.part.y + b * surface.part.height;
  if (!surface.texture->solid(x, y)) return false;
  hit.t = t;
  hit.x = x;
  hit.y = y;
  return true;
}

Hit Solid::trace(const Ray& ray, double t_max, double near) const {
  Hit hit;
  if (surfaces_.empty()) return hit;
  const Eigen::Array3f origin = ray.origin.cast<float>(), inverse = ray.direction.cast<float>().array().inverse();
  double nearest = t_max;
  const auto entry = [&](const Node& node) {
    const Eigen::Array3f a = (node.low.array() - origin) * inverse, b = (node.high.array() - origin) * inverse;
    const float in = a.min(b).maxCoeff(), out = a.max(b).minCoeff();
    return in <= out && out > 0 ? std::max(in, 0.0F) : std::numeric_limits<float>::infinity();
  };
  std::array<int, 64> stack;
  int depth = 0, node = 0;
  if (!(entry(nodes_[0]) < nearest)) return hit;
  for (;;) {
    const Node& here = nodes_[node];
    if (here.count == 0) {
      const float left = entry(nodes_[here.first]), right = entry(nodes_[here.first + 1]);
      const bool swap = right < left;
      const float close = swap ? right : left, far = swap ? left : right;
      if (far < nearest) stack[depth++] = here.first + (swap ? 0 : 1);
      if (close < nearest) {
        node = here.first + (swap ? 1 : 0);
        continue;
      }
    } else {
      for (int i = here.first; i < here.first + here.count; ++i)
        if (meet(surfaces_[order_[i]], ray, {near, nearest}, hit)) {
          nearest = hit.t;
          hit.surface = order_[i];
        }
    }
    if (depth == 0) return hit;
    node = stack[--depth];
  }
}

cv::Vec3f Solid::shade(const Ray& ray, const Hit& hit, const Light& light, double pixel_share) const {
  const Surface& surface = surfaces_[hit.surface];
  const Vector3d p = ray.at(hit.t);
  Vector3d normal = surface.normal;
  Vector2d steps[2];
  if (surface.radius > 0) {
    normal = Vector3d(p.x() - surface.origin.x(), p.y() - surface.origin.y(), 0) / surface.radius;
    const double size = hit.t * ray.step_x.norm() * pixel_share;
    steps[0] = {size / (2 * std::numbers::pi * surface.radius) * surface.part.width, 0};
    steps[1] = {0, size / -surface.down.z() * surface.part.height};
  } else {
    const double height = surface.normal.dot(surface.origin - ray.origin);
    for (int i = 0; i < 2; ++i) {
      const Vector3d direction = ray.direction + pixel_share * (i == 0 ? ray.step_x : ray.step_y);
      double t = height / surface.normal.dot(direction);
      if (!(t > 0 && t < 4 * hit.t)) t = 4 * hit.t;
      const Vector3d step = ray.origin + t * direction - p;
      steps[i] = {surface.dual_right.dot(step) * surface.part.width, surface.dual_down.dot(step) * surface.part.height};
    }
    if (normal.dot(ray.direction) > 0) normal = -normal;
  }
  const cv::Vec3f factor = light.on(surface.lit ? normal : Vector3d::UnitZ()).mul(surface.tint);
  return surface.texture->sample(hit.x, hit.y, steps[0], steps[1]).mul(factor);
}

Vector3d Solid::low() const { return nodes_.front().low.cast<double>(); }
Vector3d Solid::high() const { return nodes_.front().high.cast<double>(); }

}  // namespace dvi::synth
