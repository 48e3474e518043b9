#include "dvi/diagnostics/label_doubts.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "dvi/core/threads.h"
#include "dvi/drive/nearest_in_time.h"

namespace dvi::diagnostics {
namespace {

constexpr std::size_t kFrames = 12;
constexpr std::int64_t kNextToBox = 60'000'000;       // ns
constexpr double kNearestBox = 3, kFarthestBox = 40;  // meters
constexpr double kShortest = 2.5;                     // meters: rays pass between the legs of people and the parts of cycles
// A vehicle's core, as shares of its box: below the windows, above what is open between the wheels, away from bevelled ends.
// Right labels, a hand's breadth too wide or too narrow, do not let rays reach it.
constexpr double kCoreWidth = 0.7, kCoreBottom = 0.25, kCoreTop = 0.55;
constexpr double kLoose = 0.2;           // meters by which returns may lie before a box
constexpr std::size_t kFewestRays = 30;  // rays that meet a box, so that it counts
constexpr double kSeenThrough = 0.5;     // of them go through the core
constexpr std::size_t kFewestBoxes = 10, kFewestFrames = 3;
constexpr double kMostThrough = 0.25;  // of the boxes; of right ones hardly any is, of another drive's three in four are

struct Boxes {
  std::size_t seen = 0, seen_through = 0;
};

/// Where the way from the LiDAR to x enters and leaves a part of a box, as shares of the way; leaves before it enters: misses.
/// All in the box's axes.
std::pair<double, double> crossing(const Eigen::Array3d& low, const Eigen::Array3d& high, const Eigen::Array3d& lidar,
                                   const Eigen::Array3d& way) {
  const Eigen::Array3d a = (low - lidar) / way, b = (high - lidar) / way;
  return {a.min(b).maxCoeff(), a.max(b).minCoeff()};
}

/// Of the rays toward the box's core that something before it does not stop: whether most reach beyond. None for too few.
std::optional<bool> is_seen_through(const Box& box, const Scan& scan) {
  const Eigen::Array3d half = 0.5 * box.size.array(), outer = half + kLoose;
  Eigen::Array3d low = -kCoreWidth * half, high = kCoreWidth * half;
  low.z() = (2 * kCoreBottom - 1) * half.z(), high.z() = (2 * kCoreTop - 1) * half.z();
  const Eigen::Array3d lidar = box.frame_from_box.inverse().t.array();
  const auto reach = static_cast<float>(half.matrix().squaredNorm());
  const Eigen::Vector3f center = box.frame_from_box.t.cast<float>();
  std::size_t stopped = 0, beyond = 0;
  for (const Eigen::Vector3f& point : scan.points) {
    const float along = point.dot(center) / std::max(point.norm(), 1e-3F);
    if (along <= 0 || center.squaredNorm() - along * along > reach) continue;
    const Eigen::Array3d way = (box.frame_from_box.R.transpose() * point.cast<double>()).array();
    const auto [enters, leaves] = crossing(low, high, lidar, way);
    if (enters > leaves || crossing(-outer, outer, lidar, way).first > 1) continue;
    (leaves < 1 ? beyond : stopped) += 1;
  }
  if (stopped + beyond < kFewestRays) return std::nullopt;
  return static_cast<double>(beyond) > kSeenThrough * static_cast<double>(stopped + beyond);
}

Boxes boxes_of(const Drive& drive, const Frame& frame) {
  Boxes out;
  const ScanHeader* const nearest = nearest_in_time(drive.scan_headers, frame.time_ns, kNextToBox);
  if (!nearest) return out;
  const auto scan = drive.scans[static_cast<std::size_t>(nearest - drive.scan_headers.data())];
  for (const Label& label : frame.labels) {
    if (!label.box) continue;
    const double range = label.box->frame_from_box.t.norm();
    if (range < kNearestBox || range > kFarthestBox || label.box->size.head<2>().maxCoeff() < kShortest) continue;
    const std::optional<bool> through = is_seen_through(*label.box, *scan);
    out.seen += through ? 1 : 0;
    out.seen_through += through.value_or(false) ? 1 : 0;
  }
  return out;
}

}  // namespace

std::vector<std::string> label_doubts(const Drive& drive) {
  std::vector<std::size_t> labeled;
  for (std::size_t i = 0; i < drive.frames.size(); ++i)
    if (std::any_of(drive.frames[i].labels.begin(), drive.frames[i].labels.end(),
                    [](const Label& l) { return l.box.has_value(); }))
      labeled.push_back(i);
  const std::size_t count = std::min(kFrames, labeled.size());
  std::vector<Boxes> found(count);
  parallel_for(count, [&](std::size_t k) {
    found[k] = boxes_of(drive, drive.frames[labeled[(2 * k + 1) * labeled.size() / (2 * count)]]);
  });
  Boxes all;
  std::size_t frames = 0;
  for (const Boxes& boxes : found) {
    all.seen += boxes.seen, all.seen_through += boxes.seen_through;
    frames += boxes.seen > 0 ? 1 : 0;
  }
  if (all.seen < kFewestBoxes || frames < kFewestFrames ||
      static_cast<double>(all.seen_through) <= kMostThrough * static_cast<double>(all.seen))
    return {};
  return {
      fmt::format("the LiDAR looks through {} of {} labeled boxes: the labels look like those of another drive, of other "
                  "frames, or of other axes",
                  all.seen_through, all.seen)};
}

}  // namespace dvi::diagnostics
