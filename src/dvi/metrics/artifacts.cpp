#include "dvi/metrics/artifacts.h"

#include <algorithm>
#include <array>
#include <cstdlib>

#include <opencv2/imgproc.hpp>

#include "dvi/core/frame_name.h"
#include "dvi/core/lazy.h"
#include "dvi/core/threads.h"
#include "dvi/image/enlarge.h"
#include "dvi/image/gray.h"
#include "dvi/image/optical_flow.h"
#include "dvi/media/image_file.h"
#include "dvi/media/image_memory.h"

namespace dvi::metrics {
namespace {

cv::Mat1b find_boundary(const cv::Mat1b& mask) {
  cv::Mat1b boundary;
  cv::dilate(mask, boundary, cv::Mat1b(2 * kArtifact.boundary_px + 1, 2 * kArtifact.boundary_px + 1, uchar{1}));
  return cv::Mat1b(boundary & ~mask);
}

struct Range {
  int low = 0, high = 255;
};

Range compute_range(const cv::Mat1b& gray, const cv::Mat1b& pixels) {
  std::array<std::size_t, 256> levels{};
  std::size_t count = 0;
  for (int y = 0; y < gray.rows; ++y)
    for (int x = 0; x < gray.cols; ++x)
      if (pixels(y, x) != 0) ++levels[gray(y, x)], ++count;
  const auto level = [&](double share) {
    const double before = share * static_cast<double>(count);
    std::size_t passed = 0, at = 0;
    while (at < 255 && static_cast<double>(passed += levels[at]) <= before) ++at;
    return static_cast<int>(at);
  };
  return count == 0 ? Range{} : Range{level(kArtifact.tail_share), level(1 - kArtifact.tail_share)};
}

std::size_t count_overshoots(const cv::Mat1b& gray, const cv::Mat1b& mask, const cv::Mat1b& boundary) {
  const Range range = compute_range(gray, boundary);
  cv::Mat1b median;
  cv::medianBlur(gray, median, kArtifact.median_px);
  std::size_t count = 0;
  for (int y = 0; y < gray.rows; ++y)
    for (int x = 0; x < gray.cols; ++x) {
      const int value = gray(y, x);
      const bool is_outside = value < range.low - kArtifact.range_margin || value > range.high + kArtifact.range_margin;
      count += mask(y, x) != 0 && is_outside && std::abs(value - median(y, x)) > kArtifact.min_outlier ? 1 : 0;
    }
  return count;
}

/// The part of a frame that is compared: the hole, its boundary, and a margin for the optical flow.
cv::Rect find_compared_part(const cv::Mat1b& mask) {
  return enlarge(cv::boundingRect(mask), kArtifact.boundary_px + kArtifact.flow_margin_px, mask.size());
}

/// Warps another frame to this one by optical flow.
cv::Mat1b warp(const cv::Mat1b& now, const cv::Mat1b& other) {
  cv::Mat2f from = compute_optical_flow(now, other, FlowPreset::fast);
  from.forEach([](cv::Vec2f& flow, const int* at) { flow += cv::Vec2f(static_cast<float>(at[1]), static_cast<float>(at[0])); });
  cv::Mat1b out;
  cv::remap(other, out, from, {}, cv::INTER_LINEAR);
  return out;
}

cv::Mat1b find_flashes(const cv::Mat1b& now, const cv::Mat1b& before, const cv::Mat1b& after) {
  const cv::Mat1b a = warp(now, before), b = warp(now, after);
  cv::Mat1b off_a, off_b, apart;
  cv::absdiff(now, a, off_a);
  cv::absdiff(now, b, off_b);
  cv::absdiff(a, b, apart);
  return cv::Mat1b((off_a > kArtifact.min_flash) & (off_b > kArtifact.min_flash) & (apart < kArtifact.max_neighbor_change));
}

double to_ppm(std::size_t count, std::size_t of) {
  return 1e6 * static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(of, 1));
}

std::size_t count_pixels(const cv::Mat1b& mask) { return static_cast<std::size_t>(cv::countNonZero(mask)); }

constexpr std::size_t kArtifactBytesPerPixel = 40;  // memory of a frame while its artifacts are counted

}  // namespace

Artifacts& Artifacts::operator+=(const Artifacts& other) {
  hole += other.hole;
  overshoots += other.overshoots;
  hole_between += other.hole_between;
  ring_between += other.ring_between;
  flashes += other.flashes;
  ring_flashes += other.ring_flashes;
  return *this;
}

double Artifacts::flash_ppm() const { return to_ppm(flashes, hole_between); }
double Artifacts::ring_flash_ppm() const { return to_ppm(ring_flashes, ring_between); }
double Artifacts::overshoot_ppm() const { return to_ppm(overshoots, hole); }

Artifacts count_artifacts(const fs::path& out, const std::vector<std::string>& names, const Tick& tick,
                          const std::function<fs::path(const std::string& name)>& filled) {
  const auto read_mask = [&](std::size_t i, cv::Size size) {
    return media::read_mask(out / picture_file("masks", names[i]), size);
  };
  const Lazy<cv::Mat1b> gray(names.size(), [&](std::size_t i) {
    const fs::path file = out / picture_file("frames", names[i]);
    const cv::Size size = media::image_size(file);
    cv::Mat3b frame = media::read_image(file, size);
    if (filled)
      if (const cv::Mat1b mask = read_mask(i, size); cv::countNonZero(mask) > 0)
        media::read_image(filled(names[i]), size).copyTo(frame, mask);
    return gray_8bit(frame);
  });
  std::vector<Artifacts> found(names.size());
  const auto count = [&](std::size_t i) {
    tick();
    const auto whole = gray[i];
    const cv::Mat1b whole_mask = read_mask(i, whole->size());
    Artifacts& counts = found[i];
    counts.hole = count_pixels(whole_mask);
    if (counts.hole == 0) return;
    const cv::Rect part = find_compared_part(whole_mask);
    const cv::Mat1b now = (*whole)(part).clone(), mask = whole_mask(part).clone(), boundary = find_boundary(mask);
    counts.overshoots = count_overshoots(now, mask, boundary);
    const auto is_same_camera = [&](std::size_t other) { return camera_of_frame(names[i]) == camera_of_frame(names[other]); };
    if (i == 0 || i + 1 == names.size() || !is_same_camera(i - 1) || !is_same_camera(i + 1) ||
        std::min(part.width, part.height) < kMinFlowSidePx)
      return;
    const auto before = gray[i - 1], after = gray[i + 1];
    if (before->size() != whole->size() || after->size() != whole->size()) return;
    const cv::Mat1b flashing = find_flashes(now, (*before)(part).clone(), (*after)(part).clone());
    counts.hole_between = counts.hole, counts.ring_between = count_pixels(boundary);
    counts.flashes = count_pixels(cv::Mat1b(flashing & mask)),
    counts.ring_flashes = count_pixels(cv::Mat1b(flashing & boundary));
  };
  parallel_in_order(names.size(), count, media::estimate_image_bytes(out, "frames", names, kArtifactBytesPerPixel));
  Artifacts sum;
  for (const Artifacts& counts : found) sum += counts;
  return sum;
}

}  // namespace dvi::metrics
