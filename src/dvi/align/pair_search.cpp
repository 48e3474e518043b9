#include "dvi/align/pair_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "dvi/image/interpolate.h"
#include "dvi/image/region.h"
#include "dvi/map/visible_points.h"

namespace dvi {
namespace {

constexpr std::size_t kCached = 24;                // views whose images, z-buffers and rings are kept
constexpr std::array<double, 3> kBlur{4, 2, 0.8};  // px, a level
constexpr std::array<double, 2> kLevelStep{3, 1};  // px: a coarser step than this works on that level
constexpr double kCoarsestStepDeg = 0.16;
constexpr int kBufferScale = 4;
constexpr double kSplat = 0.1;       // metres
constexpr double kTolerance = 0.05;  // of depth
constexpr double kOutlier = 60;      // grey levels over three channels: beyond, a difference counts no more
constexpr int kMaskMargin = 5;       // px
constexpr std::size_t kFewest = 60;  // points

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

std::vector<cv::Mat3b> blurred(const cv::Mat3b& image) {
  std::vector<cv::Mat3b> levels;
  for (const double sigma : kBlur) cv::GaussianBlur(image, levels.emplace_back(), {}, sigma);
  return levels;
}

cv::Mat1f coarse_z_buffer(const StaticMap& map, View view) {
  view.camera.width /= kBufferScale;
  view.camera.height /= kBufferScale;
  for (double* v : {&view.camera.fx, &view.camera.fy, &view.camera.cx, &view.camera.cy}) *v /= kBufferScale;
  cv::Mat1f z(view.camera.height, view.camera.width, 1e9F);
  for (const VisiblePoint& p : visible_points(map, view, kSplat, kTolerance)) {
    const int x = cvRound(p.u), y = cvRound(p.v);
    const cv::Rect around = cv::Rect(x - 1, y - 1, 3, 3) & cv::Rect({}, z.size());
    for (int row = around.y; row < around.br().y; ++row)
      for (int col = around.x; col < around.br().x; ++col) z(row, col) = std::min(z(row, col), p.z);
  }
  return z;
}

RingPoints ring_points(const StaticMap& map, const View& view, const cv::Mat1b& mask, const AlignOptions& options) {
  const cv::Mat1b near = grown(mask, kMaskMargin);
  cv::Mat1b ring(mask.size(), uchar{255});
  // Distance instead of a dilation: a disc of 100 px is slow to dilate by.
  if (cv::countNonZero(mask) > 0) {
    cv::Mat1f distance;
    cv::distanceTransform(mask == 0, distance, cv::DIST_L2, 3);
    ring = distance < options.ring_px;
  }
  ring.setTo(0, near);
  RingPoints all;
  for (const VisiblePoint& p : visible_points(map, view, kSplat, kTolerance))
    if (ring(cvRound(p.v), cvRound(p.u)) != 0) all.emplace_back(p.world.cast<double>());
  const std::size_t most = static_cast<std::size_t>(options.points);
  if (all.size() <= most) return all;
  RingPoints thinned(most);
  for (std::size_t i = 0; i < most; ++i) thinned[i] = all[i * all.size() / most];
  return thinned;
}

}  // namespace

Eigen::Matrix3d pitch_yaw(double pitch, double yaw) {
  return (Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()))
      .toRotationMatrix();
}

Comparison::Comparison(const Views& views, const StaticMap& map, const AlignOptions& options)
    : views_(views), map_(map), options_(options) {
  levels_ = {views.size(), kCached, [this](std::size_t i) { return blurred(*views_.images[i]); }};
  z_buffers_ = {views.size(), kCached, [this](std::size_t i) { return coarse_z_buffer(map_, views_[i]); }};
  rings_ = {views.size(), kCached, [this](std::size_t i) { return ring_points(map_, views_[i], *views_.masks[i], options_); }};
}

SE3 Comparison::pose(std::size_t view, const std::vector<Eigen::Vector2d>& corrections) const {
  const Eigen::Vector2d& c = corrections[view];
  return SE3{pitch_yaw(c.x(), c.y()), Eigen::Vector3d::Zero()} * views_[view].camera_from_world;
}

std::vector<Comparison::Sample> Comparison::samples(std::size_t moving, std::size_t fixed,
                                                    const std::vector<Eigen::Vector2d>& corrections) const {
  const View& view = views_[fixed];
  const SE3 fixed_from_world = pose(fixed, corrections), moving_from_world = pose(moving, corrections);
  const auto mask = views_.masks[fixed];
  const auto z_buffer = z_buffers_[fixed];
  const auto levels = levels_[fixed];
  std::vector<Sample> out;
  const auto ring = rings_[moving];
  for (const Eigen::Vector3d& world : *ring) {
    const Eigen::Vector3d p = fixed_from_world * world;
    if (!view.camera.in_front(p)) continue;
    const Eigen::Vector2d pixel = view.camera.project(p);
    if (!view.camera.contains(pixel)) continue;
    const cv::Point2f at(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
    if ((*mask)(cvRound(at.y), cvRound(at.x)) != 0) continue;
    const int x = std::min(z_buffer->cols - 1, cvRound(at.x) / kBufferScale);
    const int y = std::min(z_buffer->rows - 1, cvRound(at.y) / kBufferScale);
    if (p.z() > (*z_buffer)(y, x) * (1 + 2 * kTolerance)) continue;
    Sample sample{moving_from_world * world, {}};
    for (const cv::Mat3b& level : *levels) sample.colour.push_back(bilinear(level, at));
    out.push_back(std::move(sample));
  }
  if (out.size() < kFewest) return {};

  // The two frames may be exposed differently: bring the fixed one's colours to the moving one's mean.
  const auto image = levels_[moving];
  cv::Vec3f sum_moving(1, 1, 1), sum_fixed(1, 1, 1);
  for (const Sample& s : out) {
    const Eigen::Vector2d pixel = views_[moving].camera.project(s.in_camera);
    if (!views_[moving].camera.contains(pixel)) continue;
    sum_moving += bilinear(image->front(), {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())});
    sum_fixed += s.colour.front();
  }
  for (Sample& s : out)
    for (cv::Vec3f& c : s.colour)
      for (int k = 0; k < 3; ++k) c[k] *= sum_moving[k] / sum_fixed[k];
  return out;
}

double Comparison::energy_at(const std::vector<Sample>& samples, std::size_t view, std::size_t level,
                             const Eigen::Vector2d& angle) const {
  const Eigen::Matrix3d rotation = pitch_yaw(angle.x(), angle.y());
  const Camera& camera = views_[view].camera;
  const auto levels = levels_[view];
  const cv::Mat3b& image = (*levels)[level];
  double sum = 0;
  for (const Sample& s : samples) {
    const Eigen::Vector2d pixel = camera.project(rotation * s.in_camera);
    double e = kOutlier * kOutlier;
    if (camera.contains(pixel)) {
      const cv::Vec3f c = bilinear(image, {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())}) - s.colour[level];
      e = std::min(e, static_cast<double>(c.dot(c)));
    }
    sum += e;
  }
  return sum / static_cast<double>(samples.size());
}

std::optional<Comparison::Match> Comparison::energy(std::size_t moving, std::size_t fixed,
                                                    const std::vector<Eigen::Vector2d>& corrections) const {
  const std::vector<Sample> s = samples(moving, fixed, corrections);
  if (s.empty()) return std::nullopt;
  Match match;
  match.points = static_cast<int>(s.size());
  match.energy = energy_at(s, moving, kBlur.size() - 1, {0, 0});
  return match;
}

std::optional<Comparison::Match> Comparison::match(std::size_t moving, std::size_t fixed,
                                                   const std::vector<Eigen::Vector2d>& corrections) const {
  const std::vector<Sample> s = samples(moving, fixed, corrections);
  if (s.empty()) return std::nullopt;
  const double focal = views_[moving].camera.fx, limit = radians(options_.max_angle_deg);
  const double finest = radians(options_.finest_step_deg);
  Match match;
  match.points = static_cast<int>(s.size());
  std::size_t level = 0;
  double best = 0;
  for (double step = radians(kCoarsestStepDeg); step > 0.75 * finest; step /= 2) {
    level = 0;
    while (level < kLevelStep.size() && step * focal < kLevelStep[level]) ++level;
    best = energy_at(s, moving, level, match.angle);
    for (bool moved = true; moved;) {
      moved = false;
      const Eigen::Vector2d centre = match.angle;
      for (const Eigen::Vector2d& d :
           {Eigen::Vector2d(1, 0), Eigen::Vector2d(-1, 0), Eigen::Vector2d(0, 1), Eigen::Vector2d(0, -1)}) {
        const Eigen::Vector2d angle = centre + step * d;
        if (angle.cwiseAbs().maxCoeff() > limit) continue;
        const double e = energy_at(s, moving, level, angle);
        if (e < best) {
          best = e;
          match.angle = angle;
          moved = true;
        }
      }
    }
  }
  match.energy = energy_at(s, moving, level, {0, 0});
  // Curvature two pixels' tenth away: flat directions (a bare road) get no say in the joint solution.
  const double h = std::max(finest, 0.5 / focal);
  for (int axis = 0; axis < 2; ++axis) {
    Eigen::Vector2d d = Eigen::Vector2d::Zero();
    d[axis] = h;
    const double e = energy_at(s, moving, level, match.angle + d) + energy_at(s, moving, level, match.angle - d) - 2 * best;
    match.weight[axis] = std::max(0.0, e / (h * h)) * match.points / (best + 1);
  }
  return match;
}

}  // namespace dvi
