#include "dvi/scan_match/rings.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dvi/geometry/angles.h"

namespace dvi::scan_match {
namespace {

using Lists = std::vector<std::vector<std::uint32_t>>;

constexpr double kRevolutionRad = 2 * std::numbers::pi;
constexpr std::size_t kMinBeams = 8, kMaxBeams = 160;  // limits for a LiDAR

float compute_elevation(const Eigen::Vector3f& p) { return std::atan2(p.z(), std::hypot(p.x(), p.y())); }

void drop_empty(Lists& lists) {
  std::erase_if(lists, [](const auto& list) { return list.empty(); });
}

// Files usually have the points of a beam in the order of firing; if they do not, the times are used.
void sort_by_time(Lists& lists, const Scan& scan) {
  const auto earlier = [&](std::uint32_t a, std::uint32_t b) { return scan.time[a] < scan.time[b]; };
  for (auto& list : lists)
    if (!std::is_sorted(list.begin(), list.end(), earlier)) std::stable_sort(list.begin(), list.end(), earlier);
}

// Within a beam, the elevation varies much less than between beams.
bool are_beams(const Lists& lists, const Scan& scan) {
  if (lists.size() < kMinBeams || lists.size() > kMaxBeams) return false;
  float low = 10, high = -10;
  double change = 0;
  std::size_t count = 0;
  for (const auto& list : lists)
    for (std::size_t k = 8; k < list.size(); k += 8, ++count) {
      const float here = compute_elevation(scan.points[list[k]]);
      low = std::min(low, here), high = std::max(high, here);
      change += std::abs(here - compute_elevation(scan.points[list[k - 1]]));
    }
  return change < 0.5 * static_cast<double>(count) * (high - low) / static_cast<double>(lists.size());
}

Lists group_by_number(const Scan& scan) {
  Lists lists(1 + *std::max_element(scan.ring.begin(), scan.ring.end()));
  for (std::uint32_t i = 0; i < scan.size(); ++i) lists[scan.ring[i]].push_back(i);
  drop_empty(lists);
  return lists;
}

// Begins a new beam after each revolution of the azimuth. Returns nothing if the result are not beams.
Lists group_by_revolution(const Scan& scan) {
  constexpr double kMaxBackRad = 0.05;  // by which a return may be behind the previous one
  const auto azimuth = [&](std::size_t i) { return std::atan2(scan.points[i].y(), scan.points[i].x()); };
  std::size_t forward = 0;
  for (std::size_t i = 1; i < scan.size(); i += 16)
    forward += std::remainder(azimuth(i) - azimuth(i - 1), kRevolutionRad) > 0 ? 1 : 0;
  const double sign = 32 * forward > scan.size() ? 1 : -1;
  Lists lists(1);
  double turned = 0, before = azimuth(0);
  for (std::uint32_t i = 0; i < scan.size(); ++i) {
    const double now = azimuth(i);
    double step = sign * (now - before);
    step -= kRevolutionRad * std::floor((step + kMaxBackRad) / kRevolutionRad);
    before = now;
    turned += step;
    if (turned >= kRevolutionRad * static_cast<double>(lists.size())) {
      if (lists.size() == kMaxBeams) return {};
      lists.emplace_back();
    }
    lists.back().push_back(i);
  }
  return lists;
}

// Groups points by gaps between their elevations. Returns nothing if there are no groups.
Lists group_by_elevation(const Scan& scan) {
  constexpr double kBinRad = to_radians(0.05);
  constexpr int kBins = 3600;  // from straight down to straight up
  const auto bin_of = [&](std::size_t i) {
    return std::clamp(static_cast<int>((compute_elevation(scan.points[i]) + 0.25 * kRevolutionRad) / kBinRad), 0, kBins - 1);
  };
  std::vector<std::size_t> histogram(kBins, 0);
  for (std::size_t i = 0; i < scan.size(); ++i) ++histogram[static_cast<std::size_t>(bin_of(i))];
  const std::size_t floor = scan.size() / 20'000;  // bins with fewer points are outliers
  std::vector<int> group(kBins, -1);
  int groups = 0, filled = 0, last = -1, first = -1;
  for (int b = 0; b < kBins; ++b) {
    const auto at = static_cast<std::size_t>(b);
    if (histogram[at] <= floor) continue;
    if (last < 0 || b > last + 1) ++groups;
    if (first < 0) first = b;
    group[at] = groups - 1;
    ++filled;
    last = b;
  }
  const auto count = static_cast<std::size_t>(groups);
  if (count < kMinBeams || count > kMaxBeams || 2 * filled > last - first) return {};
  Lists lists(count);
  for (std::uint32_t i = 0; i < scan.size(); ++i)
    if (const int g = group[static_cast<std::size_t>(bin_of(i))]; g >= 0) lists[static_cast<std::size_t>(g)].push_back(i);
  return lists;
}

}  // namespace

Rings find_rings(const Scan& scan) {
  if (scan.size() == 0) return {};
  if (!scan.ring.empty()) {
    Lists lists = group_by_number(scan);
    sort_by_time(lists, scan);
    if (are_beams(lists, scan)) return {Rings::Source::file, std::move(lists)};
  }
  if (Lists lists = group_by_revolution(scan); are_beams(lists, scan)) return {Rings::Source::order, std::move(lists)};
  if (Lists lists = group_by_elevation(scan); !lists.empty()) {
    sort_by_time(lists, scan);
    return {Rings::Source::elevation, std::move(lists)};
  }
  return {};
}

const char* to_string(Rings::Source source) {
  switch (source) {
    case Rings::Source::file:
      return "file";
    case Rings::Source::order:
      return "order";
    case Rings::Source::elevation:
      return "elevation";
    case Rings::Source::none:
      return "none";
  }
  return "";
}

}  // namespace dvi::scan_match
