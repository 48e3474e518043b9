#include "dvi/plausibility/label_doubts.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "dvi/core/threads.h"

namespace dvi::plausibility {
namespace {

constexpr std::size_t kFrames = 12;
constexpr std::int64_t kNextToBox = 60'000'000;       // ns
constexpr double kNearestBox = 3, kFarthestBox = 40;  // metres
constexpr double kShrink = 0.1, kGround = 0.3;        // metres: labels are loose, and stand on ground that returns
constexpr std::size_t kFewestRays = 30;               // rays that meet a box, so that it counts
constexpr double kSeenThrough = 0.9;                  // of them reach beyond: windows are not all of a vehicle
constexpr std::size_t kFewestBoxes = 10, kFewestFrames = 3;
constexpr double kMostThrough = 0.25;  // of the boxes; of right ones one in a hundred is

struct Boxes {
  std::size_t seen = 0, seen_through = 0;
};

/// Where the way from the LiDAR to a return enters and leaves the box, as shares of the way; leaves before it enters: misses.
std::pair<double, double> crossing(const Box& box, const Eigen::Vector3d& x) {
  const Eigen::Vector3d begin = box.frame_from_box.inverse().t, way = box.frame_from_box.R.transpose() * x;
  Eigen::Array3d low = -0.5 * box.size.array() + kShrink;
  const Eigen::Array3d high = 0.5 * box.size.array() - kShrink;
  low.z() += kGround - kShrink;
  const Eigen::Array3d a = (low - begin.array()) / way.array(), b = (high - begin.array()) / way.array();
  return {a.min(b).maxCoeff(), a.max(b).minCoeff()};
}

bool is_seen_through(const Box& box, const Scan& scan, bool& counts) {
  const double reach = 0.5 * box.size.norm();
  const Eigen::Vector3f centre = box.frame_from_box.t.cast<float>();
  std::size_t inside = 0, beyond = 0;
  for (const Eigen::Vector3f& point : scan.points) {
    const float along = point.dot(centre) / std::max(point.norm(), 1e-3F);
    if (along <= 0 || centre.squaredNorm() - along * along > static_cast<float>(reach * reach)) continue;
    const auto [enters, leaves] = crossing(box, point.cast<double>());
    if (enters > leaves || enters > 1) continue;
    (leaves < 1 ? beyond : inside) += 1;
  }
  counts = inside + beyond >= kFewestRays;
  return counts && static_cast<double>(beyond) >= kSeenThrough * static_cast<double>(inside + beyond);
}

Boxes boxes_of(const Drive& drive, const Frame& frame) {
  Boxes out;
  const auto off = [&](const ScanHeader& h) { return std::abs(h.time_ns - frame.time_ns); };
  const auto nearest = std::min_element(drive.scan_headers.begin(), drive.scan_headers.end(),
                                        [&](const ScanHeader& a, const ScanHeader& b) { return off(a) < off(b); });
  if (nearest == drive.scan_headers.end() || off(*nearest) > kNextToBox) return out;
  const auto scan = drive.scans[static_cast<std::size_t>(nearest - drive.scan_headers.begin())];
  for (const Label& label : frame.labels) {
    if (!label.box) continue;
    const double range = label.box->frame_from_box.t.norm();
    if (range < kNearestBox || range > kFarthestBox) continue;
    bool counts = false;
    const bool through = is_seen_through(*label.box, *scan, counts);
    out.seen += counts ? 1 : 0;
    out.seen_through += through ? 1 : 0;
  }
  return out;
}

}  // namespace

std::vector<std::string> label_doubts(const Drive& drive) {
  std::vector<std::size_t> labelled;
  for (std::size_t i = 0; i < drive.frames.size(); ++i)
    if (std::any_of(drive.frames[i].labels.begin(), drive.frames[i].labels.end(),
                    [](const Label& l) { return l.box.has_value(); }))
      labelled.push_back(i);
  const std::size_t count = std::min(kFrames, labelled.size());
  std::vector<Boxes> found(count);
  parallel_for(count, [&](std::size_t k) {
    found[k] = boxes_of(drive, drive.frames[labelled[(2 * k + 1) * labelled.size() / (2 * count)]]);
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
      fmt::format("the LiDAR looks through {} of {} labelled boxes: the labels look like those of another drive, of other "
                  "frames, or of other axes",
                  all.seen_through, all.seen)};
}

}  // namespace dvi::plausibility
