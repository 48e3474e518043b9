#include "dvi/ground/road_frame.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "dvi/drive/view.h"

namespace dvi::ground {
namespace {

constexpr double kMinStepM = 0.5;  // a camera that moved less is stationary
constexpr double kMaxStepM = 200;  // between two positions farther apart, poses are missing or wrong

Eigen::Vector2d to_plane(const Eigen::Vector3d& x) { return x.head<2>(); }

std::vector<Eigen::Vector2d> list_centers(const Views& views) {
  std::vector<Eigen::Vector2d> out;
  const auto [first, last] = views.of_sequence(0);
  for (std::size_t i = first; i < last; ++i) {
    const Eigen::Vector2d at = to_plane(views[i].camera_from_world.inverse().t);
    if (out.empty() || (at - out.back()).norm() >= kMinStepM) out.push_back(at);
  }
  return out;
}

/// Smooths the path, so that errors of poses do not bend the road.
std::vector<Eigen::Vector2d> smooth(const std::vector<Eigen::Vector2d>& path) {
  std::vector<Eigen::Vector2d> out = path;
  const auto count = static_cast<int>(path.size());
  for (int i = 0; i < count; ++i) {
    const int reach = std::min({3, i, count - 1 - i});
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (int k = -reach; k <= reach; ++k) sum += path[i + k];
    out[i] = sum / (2 * reach + 1);
  }
  return out;
}

Eigen::Vector2d estimate_heading(const Views& views, const std::vector<Eigen::Vector2d>& path, bool at_end) {
  constexpr double kMinLengthM = 5;
  const Eigen::Vector2d& end = at_end ? path.back() : path.front();
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Eigen::Vector2d& other = at_end ? path[path.size() - 1 - i] : path[i];
    const Eigen::Vector2d step = at_end ? Eigen::Vector2d(end - other) : Eigen::Vector2d(other - end);
    if (step.norm() > kMinLengthM || (i + 1 == path.size() && step.norm() > kMinStepM)) return step.normalized();
  }
  const Eigen::Vector2d ahead = to_plane(views[0].camera_from_world.R.transpose() * Eigen::Vector3d::UnitZ());
  return ahead.norm() > 0 ? Eigen::Vector2d(ahead.normalized()) : Eigen::Vector2d::UnitX();
}

constexpr double kSquareM = 4;  // edge of a square of the index
constexpr int kNeighborSquares = static_cast<int>(RoadFrame::kHalfWidthM / kSquareM) + 1;

int to_square(double v) { return static_cast<int>(std::floor(v / kSquareM)); }

/// The distance in meters from the center of a square to a position.
double distance_to_center(const Eigen::Array2i& square, const Eigen::Vector2d& position) {
  return ((square.cast<double>() + 0.5) * kSquareM - position.array()).matrix().norm();
}

}  // namespace

RoadFrame::RoadFrame(const Views& views) {
  const std::vector<Eigen::Vector2d> all = list_centers(views);
  for (auto begin = all.begin(); begin != all.end();) {
    const auto is_gap = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return (a - b).norm() > kMaxStepM; };
    auto end = std::adjacent_find(begin, all.end(), is_gap);
    if (end != all.end()) ++end;
    add_piece(smooth({begin, end}), views);
    begin = end;
  }
  index_squares();
}

void RoadFrame::add_piece(const std::vector<Eigen::Vector2d>& path, const Views& views) {
  std::vector<Eigen::Vector2d> corners{path.front() - kExtensionM * estimate_heading(views, path, false)};
  corners.insert(corners.end(), path.begin(), path.end());
  corners.emplace_back(path.back() + kExtensionM * estimate_heading(views, path, true));
  const std::size_t first = path_.size();
  double open = 0;  // meters from the last corner to the next path point
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const Eigen::Vector2d step = corners[i + 1] - corners[i];
    for (; open <= step.norm(); open += 1) path_.emplace_back(corners[i] + open * step.normalized());
    open -= step.norm();
  }
  const std::size_t last = path_.size() - 1;
  for (std::size_t i = first; i <= last; ++i)
    directions_.emplace_back((path_[std::min(i + 1, last)] - path_[std::max(i, first + 1) - 1]).normalized());
  pieces_.push_back({static_cast<int>(first), static_cast<int>(last)});
}

void RoadFrame::index_squares() {
  for (std::size_t i = 0; i < path_.size(); ++i) {
    const int x = to_square(path_[i].x()), y = to_square(path_[i].y());
    for (int dy = -kNeighborSquares; dy <= kNeighborSquares; ++dy)
      for (int dx = -kNeighborSquares; dx <= kNeighborSquares; ++dx) near_[{x + dx, y + dy}].push_back(static_cast<int>(i));
  }
  // All positions in a square are within 0.71 of its edge from the center, so that points farther by 1.5 edges are not the
  // nearest.
  for (auto& [at, meters] : near_) {
    const Eigen::Array2i here(at.first, at.second);
    const auto distance = [&](int i) { return distance_to_center(here, path_[i]); };
    double lowest = distance(meters.front());
    for (const int i : meters) lowest = std::min(lowest, distance(i));
    meters.erase(std::remove_if(meters.begin(), meters.end(), [&](int i) { return distance(i) > lowest + 1.5 * kSquareM; }),
                 meters.end());
  }
}

int RoadFrame::meter(double along) const {
  return std::clamp(static_cast<int>(std::floor(along)), 0, static_cast<int>(path_.size()) - 2);
}

Eigen::Vector2d RoadFrame::middle(double along) const {
  const int i = meter(along);
  return path_[i] + (along - i) * (path_[i + 1] - path_[i]);
}

Eigen::Vector2d RoadFrame::direction(double along) const {
  // Interpolated, so that the coordinates are continuous at corners.
  const int i = meter(along);
  const double part = std::clamp(along - i, 0.0, 1.0);
  return ((1 - part) * directions_[i] + part * directions_[i + 1]).normalized();
}

Eigen::Vector2d RoadFrame::to_world(double along, double left) const {
  const Eigen::Vector2d d = direction(along);
  return middle(along) + left * Eigen::Vector2d(-d.y(), d.x());
}

std::optional<Eigen::Vector2d> RoadFrame::locate(const Eigen::Vector2d& position) const {
  const auto near = near_.find({to_square(position.x()), to_square(position.y())});
  if (near == near_.end()) return std::nullopt;
  int best = -1;
  double lowest = kHalfWidthM * kHalfWidthM;
  for (const int i : near->second)
    if (const double d = (path_[i] - position).squaredNorm(); d < lowest) {
      lowest = d;
      best = i;
    }
  if (best < 0) return std::nullopt;
  const auto piece = std::partition_point(pieces_.begin(), pieces_.end(), [&](const Piece& p) { return p.last < best; });
  double along = best;
  for (int round = 0; round < 2; ++round)
    along = std::clamp(along + (position - middle(along)).dot(direction(along)), static_cast<double>(piece->first),
                       static_cast<double>(piece->last));
  const Eigen::Vector2d d = direction(along), off = position - middle(along);
  return Eigen::Vector2d(along, off.dot(Eigen::Vector2d(-d.y(), d.x())));
}

}  // namespace dvi::ground
