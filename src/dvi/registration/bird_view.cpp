#include "dvi/registration/bird_view.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include <opencv2/core.hpp>

#include "dvi/core/median.h"
#include "dvi/scan_match/local_map.h"

namespace dvi::registration {
namespace {

using scan_match::Feature;

constexpr double kRadius = 45;   // meters round the place
constexpr double kColumn = 0.5;  // meters: columns, and cells of the view
constexpr double kCurb = 0.6;    // meters: what stands is higher
constexpr double kHighest = 10;  // meters above the ground
constexpr int kCells = 256;      // of the view, each way: its width is more than twice kRadius, so that shifts do not wrap
constexpr int kHeadings = 180;   // of the circle
constexpr double kFarthestShift = 50;  // meters
constexpr double kWhitening = 0.7;     // 0: plain correlation, 1: phase only
constexpr double kApart = 1.5;         // meters between candidates of like heading
constexpr int kHeadingsApart = 4;

struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double height = 0;  // of the origin above it
  bool found = false;
};

Plane ground_of(const std::vector<scan_match::Feature>& planes) {
  constexpr double kNear = 20, kLevel = 0.85, kOff = 0.3;
  scan_match::LocalMap map(1.5);
  for (const scan_match::Feature& f : planes)
    if (f.point.head<2>().norm() < kNear) map.add(f.point.cast<double>());
  std::vector<Eigen::Vector3d> level;
  map.each([&](const scan_match::Shape& shape) {
    if (shape.thin == 1 && std::abs(shape.axes(2, 0)) > kLevel && shape.mean.z() < 0) level.push_back(shape.mean);
  });
  if (level.size() < 6) return {};
  std::vector<double> heights;
  for (const Eigen::Vector3d& x : level) heights.push_back(x.z());
  Eigen::Vector3d abc(0, 0, median(std::move(heights)));  // z = a x + b y + c
  for (int i = 0; i < 20; ++i) {
    const double off = std::max(kOff, 2.0 / (1 + i));  // a slope is found step by step
    Eigen::Matrix3d H = 1e-6 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& x : level) {
      const Eigen::Vector3d J(x.x(), x.y(), 1);
      const double r = x.z() - J.dot(abc), robust = off * off / (off * off + r * r);
      H += robust * robust * J * J.transpose();
      b += robust * robust * r * J;
    }
    abc += H.ldlt().solve(b);
  }
  const double scale = 1 / std::sqrt(1 + abc.x() * abc.x() + abc.y() * abc.y());
  return {scale * Eigen::Vector3d(-abc.x(), -abc.y(), 1), -abc.z() * scale, true};
}

cv::Mat1f raster(const std::vector<Eigen::Vector3d>& standing, double heading) {
  cv::Mat1f view(kCells, kCells, 0.0F);
  const double c = std::cos(heading), s = std::sin(heading);
  for (const Eigen::Vector3d& p : standing) {
    const double x = (c * p.x() - s * p.y()) / kColumn + 0.5 * kCells, y = (s * p.x() + c * p.y()) / kColumn + 0.5 * kCells;
    const int x0 = cvFloor(x), y0 = cvFloor(y);
    if (x0 < 0 || y0 < 0 || x0 + 1 >= kCells || y0 + 1 >= kCells) continue;
    for (const int dy : {0, 1})
      for (const int dx : {0, 1}) {
        const double weight = (dx == 1 ? x - x0 : 1 - x + x0) * (dy == 1 ? y - y0 : 1 - y + y0);
        float& cell = view(y0 + dy, x0 + dx);
        cell = std::max(cell, static_cast<float>(weight));
      }
  }
  return view;
}

cv::Mat2f whitened_spectrum(const cv::Mat1f& view) {
  cv::Mat2f out;
  cv::dft(view, out, cv::DFT_COMPLEX_OUTPUT);
  double energy = 0;
  for (cv::Vec2f& v : out) {
    const float size = std::hypot(v[0], v[1]);
    v *= size > 0 ? std::pow(size, -static_cast<float>(kWhitening)) : 0.0F;
    energy += v.dot(v);
  }
  if (energy > 0) out *= 1 / std::sqrt(energy);
  return out;
}

}  // namespace

SE3 level_from_lidar(const std::vector<scan_match::Feature>& planes) {
  const Plane ground = ground_of(planes);
  if (!ground.found) return {};
  const Eigen::Vector3d axis = ground.normal.cross(Eigen::Vector3d::UnitZ());
  const double angle = std::atan2(axis.norm(), ground.normal.z());
  const Eigen::Matrix3d R = axis.norm() > 0 ? so3_exp(angle * axis.normalized()) : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  return {R, {0, 0, ground.height}};
}

std::vector<Eigen::Vector3d> standing_points(const std::vector<scan_match::Feature>& features, const SE3& level_from_lidar) {
  struct Column {
    double low = 1e9, high = -1e9;
  };
  std::map<std::pair<int, int>, Column> columns;
  const auto cell_of = [](const Eigen::Vector3d& p) { return std::pair(cvFloor(p.x() / kColumn), cvFloor(p.y() / kColumn)); };
  std::vector<Eigen::Vector3d> points;
  for (const scan_match::Feature& f : features) {
    const Eigen::Vector3d p = level_from_lidar * f.point.cast<double>();
    if (p.head<2>().norm() > kRadius || p.z() > kHighest) continue;
    Column& column = columns[cell_of(p)];
    column.low = std::min(column.low, p.z());
    column.high = std::max(column.high, p.z());
    points.push_back(p);
  }
  std::erase_if(points, [&](const Eigen::Vector3d& p) {
    const Column& column = columns[cell_of(p)];
    return column.high - column.low < kCurb;
  });
  return points;
}

BirdView bird_view(const std::vector<Eigen::Vector3d>& standing) { return {whitened_spectrum(raster(standing, 0))}; }

TurnedViews turned_views(const std::vector<Eigen::Vector3d>& standing) {
  TurnedViews out;
  for (int i = 0; i < kHeadings / 2; ++i)  // half a turn on, the spectrum is the conjugate
    out.spectra.push_back(whitened_spectrum(raster(standing, 2 * std::numbers::pi * i / kHeadings)));
  return out;
}

std::vector<PlacementGuess> correlate(const BirdView& a, const TurnedViews& b, std::size_t count) {
  struct Peak {
    double score;
    int heading, x, y;
  };
  constexpr int kPeaksAHeading = 6, kReach = static_cast<int>(kFarthestShift / kColumn);
  const int apart = static_cast<int>(std::ceil(kApart / kColumn));
  std::vector<Peak> peaks;
  for (int heading = 0; heading < kHeadings; ++heading) {
    cv::Mat2f product;
    const bool turned_about = heading >= kHeadings / 2;
    cv::mulSpectrums(a.spectrum, b.spectra[static_cast<std::size_t>(heading % (kHeadings / 2))], product, 0, !turned_about);
    cv::Mat1f score;
    cv::dft(product, score, cv::DFT_INVERSE | cv::DFT_REAL_OUTPUT);
    cv::Mat1f reachable(2 * kReach + 1, 2 * kReach + 1);
    for (int y = -kReach; y <= kReach; ++y)
      for (int x = -kReach; x <= kReach; ++x)
        reachable(y + kReach, x + kReach) = score((y + kCells) % kCells, (x + kCells) % kCells);
    for (int k = 0; k < kPeaksAHeading; ++k) {
      double most = 0;
      cv::Point at;
      cv::minMaxLoc(reachable, nullptr, &most, nullptr, &at);
      peaks.push_back({most, heading, at.x - kReach, at.y - kReach});
      const cv::Rect round(at.x - apart, at.y - apart, 2 * apart + 1, 2 * apart + 1);
      reachable(round & cv::Rect(0, 0, reachable.cols, reachable.rows)) = -1;
    }
  }
  std::stable_sort(peaks.begin(), peaks.end(), [](const Peak& p, const Peak& q) { return p.score > q.score; });
  std::vector<Peak> best;
  for (const Peak& p : peaks) {
    const bool seen = std::any_of(best.begin(), best.end(), [&](const Peak& q) {
      const int turn = std::abs(p.heading - q.heading);
      return std::min(turn, kHeadings - turn) <= kHeadingsApart && std::hypot(p.x - q.x, p.y - q.y) * kColumn < 2 * kApart;
    });
    if (!seen) best.push_back(p);
    if (best.size() == count) break;
  }
  std::vector<PlacementGuess> out;
  for (const Peak& p : best)
    out.push_back(
        {p.score, {so3_exp({0, 0, 2 * std::numbers::pi * p.heading / kHeadings}), {p.x * kColumn, p.y * kColumn, 0}}});
  return out;
}

}  // namespace dvi::registration
