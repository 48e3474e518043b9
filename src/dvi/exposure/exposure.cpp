#include "dvi/exposure/exposure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "dvi/core/lazy.h"
#include "dvi/core/median.h"
#include "dvi/core/threads.h"
#include "dvi/drive/near_views.h"
#include "dvi/geometry/normal_equations.h"
#include "dvi/image/region.h"
#include "dvi/map/visible_points.h"

namespace dvi::exposure {
namespace {

// Views that are compared: neighbours in time, and some farther apart that keep the chain from drifting.
constexpr std::array<std::size_t, 5> kApart{1, 2, 4, 8, 16};
constexpr std::size_t kPlaces = 3;   // views of earlier sequences, nearest in place, that one of another is compared with
constexpr double kRadian = 10;       // metres that count as much as a radian between directions
constexpr double kBlur = 2.5;        // px: poses are not refined yet
constexpr int kMargin = 6;           // px round masks and saturated pixels that the blur reaches
constexpr uchar kBlack = 8;          // grey levels; darker, noise and the sensor's offset outweigh the light
constexpr uchar kSaturated = 250;    // grey levels
constexpr std::size_t kFewest = 50;  // points
constexpr double kFloor = 0.005;     // of a ratio's logarithm: what no number of points makes surer
constexpr double kOutlier = 0.03;    // of a ratio's logarithm: from here on a pair counts less
constexpr double kWeakest = 1e-6;    // the weight of "gain 1" against that of a sure pair; fixes what no pair tells
constexpr int kRounds = 10;          // of reweighting
constexpr double kLargest = 1.3863;  // of a gain's logarithm: 1/4 .. 4

/// A point of the map with the logarithm of its colour in a view.
struct Sighting {
  std::size_t point = 0;
  cv::Vec3f colour;
};

/// What a view shows of the map, in order of points.
using Sightings = std::vector<Sighting>;

/// Pixels whose surroundings are unmasked, neither black nor saturated.
cv::Mat1b usable(const cv::Mat3b& image, const cv::Mat1b& mask) {
  cv::Mat1b bad, black, within;
  cv::inRange(image, cv::Scalar::all(0), cv::Scalar::all(kSaturated - 1), within);
  cv::inRange(image, cv::Scalar::all(0), cv::Scalar::all(kBlack - 1), black);
  cv::bitwise_or(mask, black, bad);
  cv::bitwise_or(bad, ~within, bad);
  cv::Mat1b out;
  cv::bitwise_not(grown(bad, kMargin), out);
  return out;
}

Sightings sightings(const std::vector<map::VisiblePoint>& points, const cv::Mat3b& image, const cv::Mat1b& mask) {
  const cv::Mat1b use = usable(image, mask);
  cv::Mat3f colours;
  image.convertTo(colours, CV_32FC3);
  cv::GaussianBlur(colours, colours, {}, kBlur);
  Sightings out;
  for (const map::VisiblePoint& p : points) {
    const cv::Point at(cvRound(p.u), cvRound(p.v));
    if (use(at) == 0) continue;
    const cv::Vec3f& c = colours(at);
    if (std::min({c[0], c[1], c[2]}) < static_cast<float>(kBlack)) continue;
    out.push_back({p.index, {std::log(c[0]), std::log(c[1]), std::log(c[2])}});
  }
  std::sort(out.begin(), out.end(), [](const Sighting& a, const Sighting& b) { return a.point < b.point; });
  return out;
}

/// How two views' logarithms of gain differ, as the points they share say.
struct Pair {
  std::size_t a = 0, b = 0;
  std::array<double, 3> ratio{};   ///< of b's colours to a's, so gain a - gain b
  std::array<double, 3> weight{};  ///< 1 / variance
};

/// Appends the pair if the views share enough points.
void compare(std::size_t a, std::size_t b, const Lazy<Sightings>& seen, std::vector<Pair>& out) {
  const std::shared_ptr<const Sightings> in_a = seen[a], in_b = seen[b];
  std::array<std::vector<float>, 3> ratios;
  for (auto i = in_a->begin(), j = in_b->begin(); i != in_a->end() && j != in_b->end();) {
    if (i->point == j->point)
      for (int c = 0; c < 3; ++c) ratios[c].push_back(j->colour[c] - i->colour[c]);
    const std::size_t first = std::min(i->point, j->point);
    if (i->point == first) ++i;
    if (j != in_b->end() && j->point == first) ++j;
  }
  if (ratios[0].size() < kFewest) return;
  Pair pair{a, b, {}, {}};
  for (int c = 0; c < 3; ++c) {
    pair.ratio[c] = median(ratios[c]);
    for (float& r : ratios[c]) r = static_cast<float>(std::abs(r - pair.ratio[c]));
    const double sigma = 1.4826 * median(ratios[c]);
    pair.weight[c] = 1 / (kFloor * kFloor + sigma * sigma / static_cast<double>(ratios[c].size()));
  }
  out.push_back(pair);
}

/// The views of earlier sequences that look from nearest to where a view does, by place and direction.
std::vector<std::size_t> places(const Views& views, std::size_t view) {
  return nearest_views(views, view, {0, views.of_sequence(views[view].sequence).first}, kPlaces, kRadian);
}

std::vector<Pair> compare_all(const Views& views, const map::VisibleMap& map, const Tick& tick) {
  const Lazy<Sightings> seen(views.size(),
                             [&](std::size_t i) { return sightings(*map.points[i], *views.images[i], *views.masks[i]); });
  std::vector<std::vector<Pair>> of_view(views.size());
  parallel_in_order(views.size(), [&](std::size_t i) {
    if (!shares_colours(views[i], views[0])) return tick();
    for (const std::size_t apart : kApart)
      if (apart <= i && views[i - apart].sequence == views[i].sequence) compare(i - apart, i, seen, of_view[i]);
    for (const std::size_t other : places(views, i))
      if (shares_colours(views[other], views[i])) compare(other, i, seen, of_view[i]);
    tick();
  });
  std::vector<Pair> pairs;
  for (const auto& some : of_view) pairs.insert(pairs.end(), some.begin(), some.end());
  return pairs;
}

/// min over g of sum w rho(g_a - g_b - ratio) + weakest sum g^2, one channel; rho is Cauchy's.
Eigen::VectorXd solve(const std::vector<Pair>& pairs, std::size_t views, int channel) {
  const auto n = static_cast<Eigen::Index>(views);
  Eigen::VectorXd gain = Eigen::VectorXd::Zero(n);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    for (Eigen::Index i = 0; i < n; ++i) entries.emplace_back(i, i, kWeakest / (kFloor * kFloor));
    for (const Pair& p : pairs) {
      const auto a = static_cast<Eigen::Index>(p.a), b = static_cast<Eigen::Index>(p.b);
      const double off = round == 0 ? 0 : (gain[a] - gain[b] - p.ratio[channel]) / kOutlier;
      const double w = p.weight[channel] / (1 + off * off);
      entries.emplace_back(a, a, w);
      entries.emplace_back(b, b, w);
      entries.emplace_back(a, b, -w);
      entries.emplace_back(b, a, -w);
      right[a] += w * p.ratio[channel];
      right[b] -= w * p.ratio[channel];
    }
    gain = solve_normal_equations(entries, right);
  }
  return gain;
}

}  // namespace

Gains estimate_exposure(const Views& views, const map::VisibleMap& map, const Tick& tick) {
  Gains gains(views.size());
  const std::vector<Pair> pairs = compare_all(views, map, tick);
  for (const Pair& p : pairs) {
    ++gains.compared[p.a];
    ++gains.compared[p.b];
  }
  for (int c = 0; c < 3; ++c) {
    const Eigen::VectorXd gain = solve(pairs, views.size(), c);
    for (std::size_t i = 0; i < views.size(); ++i)
      gains.of_view[i][c] = static_cast<float>(std::exp(std::clamp(gain[static_cast<Eigen::Index>(i)], -kLargest, kLargest)));
  }
  return gains;
}

}  // namespace dvi::exposure
