#include "dvi/depth/triangle.h"

#include <algorithm>
#include <cmath>

namespace dvi::depth {
namespace {

constexpr float kMaxSpacingRatio = 2;  // in longer edges, relative to the spacing of returns, an area was not scanned
constexpr std::array<std::array<int, 2>, 3> kPairs{{{0, 1}, {0, 2}, {1, 2}}};

/// Whether an area between two surfels was not scanned.
bool has_gap(const Surfel& a, const Surfel& b) {
  const float length = std::hypot(a.u - b.u, a.v - b.v);
  return length > kMaxSpacingRatio * std::sqrt(std::max({1.0F, a.scatter.trace(), b.scatter.trace()}));
}

/// Computes the part of the edge from a near surfel to a far one that belongs to the near surface: half the spacing of its
/// returns, but not more than its share of both spacings.
float find_cut(const Surfel& near, const Surfel& far) {
  const Eigen::Vector2f to(far.u - near.u, far.v - near.v);
  const bool gap = has_gap(near, far);
  const auto spacing = [&](const Surfel& s) { return std::max(1.0F, gap ? std::sqrt(s.scatter.trace()) : s.spacing(to)); };
  const float length = std::max(1.0F, to.norm()), a = spacing(near), b = spacing(far);
  return std::clamp(std::min(0.5F * a / length, a / (a + b)), 0.02F, 0.98F);
}

/// Selects the visible one of two planes that intersect.
Triangle::Value select_visible(Joint joint, const Triangle::Value& a, const Triangle::Value& b) {
  return (joint == Joint::concave) == (a.inverse > b.inverse) ? a : b;
}

}  // namespace

Corners sort_corners(const SurfelMesh& mesh, const std::array<std::size_t, 3>& corners) {
  Corners out{&mesh.surfels[corners[0]], &mesh.surfels[corners[1]], &mesh.surfels[corners[2]]};
  std::sort(out.begin(), out.end(), [](const Surfel* a, const Surfel* b) { return a->inverse > b->inverse; });
  return out;
}

Triangle::Triangle(const Corners& corners) : corners_(corners) {
  std::array<int, 3> steps{};
  for (int i = 0; i < 3; ++i) {
    const auto [a, b] = kPairs[i];
    joints_[i] = classify_joint(*corners_[a], *corners_[b]);
    if (joints_[i] != Joint::same && has_gap(*corners_[a], *corners_[b])) is_gap_ = true;
    if (joints_[i] != Joint::step) continue;
    cuts_[i] = find_cut(*corners_[a], *corners_[b]);
    ++steps[a];
    ++steps[b];
  }
  is_one_surface_ = std::count(joints_.begin(), joints_.end(), Joint::same) >= 2;
  const auto lone = std::find(steps.begin(), steps.end(), 2);
  if (!is_one_surface_ && lone != steps.end()) isolated_ = static_cast<int>(lone - steps.begin());
}

Triangle::Value Triangle::interpolate(const std::array<float, 3>& w) const {
  const float inverse = w[0] * corners_[0]->inverse + w[1] * corners_[1]->inverse + w[2] * corners_[2]->inverse;
  return {inverse, 0, static_cast<int>(std::max_element(w.begin(), w.end()) - w.begin())};
}

// The depth of a corner's plane. It is limited to twice the farthest corner's, because planes recede to the horizon, and is
// that of the corner where the plane approaches the view.
Triangle::Value Triangle::evaluate_plane(int k, const cv::Point2f& at) const {
  const float plane = std::max(corners_[k]->inverse_at(at.x, at.y), 0.5F * corners_[2]->inverse);
  return {plane < 2 * corners_[0]->inverse ? plane : corners_[k]->inverse, 0, k};
}

// The depth at a pixel of the surfaces of two corners.
Triangle::Value Triangle::split_pair(int a, int b, const cv::Point2f& at, const std::array<float, 3>& w) const {
  const Value at_a = evaluate_plane(a, at), at_b = evaluate_plane(b, at);
  const float both = std::max(w[a] + w[b], 1e-6F);
  switch (joint_of(a, b)) {
    case Joint::same:
      return {(w[a] * at_a.inverse + w[b] * at_b.inverse) / both, 0, w[a] > w[b] ? a : b};
    case Joint::step:
      return w[b] < both * cut_of(a, b) ? at_a : at_b;
    default:
      return select_visible(joint_of(a, b), at_a, at_b);
  }
}

Triangle::Value Triangle::split(const cv::Point2f& at, const std::array<float, 3>& w) const {
  if (isolated_ >= 0) {
    const int i = isolated_ == 0 ? 1 : 0, j = isolated_ == 2 ? 1 : 2;
    // The line through the cuts of both edges separates the isolated corner.
    const auto side = [&](int k) {
      const float c = cut_of(isolated_, k);
      return isolated_ < k ? (1 - c) / c : c / (1 - c);
    };
    return w[isolated_] > w[i] * side(i) + w[j] * side(j) ? evaluate_plane(isolated_, at) : split_pair(i, j, at, w);
  }
  // The two corners of one surface, or else the two that a step separates, are evaluated first, then compared with the third.
  int pair = 0;
  for (int i = 0; i < 3; ++i)
    if (joints_[i] == Joint::same || (joints_[i] == Joint::step && joints_[pair] != Joint::same)) pair = i;
  const auto [a, b] = kPairs[pair];
  const int c = 3 - a - b;
  const Value first = split_pair(a, b, at, w), third = evaluate_plane(c, at);
  const Joint joint = joint_of(first.corner, c);
  if (joint == Joint::same) return {first.inverse * (w[a] + w[b]) + third.inverse * w[c], 0, first.corner};
  if (joint == Joint::step) return w[c] > 0.5F ? third : first;
  return select_visible(joint, first, third);
}

Triangle::Value Triangle::evaluate(float x, float y, const std::array<float, 3>& w) const {
  if (is_one_surface_) return interpolate(w);
  Value value = split({x, y}, w);
  value.spread = 0.5F * (1 / corners_[2]->inverse - 1 / corners_[0]->inverse);
  return value;
}

}  // namespace dvi::depth
