#include "dvi/ground/road_frame.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "dvi/drive/view.h"

namespace dvi::ground {
namespace {

constexpr double kStep = 0.5;  // meters: a camera that moved less stands
// Between two positions farther apart, poses are missing or wrong: there is no road to sample, however long it would be.
constexpr double kMaxStepM = 200;

Eigen::Vector2d flat(const Eigen::Vector3d& x) { return x.head<2>(); }

std::vector<Eigen::Vector2d> centers(const Views& views) {
  std::vector<Eigen::Vector2d> out;
  const auto [first, last] = views.of_sequence(0);
  for (std::size_t i = first; i < last; ++i) {
    const Eigen::Vector2d at = flat(views[i].camera_from_world.inverse().t);
    if (out.empty() || (at - out.back()).norm() >= kStep) out.push_back(at);
  }
  return out;
}

// What poses are off by does not bend the road.
std::vector<Eigen::Vector2d> smoothed(const std::vector<Eigen::Vector2d>& way) {
  std::vector<Eigen::Vector2d> out = way;
  const auto count = static_cast<int>(way.size());
  for (int i = 0; i < count; ++i) {
    const int reach = std::min({3, i, count - 1 - i});
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (int k = -reach; k <= reach; ++k) sum += way[i + k];
    out[i] = sum / (2 * reach + 1);
  }
  return out;
}

Eigen::Vector2d heading(const Views& views, const std::vector<Eigen::Vector2d>& way, bool at_end) {
  constexpr double kLong = 5;  // meters that tell it
  const Eigen::Vector2d& end = at_end ? way.back() : way.front();
  for (std::size_t i = 0; i < way.size(); ++i) {
    const Eigen::Vector2d& other = at_end ? way[way.size() - 1 - i] : way[i];
    const Eigen::Vector2d step = at_end ? Eigen::Vector2d(end - other) : Eigen::Vector2d(other - end);
    if (step.norm() > kLong || (i + 1 == way.size() && step.norm() > kStep)) return step.normalized();
  }
  const Eigen::Vector2d ahead = flat(views[0].camera_from_world.R.transpose() * Eigen::Vector3d::UnitZ());
  return ahead.norm() > 0 ? Eigen::Vector2d(ahead.normalized()) : Eigen::Vector2d::UnitX();
}

constexpr double kSide = 4;  // meters of a square
constexpr int kBeside = static_cast<int>(RoadFrame::kReach / kSide) + 1;

int square(double v) { return static_cast<int>(std::floor(v / kSide)); }

/// Meters from the middle of a square to a place.
double to_middle(const Eigen::Array2i& square, const Eigen::Vector2d& place) {
  return ((square.cast<double>() + 0.5) * kSide - place.array()).matrix().norm();
}

}  // namespace

RoadFrame::RoadFrame(const Views& views) {
  const std::vector<Eigen::Vector2d> all = centers(views);
  for (auto begin = all.begin(); begin != all.end();) {
    const auto far = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return (a - b).norm() > kMaxStepM; };
    auto end = std::adjacent_find(begin, all.end(), far);
    if (end != all.end()) ++end;
    add_piece(smoothed({begin, end}), views);
    begin = end;
  }
  find_near();
}

void RoadFrame::add_piece(const std::vector<Eigen::Vector2d>& way, const Views& views) {
  std::vector<Eigen::Vector2d> corners{way.front() - kOnward * heading(views, way, false)};
  corners.insert(corners.end(), way.begin(), way.end());
  corners.emplace_back(way.back() + kOnward * heading(views, way, true));
  const std::size_t first = way_.size();
  double open = 0;  // meters from the last corner to the next place
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const Eigen::Vector2d step = corners[i + 1] - corners[i];
    for (; open <= step.norm(); open += 1) way_.emplace_back(corners[i] + open * step.normalized());
    open -= step.norm();
  }
  const std::size_t last = way_.size() - 1;
  for (std::size_t i = first; i <= last; ++i)
    directions_.emplace_back((way_[std::min(i + 1, last)] - way_[std::max(i, first + 1) - 1]).normalized());
  pieces_.push_back({static_cast<int>(first), static_cast<int>(last)});
}

void RoadFrame::find_near() {
  for (std::size_t i = 0; i < way_.size(); ++i) {
    const int x = square(way_[i].x()), y = square(way_[i].y());
    for (int dy = -kBeside; dy <= kBeside; ++dy)
      for (int dx = -kBeside; dx <= kBeside; ++dx) near_[{x + dx, y + dy}].push_back(static_cast<int>(i));
  }
  // Any place of a square is within half its diagonal, .71 of its side, of the middle: farther ones are not the nearest of any.
  for (auto& [at, meters] : near_) {
    const Eigen::Array2i here(at.first, at.second);
    const auto distance = [&](int i) { return to_middle(here, way_[i]); };
    double least = distance(meters.front());
    for (const int i : meters) least = std::min(least, distance(i));
    meters.erase(std::remove_if(meters.begin(), meters.end(), [&](int i) { return distance(i) > least + 1.5 * kSide; }),
                 meters.end());
  }
}

int RoadFrame::meter(double along) const {
  return std::clamp(static_cast<int>(std::floor(along)), 0, static_cast<int>(way_.size()) - 2);
}

Eigen::Vector2d RoadFrame::middle(double along) const {
  const int i = meter(along);
  return way_[i] + (along - i) * (way_[i + 1] - way_[i]);
}

Eigen::Vector2d RoadFrame::direction(double along) const {
  // Between those of its meters, so that the coordinates do not break at corners.
  const int i = meter(along);
  const double part = std::clamp(along - i, 0.0, 1.0);
  return ((1 - part) * directions_[i] + part * directions_[i + 1]).normalized();
}

Eigen::Vector2d RoadFrame::place(double along, double left) const {
  const Eigen::Vector2d d = direction(along);
  return middle(along) + left * Eigen::Vector2d(-d.y(), d.x());
}

std::optional<Eigen::Vector2d> RoadFrame::locate(const Eigen::Vector2d& place) const {
  const auto near = near_.find({square(place.x()), square(place.y())});
  if (near == near_.end()) return std::nullopt;
  int best = -1;
  double least = kReach * kReach;
  for (const int i : near->second)
    if (const double d = (way_[i] - place).squaredNorm(); d < least) {
      least = d;
      best = i;
    }
  if (best < 0) return std::nullopt;
  const auto piece = std::partition_point(pieces_.begin(), pieces_.end(), [&](const Piece& p) { return p.last < best; });
  double along = best;
  for (int round = 0; round < 2; ++round)
    along = std::clamp(along + (place - middle(along)).dot(direction(along)), static_cast<double>(piece->first),
                       static_cast<double>(piece->last));
  const Eigen::Vector2d d = direction(along), off = place - middle(along);
  return Eigen::Vector2d(along, off.dot(Eigen::Vector2d(-d.y(), d.x())));
}

}  // namespace dvi::ground
