#include "dvi/depth/triangle.h"

#include <algorithm>
#include <cmath>

namespace dvi::depth {
namespace {

constexpr float kGap = 2;  // times the spacing of returns: nothing was scanned in between
constexpr std::array<std::array<int, 2>, 3> kPairs{{{0, 1}, {0, 2}, {1, 2}}};

// Whether nothing was scanned between two surfels.
bool apart(const Surfel& a, const Surfel& b) {
  const float way = std::hypot(a.u - b.u, a.v - b.v);
  return way > kGap * std::sqrt(std::max({1.0F, a.ways.trace(), b.ways.trace()}));
}

// Which part of the way from a near surfel to a far one still belongs to the near surface: half its spacing, but no more than
// its share where the far surface begins as early.
float cut(const Surfel& near, const Surfel& far) {
  const Eigen::Vector2f to(far.u - near.u, far.v - near.v);
  const bool hidden = apart(near, far);
  const auto spacing = [&](const Surfel& s) { return std::max(1.0F, hidden ? std::sqrt(s.ways.trace()) : s.spacing(to)); };
  const float way = std::max(1.0F, to.norm()), a = spacing(near), b = spacing(far);
  return std::clamp(std::min(0.5F * a / way, a / (a + b)), 0.02F, 0.98F);
}

}  // namespace

Triangle::Triangle(const SurfelMesh& mesh, const std::array<std::size_t, 3>& corners) {
  for (int k = 0; k < 3; ++k) corners_[k] = &mesh.surfels[corners[k]];
  std::sort(corners_.begin(), corners_.end(), [](const Surfel* a, const Surfel* b) { return a->inverse > b->inverse; });
  std::array<int, 3> steps{};
  for (int i = 0; i < 3; ++i) {
    const auto [a, b] = kPairs[i];
    joints_[i] = joint(*corners_[a], *corners_[b]);
    if (joints_[i] != Joint::same && apart(*corners_[a], *corners_[b])) gap_ = true;
    if (joints_[i] != Joint::step) continue;
    cuts_[i] = cut(*corners_[a], *corners_[b]);
    ++steps[a];
    ++steps[b];
  }
  whole_ = std::count(joints_.begin(), joints_.end(), Joint::same) >= 2;
  const auto lone = std::find(steps.begin(), steps.end(), 2);
  if (!whole_ && lone != steps.end()) lone_ = static_cast<int>(lone - steps.begin());
}

Triangle::Value Triangle::interpolate(const std::array<float, 3>& w) const {
  const float inverse = w[0] * corners_[0]->inverse + w[1] * corners_[1]->inverse + w[2] * corners_[2]->inverse;
  return {inverse, 0, static_cast<int>(std::max_element(w.begin(), w.end()) - w.begin())};
}

// The plane of a corner as far as the triangle can tell: not twice as far as all corners, where it runs off to the horizon, and
// the corner itself where it comes up to the view.
Triangle::Value Triangle::own(int k, float x, float y) const {
  const float plane = std::max(corners_[k]->inverse_at(x, y), 0.5F * corners_[2]->inverse);
  return {plane < 2 * corners_[0]->inverse ? plane : corners_[k]->inverse, 0, k};
}

Triangle::Value Triangle::meet(Joint how, const Value& a, const Value& b) {
  return (how == Joint::concave) == (a.inverse > b.inverse) ? a : b;
}

// What two corners show at a pixel.
Triangle::Value Triangle::meet(int a, int b, float x, float y, const std::array<float, 3>& w) const {
  const Value at_a = own(a, x, y), at_b = own(b, x, y);
  const float both = std::max(w[a] + w[b], 1e-6F);
  switch (joint_of(a, b)) {
    case Joint::same:
      return {(w[a] * at_a.inverse + w[b] * at_b.inverse) / both, 0, w[a] > w[b] ? a : b};
    case Joint::step:
      return w[b] < both * cut_of(a, b) ? at_a : at_b;
    default:
      return meet(joint_of(a, b), at_a, at_b);
  }
}

Triangle::Value Triangle::shown(float x, float y, const std::array<float, 3>& w) const {
  if (lone_ >= 0) {
    const int i = lone_ == 0 ? 1 : 0, j = lone_ == 2 ? 1 : 2;
    // Where a line through the cuts on both ways to the lone corner passes: positive on the lone side.
    const auto side = [&](int k) {
      const float c = cut_of(lone_, k);
      return lone_ < k ? (1 - c) / c : c / (1 - c);
    };
    return w[lone_] > w[i] * side(i) + w[j] * side(j) ? own(lone_, x, y) : meet(i, j, x, y, w);
  }
  // Three that meet: the two that are one surface, or else the two that a step parts, against the third.
  int pair = 0;
  for (int i = 0; i < 3; ++i)
    if (joints_[i] == Joint::same || (joints_[i] == Joint::step && joints_[pair] != Joint::same)) pair = i;
  const auto [a, b] = kPairs[pair];
  const int c = 3 - a - b;
  const Value first = meet(a, b, x, y, w), third = own(c, x, y);
  const Joint how = joint_of(first.corner, c);
  if (how == Joint::same) return {first.inverse * (w[a] + w[b]) + third.inverse * w[c], 0, first.corner};
  if (how == Joint::step) return w[c] > 0.5F ? third : first;
  return meet(how, first, third);
}

Triangle::Value Triangle::at(float x, float y, const std::array<float, 3>& w) const {
  if (whole_) return interpolate(w);
  Value value = shown(x, y, w);
  value.spread = 0.5F * (1 / corners_[2]->inverse - 1 / corners_[0]->inverse);
  return value;
}

}  // namespace dvi::depth
