#include "dvi/depth/kerbs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include <Eigen/Dense>

namespace dvi::depth {
namespace {

constexpr float kMaxRange = 40;                // metres: farther away steps are as high as the noise of poses
constexpr float kLeast = 0.06F, kMost = 0.3F;  // metres of height: three times the range noise; higher is no kerb
constexpr float kNear = 1;                     // metres between returns on either side
constexpr float kClear = 0.15F;                // metres beside a kerb: no return there is on its face
constexpr float kBin = 0.2F;                   // metres across: what a kerb is bent and returns lie apart
constexpr std::size_t kFew = 40;               // steps that make no kerb
constexpr int kAngles = 360;                   // directions that are tried

int bin(float at) { return static_cast<int>(std::floor(at / kBin)); }

}  // namespace

Kerbs::Kerbs(const SurfelMesh& mesh, const Eigen::Vector3f& eye) : eye_(eye) {
  std::vector<Eigen::Vector3f> ground;
  for (const Surfel& s : mesh.surfels)
    if (s.is_ground() && (s.world - eye).norm() < kMaxRange) ground.push_back(s.world);
  std::vector<Eigen::Vector2f> steps;
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const Surfel &a = mesh.surfels[t[k]], &b = mesh.surfels[t[(k + 1) % 3]];
      const Eigen::Vector3f way = b.world - a.world;
      // Each step is met from both sides, once on the way up.
      if (!a.is_ground() || !b.is_ground() || way.z() < kLeast || way.z() > kMost || way.norm() > kNear) continue;
      if ((a.world - eye).norm() < kMaxRange) steps.emplace_back(0.5F * (a.world + b.world).head<2>());
    }
  if (steps.size() < kFew) return;
  find_direction(steps);
  find_lines(steps, ground);
}

// The direction in which the steps line up: few places across that hold many.
void Kerbs::find_direction(const std::vector<Eigen::Vector2f>& steps) {
  double most = 0;
  std::vector<int> bins(steps.size());
  std::vector<std::size_t> count;
  for (int i = 0; i < kAngles; ++i) {
    const float angle = static_cast<float>(i) * std::numbers::pi_v<float> / kAngles;
    const Eigen::Vector2f direction(std::cos(angle), std::sin(angle));
    std::transform(steps.begin(), steps.end(), bins.begin(), [&](const Eigen::Vector2f& s) { return bin(direction.dot(s)); });
    const auto [low, high] = std::minmax_element(bins.begin(), bins.end());
    count.assign(static_cast<std::size_t>(*high - *low) + 1, 0);
    for (const int at : bins) ++count[static_cast<std::size_t>(at - *low)];
    double sum = 0;
    for (const std::size_t n : count) sum += static_cast<double>(n * n);
    if (sum <= most) continue;
    most = sum;
    across_ = direction;
  }
}

// Places that hold a tenth of the steps and part two levels of the ground.
void Kerbs::find_lines(const std::vector<Eigen::Vector2f>& steps, const std::vector<Eigen::Vector3f>& ground) {
  std::map<int, std::vector<float>> bins;
  for (const Eigen::Vector2f& s : steps) bins[bin(across_.dot(s))].push_back(across_.dot(s));
  const auto size = [&](int at) { return bins.contains(at) ? bins.at(at).size() : 0; };
  for (const auto& [place, in] : bins) {
    if (10 * in.size() < steps.size() || in.size() < size(place - 1) || in.size() <= size(place + 1)) continue;
    const float at = std::accumulate(in.begin(), in.end(), 0.0F) / static_cast<float>(in.size());
    // What the ground rises by there, beside its slope.
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    std::array<std::size_t, 2> count{};
    for (const Eigen::Vector3f& p : ground) {
      const float off = across(p) - at;
      if (std::abs(off) < kClear || std::abs(off) > kNear) continue;
      const Eigen::Vector4d row(1, off, across_.x() * p.y() - across_.y() * p.x(), off > 0 ? 1 : 0);
      normal += row * row.transpose();
      right += row * p.z();
      ++count[off > 0 ? 1 : 0];
    }
    if (count[0] < kFew || count[1] < kFew) continue;
    const auto height = static_cast<float>(normal.ldlt().solve(right)[3]);
    if (std::abs(height) > kLeast && std::abs(height) < kMost) lines_.push_back({at, height});
  }
}

float Kerbs::rise(float from, float to) const {
  float sum = 0;
  for (const Line& line : lines_) {
    if (from < line.at && line.at <= to) sum += line.height;
    if (to < line.at && line.at <= from) sum -= line.height;
  }
  return sum;
}

float Kerbs::inverse(const std::array<const Surfel*, 3>& corners, const std::array<float, 3>& w) const {
  Eigen::Vector3f ray = Eigen::Vector3f::Zero();  // of the pixel, to depth 1
  float plain = 0;
  for (int k = 0; k < 3; ++k) {
    ray += w[k] * corners[k]->inverse * (corners[k]->world - eye_);
    plain += w[k] * corners[k]->inverse;
  }
  float inverse = plain;
  for (int round = 0; round < 3; ++round) {  // where the ray meets the ground depends on its height a little
    const float at = across(eye_ + ray / inverse);
    float sum = 0;
    for (int k = 0; k < 3; ++k) {
      const float below = corners[k]->world.z() - eye_.z(), level = below + rise(across(corners[k]->world), at);
      if (level >= 0) return plain;  // the view does not look down on it
      sum += w[k] * corners[k]->inverse * below / level;
    }
    inverse = sum;
  }
  return inverse;
}

}  // namespace dvi::depth
