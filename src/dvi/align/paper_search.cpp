#include "dvi/align/paper_search.h"

#include <array>

#include <opencv2/imgproc.hpp>

#include "dvi/align/unmasked_points.h"
#include "dvi/core/threads.h"
#include "dvi/image/interpolate.h"

namespace dvi::align {
namespace {

constexpr std::array<double, 2> kStepsRad{1e-3, 1e-4};
constexpr int kStepsToEachSide = 10;

struct Sample {
  Eigen::Vector3d in_camera;  // camera axes of the view that is searched
  cv::Vec3f color;            // in the neighbor
};

cv::Vec3f sample_color(const cv::Mat3b& image, const Eigen::Vector2d& pixel) {
  return bilinear(image, {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())});
}

/// Selects the points in the ring around the mask (in the whole image if there is no mask), evenly thinned.
std::vector<map::VisiblePoint> select_ring_points(const UnmaskedPoints& sight, const cv::Mat1b& mask,
                                                  const AlignOptions& options) {
  cv::Mat1f distance(mask.size(), 0.0F);  // faster than a dilation by a disc of 100 px
  if (cv::countNonZero(mask) > 0) cv::distanceTransform(mask == 0, distance, cv::DIST_L2, 3);
  std::vector<map::VisiblePoint> ring;
  for (const map::VisiblePoint& p : sight.points())
    if (distance(cvRound(p.v), cvRound(p.u)) < static_cast<float>(options.ring_px)) ring.push_back(p);
  const auto max_points = static_cast<std::size_t>(options.points);
  if (ring.size() <= max_points) return ring;
  std::vector<map::VisiblePoint> thinned(max_points);
  for (std::size_t i = 0; i < max_points; ++i) thinned[i] = ring[i * ring.size() / max_points];
  return thinned;
}

/// A neighboring frame whose colors the search compares.
struct Neighbor {
  const View& view;
  const cv::Mat3b& image;
  const UnmaskedPoints& sight;
};

void add_samples(const std::vector<map::VisiblePoint>& ring, const View& view, const Neighbor& neighbor,
                 std::vector<Sample>& samples) {
  for (const map::VisiblePoint& point : ring) {
    const Eigen::Vector3d world = point.world.cast<double>(), p = neighbor.view.camera_from_world * world;
    if (!neighbor.view.camera.in_front(p)) continue;
    const Eigen::Vector2d pixel = neighbor.view.camera.project(p);
    if (neighbor.view.camera.contains(pixel) && neighbor.sight.is_visible(pixel, neighbor.view.camera.depth(p)))
      samples.push_back({view.camera_from_world * world, sample_color(neighbor.image, pixel)});
  }
}

/// Computes eq. 1 as a mean over the points that stay in the image.
double compute_energy(const std::vector<Sample>& samples, const Camera& camera, const cv::Mat3b& image,
                      const Eigen::Vector2d& angle) {
  const Eigen::Matrix3d R = so3_exp({angle.x(), angle.y(), 0});
  double sum = 0, count = 0;
  for (const Sample& s : samples) {
    const Eigen::Vector2d pixel = camera.project(R * s.in_camera);
    if (!camera.contains(pixel)) continue;
    const cv::Vec3f difference = sample_color(image, pixel) - s.color;
    sum += difference.dot(difference);
    count += 1;
  }
  return count > 0 ? sum / count : 0;
}

Eigen::Vector2d search_angle(const std::vector<Sample>& samples, const Camera& camera, const cv::Mat3b& image) {
  Eigen::Vector2d angle = Eigen::Vector2d::Zero();
  for (const double step : kStepsRad) {
    const Eigen::Vector2d center = angle;
    double lowest = compute_energy(samples, camera, image, center);
    for (int i = -kStepsToEachSide; i <= kStepsToEachSide; ++i)
      for (int j = -kStepsToEachSide; j <= kStepsToEachSide; ++j) {
        const Eigen::Vector2d candidate = center + step * Eigen::Vector2d(i, j);
        const double e = compute_energy(samples, camera, image, candidate);
        if (e >= lowest) continue;
        lowest = e;
        angle = candidate;
      }
  }
  return angle;
}

}  // namespace

void search_as_published(const SequenceViews& sequence, const AlignOptions& options, const Tick& tick, Cameras& out) {
  const Views& views = sequence.views;
  const std::size_t first = sequence.first, last = sequence.last;
  const Lazy<UnmaskedPoints> sights(
      last - first, [&](std::size_t i) { return UnmaskedPoints(*sequence.map.points[first + i], *views.masks[first + i]); });
  parallel_in_order(last - first, [&](std::size_t i) {
    const View& view = views[first + i];
    const std::vector<map::VisiblePoint> ring = select_ring_points(*sights[i], *views.masks[first + i], options);
    std::vector<Sample> samples;
    const auto add_neighbor = [&](std::size_t k) {
      add_samples(ring, view, {views[first + k], *views.images[first + k], *sights[k]}, samples);
    };
    if (i > 0) add_neighbor(i - 1);
    if (first + i + 1 < last) add_neighbor(i + 1);
    const Eigen::Vector2d angle = search_angle(samples, view.camera, *views.images[first + i]);
    ViewAlignment& found = out.views[first + i];
    found.rotation = {angle.x(), angle.y(), 0};
    found.points = static_cast<int>(samples.size());
    tick();
  });
  for (std::size_t i = first; i < last; ++i)
    out.camera_from_world[i] = SE3{so3_exp(out.views[i].rotation), {0, 0, 0}} * views[i].camera_from_world;
}

}  // namespace dvi::align
