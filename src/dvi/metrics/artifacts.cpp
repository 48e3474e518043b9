#include "dvi/metrics/artifacts.h"

#include <algorithm>
#include <array>
#include <cstdlib>

#include <opencv2/imgproc.hpp>

#include "dvi/core/lazy.h"
#include "dvi/core/threads.h"
#include "dvi/image/gray.h"
#include "dvi/image/optical_flow.h"
#include "dvi/media/image_file.h"

namespace dvi::metrics {
namespace {

constexpr int kRing = 40;       // px
constexpr int kFlash = 40;      // gray levels off both neighboring frames
constexpr int kAgree = 20;      // gray levels between these two
constexpr double kTail = 0.01;  // of the ring's pixels at either end of its range
constexpr int kGrace = 5;       // gray levels beyond the range
constexpr int kNeighbors = 5;   // px: width of the neighborhood
constexpr int kLone = 25;       // gray levels off its median

cv::Mat1b ring_round(const cv::Mat1b& mask) {
  cv::Mat1b ring;
  cv::dilate(mask, ring, cv::Mat1b(2 * kRing + 1, 2 * kRing + 1, uchar{1}));
  return cv::Mat1b(ring & ~mask);
}

struct Range {
  int low = 0, high = 255;
};

Range range_of(const cv::Mat1b& gray, const cv::Mat1b& pixels) {
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
  return count == 0 ? Range{} : Range{level(kTail), level(1 - kTail)};
}

std::size_t overshoots(const cv::Mat1b& gray, const cv::Mat1b& mask, const cv::Mat1b& ring) {
  const Range range = range_of(gray, ring);
  cv::Mat1b median;
  cv::medianBlur(gray, median, kNeighbors);
  std::size_t count = 0;
  for (int y = 0; y < gray.rows; ++y)
    for (int x = 0; x < gray.cols; ++x) {
      const int value = gray(y, x);
      const bool beyond = value < range.low - kGrace || value > range.high + kGrace;
      count += mask(y, x) != 0 && beyond && std::abs(value - median(y, x)) > kLone ? 1 : 0;
    }
  return count;
}

/// Another frame as seen from this one.
cv::Mat1b warped(const cv::Mat1b& now, const cv::Mat1b& other) {
  cv::Mat2f from = compute_optical_flow(now, other, FlowPreset::fast);
  from.forEach([](cv::Vec2f& flow, const int* at) { flow += cv::Vec2f(static_cast<float>(at[1]), static_cast<float>(at[0])); });
  cv::Mat1b out;
  cv::remap(other, out, from, {}, cv::INTER_LINEAR);
  return out;
}

cv::Mat1b flashes(const cv::Mat1b& now, const cv::Mat1b& before, const cv::Mat1b& behind) {
  const cv::Mat1b a = warped(now, before), b = warped(now, behind);
  cv::Mat1b off_a, off_b, apart;
  cv::absdiff(now, a, off_a);
  cv::absdiff(now, b, off_b);
  cv::absdiff(a, b, apart);
  return cv::Mat1b((off_a > kFlash) & (off_b > kFlash) & (apart < kAgree));
}

double ppm(std::size_t count, std::size_t of) {
  return 1e6 * static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(of, 1));
}

std::size_t pixels(const cv::Mat1b& mask) { return static_cast<std::size_t>(cv::countNonZero(mask)); }

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

double Artifacts::flash_ppm() const { return ppm(flashes, hole_between); }
double Artifacts::ring_flash_ppm() const { return ppm(ring_flashes, ring_between); }
double Artifacts::overshoot_ppm() const { return ppm(overshoots, hole); }

Artifacts count_artifacts(const fs::path& out, const std::vector<std::string>& names, const Tick& tick,
                          const std::function<fs::path(const std::string& name)>& filled) {
  const auto mask_of = [&](std::size_t i, cv::Size size) {
    return media::read_mask(out / "masks" / (names[i] + ".png"), size);
  };
  const Lazy<cv::Mat1b> gray(names.size(), [&](std::size_t i) {
    const fs::path file = out / "frames" / (names[i] + ".png");
    const cv::Size size = media::image_size(file);
    cv::Mat3b frame = media::read_image(file, size);
    if (filled)
      if (const cv::Mat1b mask = mask_of(i, size); cv::countNonZero(mask) > 0)
        media::read_image(filled(names[i]), size).copyTo(frame, mask);
    return gray_8bit(frame);
  });
  std::vector<Artifacts> found(names.size());
  parallel_in_order(names.size(), [&](std::size_t i) {
    tick();
    const auto now = gray[i];
    const cv::Mat1b mask = mask_of(i, now->size());
    Artifacts& counts = found[i];
    counts.hole = pixels(mask);
    if (counts.hole == 0) return;
    const cv::Mat1b ring = ring_round(mask);
    counts.overshoots = overshoots(*now, mask, ring);
    if (i == 0 || i + 1 == names.size() || std::min(now->rows, now->cols) < kMinFlowSidePx) return;
    const auto before = gray[i - 1], behind = gray[i + 1];
    if (before->size() != now->size() || behind->size() != now->size()) return;
    const cv::Mat1b flashing = flashes(*now, *before, *behind);
    counts.hole_between = counts.hole, counts.ring_between = pixels(ring);
    counts.flashes = pixels(cv::Mat1b(flashing & mask)), counts.ring_flashes = pixels(cv::Mat1b(flashing & ring));
  });
  Artifacts sum;
  for (const Artifacts& counts : found) sum += counts;
  return sum;
}

}  // namespace dvi::metrics
