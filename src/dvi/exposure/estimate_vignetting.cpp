#include "dvi/exposure/estimate_vignetting.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "dvi/core/median.h"

namespace dvi::exposure {
namespace {

/// A point in two views, less the median of all points of these.
struct Ratio {
  float off_axis = 0;  ///< how much farther off the axis it lies in the first
  float brighter = 0;  ///< the logarithm of how much brighter it is in the second
};

std::vector<Ratio> ratios_of(const Sightings& a, const Sightings& b) {
  constexpr std::size_t kFewPoints = 50, kManyPoints = 1000;  // points of a pair; none outweighs the others
  std::vector<Ratio> all;
  for_each_shared(a, b, [&](const PointObservation& i, const PointObservation& j) {
    const cv::Vec3f brighter = j.color - i.color;
    all.push_back({i.off_axis - j.off_axis, (brighter[0] + brighter[1] + brighter[2]) / 3});
  });
  if (all.size() < kFewPoints) return {};
  std::vector<Ratio> out;
  for (std::size_t i = 0; i < all.size(); i += 1 + all.size() / kManyPoints) out.push_back(all[i]);
  for (float Ratio::* value : {&Ratio::off_axis, &Ratio::brighter}) {
    std::vector<float> values;
    for (const Ratio& r : out) values.push_back(r.*value);
    const float middle = median(std::move(values));
    for (Ratio& r : out) r.*value -= middle;
  }
  return out;
}

/// Cauchy's weight of what k leaves of a ratio.
float weight(const Ratio& r, float k) {
  constexpr float kOff = 0.05F;  // of a ratio's logarithm: from here on a point counts less
  const float off = (r.brighter - k * r.off_axis) / kOff;
  return 1 / (1 + off * off);
}

float fit(const std::vector<Ratio>& ratios) {
  constexpr int kIterations = 10;  // of reweighting
  float k = 0;
  for (int round = 0; round < kIterations; ++round) {
    double both = 0, square = 1e-9;
    for (const Ratio& r : ratios) {
      const double w = weight(r, k);
      both += w * r.off_axis * r.brighter;
      square += w * r.off_axis * r.off_axis;
    }
    k = static_cast<float>(both / square);
  }
  return k;
}

double cost(const std::vector<Ratio>& ratios, float k) {
  double sum = 0;
  for (const Ratio& r : ratios) sum -= std::log(weight(r, k));
  return sum;
}

float vignetting_of(std::size_t first, std::size_t last, const Lazy<Sightings>& seen) {
  constexpr std::size_t kPairs = 24;       // of views, spread over the sequence
  constexpr std::size_t kFramesApart = 4;  // views: points move far enough in the image, and still look alike
  constexpr float kLeast = 0.04F;          // k: a percent at half a radian
  constexpr float kMost = 2;               // k: the cos^4 law in linear light
  std::vector<Ratio> even, odd;
  const std::size_t step = std::max<std::size_t>(1, (last - first) / kPairs);
  for (std::size_t i = first, n = 0; i + kFramesApart < last; i += step, ++n) {
    const std::vector<Ratio> ratios = ratios_of(*seen[i], *seen[i + kFramesApart]);
    std::vector<Ratio>& half = n % 2 == 0 ? even : odd;
    half.insert(half.end(), ratios.begin(), ratios.end());
  }
  const bool shows = cost(odd, fit(even)) < cost(odd, 0) && cost(even, fit(odd)) < cost(even, 0);
  even.insert(even.end(), odd.begin(), odd.end());
  const float k = fit(even);
  return shows && k >= kLeast ? std::min(k, kMost) : 0;
}

}  // namespace

std::vector<float> estimate_vignetting(const Views& views, const Lazy<Sightings>& seen) {
  std::vector<float> out(views.size());
  for (int sequence = 0; sequence < views.sequences(); ++sequence) {
    const auto [first, last] = views.of_sequence(sequence);
    std::fill(out.begin() + static_cast<std::ptrdiff_t>(first), out.begin() + static_cast<std::ptrdiff_t>(last),
              vignetting_of(first, last, seen));
  }
  return out;
}

}  // namespace dvi::exposure
