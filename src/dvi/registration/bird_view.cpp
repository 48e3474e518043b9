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

struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double height = 0;  // height of the origin above the plane, in meters
  bool found = false;
};

Plane fit_ground_plane(const std::vector<scan_match::Feature>& planes) {
  scan_match::LocalMap map(kGroundPlane.voxel_m);
  for (const scan_match::Feature& f : planes)
    if (f.point.head<2>().norm() < kGroundPlane.max_range_m) map.add(f.point.cast<double>());
  std::vector<Eigen::Vector3d> level;
  map.each([&](const scan_match::Shape& shape) {
    if (shape.thin == 1 && std::abs(shape.axes(2, 0)) > kGroundPlane.min_normal_z && shape.mean.z() < 0)
      level.push_back(shape.mean);
  });
  if (level.size() < 6) return {};
  std::vector<double> heights;
  for (const Eigen::Vector3d& x : level) heights.push_back(x.z());
  Eigen::Vector3d abc(0, 0, median(std::move(heights)));  // z = a x + b y + c
  for (int i = 0; i < 20; ++i) {
    const double scale = std::max(kGroundPlane.max_distance_m, 2.0 / (1 + i));  // graduated, so that a slope is found
    Eigen::Matrix3d H = 1e-6 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& x : level) {
      const Eigen::Vector3d J(x.x(), x.y(), 1);
      const double r = x.z() - J.dot(abc), robust = scale * scale / (scale * scale + r * r);
      H += robust * robust * J * J.transpose();
      b += robust * robust * r * J;
    }
    abc += H.ldlt().solve(b);
  }
  const double scale = 1 / std::sqrt(1 + abc.x() * abc.x() + abc.y() * abc.y());
  return {scale * Eigen::Vector3d(-abc.x(), -abc.y(), 1), -abc.z() * scale, true};
}

cv::Mat1f rasterize(const std::vector<Eigen::Vector3d>& upright, double heading) {
  cv::Mat1f view(kBirdView.size_cells, kBirdView.size_cells, 0.0F);
  const double c = std::cos(heading), s = std::sin(heading);
  for (const Eigen::Vector3d& p : upright) {
    const double x = (c * p.x() - s * p.y()) / kBirdView.cell_m + 0.5 * kBirdView.size_cells,
                 y = (s * p.x() + c * p.y()) / kBirdView.cell_m + 0.5 * kBirdView.size_cells;
    const int x0 = cvFloor(x), y0 = cvFloor(y);
    if (x0 < 0 || y0 < 0 || x0 + 1 >= kBirdView.size_cells || y0 + 1 >= kBirdView.size_cells) continue;
    for (const int dy : {0, 1})
      for (const int dx : {0, 1}) {
        const double weight = (dx == 1 ? x - x0 : 1 - x + x0) * (dy == 1 ? y - y0 : 1 - y + y0);
        float& cell = view(y0 + dy, x0 + dx);
        cell = std::max(cell, static_cast<float>(weight));
      }
  }
  return view;
}

cv::Mat2f to_whitened_spectrum(const cv::Mat1f& view) {
  cv::Mat2f out;
  cv::dft(view, out, cv::DFT_COMPLEX_OUTPUT);
  double energy = 0;
  for (cv::Vec2f& v : out) {
    const float size = std::hypot(v[0], v[1]);
    v *= size > 0 ? std::pow(size, -static_cast<float>(kBirdView.whitening)) : 0.0F;
    energy += v.dot(v);
  }
  if (energy > 0) out *= 1 / std::sqrt(energy);
  return out;
}

}  // namespace

SE3 level_from_lidar(const std::vector<scan_match::Feature>& planes) {
  const Plane ground = fit_ground_plane(planes);
  if (!ground.found) return {};
  const Eigen::Vector3d axis = ground.normal.cross(Eigen::Vector3d::UnitZ());
  const double angle = std::atan2(axis.norm(), ground.normal.z());
  const Eigen::Matrix3d R = axis.norm() > 0 ? so3_exp(angle * axis.normalized()) : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  return {R, {0, 0, ground.height}};
}

std::vector<Eigen::Vector3d> extract_upright_points(const std::vector<scan_match::Feature>& features,
                                                    const SE3& level_from_lidar) {
  struct Column {
    double low = 1e9, high = -1e9;
  };
  std::map<std::pair<int, int>, Column> columns;
  const auto cell_of = [](const Eigen::Vector3d& p) {
    return std::pair(cvFloor(p.x() / kBirdView.cell_m), cvFloor(p.y() / kBirdView.cell_m));
  };
  std::vector<Eigen::Vector3d> points;
  for (const scan_match::Feature& f : features) {
    const Eigen::Vector3d p = level_from_lidar * f.point.cast<double>();
    if (p.head<2>().norm() > kBirdView.radius_m || p.z() > kBirdView.max_height_m) continue;
    Column& column = columns[cell_of(p)];
    column.low = std::min(column.low, p.z());
    column.high = std::max(column.high, p.z());
    points.push_back(p);
  }
  std::erase_if(points, [&](const Eigen::Vector3d& p) {
    const Column& column = columns[cell_of(p)];
    return column.high - column.low < kBirdView.min_column_height_m;
  });
  return points;
}

BirdView make_bird_view(const std::vector<Eigen::Vector3d>& upright) { return {to_whitened_spectrum(rasterize(upright, 0))}; }

RotatedViews make_rotated_views(const std::vector<Eigen::Vector3d>& upright) {
  RotatedViews out;
  for (int i = 0; i < kBirdView.headings / 2; ++i)  // the spectrum of a view rotated by half a turn is the conjugate
    out.spectra.push_back(to_whitened_spectrum(rasterize(upright, 2 * std::numbers::pi * i / kBirdView.headings)));
  return out;
}

std::vector<PlacementGuess> correlate(const BirdView& a, const RotatedViews& b, std::size_t count) {
  struct Peak {
    double score;
    int heading, x, y;
  };
  constexpr int kMaxShiftCells = static_cast<int>(kBirdView.max_shift_m / kBirdView.cell_m);
  const int apart = static_cast<int>(std::ceil(kBirdView.min_peak_distance_m / kBirdView.cell_m));
  std::vector<Peak> peaks;
  for (int heading = 0; heading < kBirdView.headings; ++heading) {
    cv::Mat2f product;
    const bool opposite = heading >= kBirdView.headings / 2;
    cv::mulSpectrums(a.spectrum, b.spectra[static_cast<std::size_t>(heading % (kBirdView.headings / 2))], product, 0,
                     !opposite);
    cv::Mat1f score;
    cv::dft(product, score, cv::DFT_INVERSE | cv::DFT_REAL_OUTPUT);
    cv::Mat1f reachable(2 * kMaxShiftCells + 1, 2 * kMaxShiftCells + 1);
    for (int y = -kMaxShiftCells; y <= kMaxShiftCells; ++y)
      for (int x = -kMaxShiftCells; x <= kMaxShiftCells; ++x)
        reachable(y + kMaxShiftCells, x + kMaxShiftCells) =
            score((y + kBirdView.size_cells) % kBirdView.size_cells, (x + kBirdView.size_cells) % kBirdView.size_cells);
    for (int k = 0; k < kBirdView.peaks_per_heading; ++k) {
      double score_at_peak = 0;
      cv::Point at;
      cv::minMaxLoc(reachable, nullptr, &score_at_peak, nullptr, &at);
      peaks.push_back({score_at_peak, heading, at.x - kMaxShiftCells, at.y - kMaxShiftCells});
      const cv::Rect around(at.x - apart, at.y - apart, 2 * apart + 1, 2 * apart + 1);
      reachable(around & cv::Rect(0, 0, reachable.cols, reachable.rows)) = -1;
    }
  }
  std::stable_sort(peaks.begin(), peaks.end(), [](const Peak& p, const Peak& q) { return p.score > q.score; });
  std::vector<Peak> best;
  for (const Peak& p : peaks) {
    const bool known = std::any_of(best.begin(), best.end(), [&](const Peak& q) {
      const int turn = std::abs(p.heading - q.heading);
      return std::min(turn, kBirdView.headings - turn) <= kBirdView.min_heading_difference &&
             std::hypot(p.x - q.x, p.y - q.y) * kBirdView.cell_m < 2 * kBirdView.min_peak_distance_m;
    });
    if (!known) best.push_back(p);
    if (best.size() == count) break;
  }
  std::vector<PlacementGuess> out;
  for (const Peak& p : best)
    out.push_back({p.score,
                   {so3_exp({0, 0, 2 * std::numbers::pi * p.heading / kBirdView.headings}),
                    {p.x * kBirdView.cell_m, p.y * kBirdView.cell_m, 0}}});
  return out;
}

}  // namespace dvi::registration
