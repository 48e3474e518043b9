#include "dvi/diagnostics/check_labels.h"

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

struct BoxCount {
  std::size_t judged = 0, passed = 0;
};

/// Returns where the ray from the LiDAR to a return enters and leaves a part of a box, as shares of the ray. A ray that leaves
/// before it enters misses the box. All vectors are in the axes of the box.
std::pair<double, double> intersect(const Eigen::Array3d& low, const Eigen::Array3d& high, const Eigen::Array3d& lidar,
                                    const Eigen::Array3d& ray) {
  const Eigen::Array3d a = (low - lidar) / ray, b = (high - lidar) / ray;
  return {a.min(b).maxCoeff(), a.max(b).minCoeff()};
}

/// Returns whether most rays toward the core of the box pass through it, not counting rays that end in front of the box;
/// nothing if there are too few rays.
std::optional<bool> is_passed(const Box& box, const Scan& scan) {
  const Eigen::Array3d half = 0.5 * box.size.array(), outer = half + kLabelCheck.box_tolerance_m;
  Eigen::Array3d low = -kLabelCheck.core_width * half, high = kLabelCheck.core_width * half;
  low.z() = (2 * kLabelCheck.core_bottom - 1) * half.z(), high.z() = (2 * kLabelCheck.core_top - 1) * half.z();
  const Eigen::Array3d lidar = box.frame_from_box.inverse().t.array();
  const auto radius2 = static_cast<float>(half.matrix().squaredNorm());
  const Eigen::Vector3f center = box.frame_from_box.t.cast<float>();
  std::size_t stopped = 0, beyond = 0;
  for (const Eigen::Vector3f& point : scan.points) {
    const float along = point.dot(center) / std::max(point.norm(), 1e-3F);
    if (along <= 0 || center.squaredNorm() - along * along > radius2) continue;
    const Eigen::Array3d ray = (box.frame_from_box.R.transpose() * point.cast<double>()).array();
    const auto [enters, leaves] = intersect(low, high, lidar, ray);
    if (enters > leaves || intersect(-outer, outer, lidar, ray).first > 1) continue;
    (leaves < 1 ? beyond : stopped) += 1;
  }
  if (stopped + beyond < kLabelCheck.min_rays) return std::nullopt;
  return static_cast<double>(beyond) > kLabelCheck.min_passed_rays * static_cast<double>(stopped + beyond);
}

BoxCount judge_boxes(const Drive& drive, const Frame& frame) {
  BoxCount out;
  const ScanHeader* const nearest = nearest_in_time(drive.scan_headers, frame.time_ns, kLabelCheck.max_scan_delay_ns);
  if (!nearest) return out;
  const auto scan = drive.scans[static_cast<std::size_t>(nearest - drive.scan_headers.data())];
  for (const Label& label : frame.labels) {
    if (!label.box) continue;
    const double range = label.box->frame_from_box.t.norm();
    if (range < kLabelCheck.min_range_m || range > kLabelCheck.max_range_m ||
        label.box->size.head<2>().maxCoeff() < kLabelCheck.min_length_m)
      continue;
    const std::optional<bool> passed = is_passed(*label.box, *scan);
    out.judged += passed ? 1 : 0;
    out.passed += passed.value_or(false) ? 1 : 0;
  }
  return out;
}

}  // namespace

std::vector<std::string> check_labels(const Drive& drive) {
  std::vector<std::size_t> labeled;
  for (std::size_t i = 0; i < drive.frames.size(); ++i)
    if (std::any_of(drive.frames[i].labels.begin(), drive.frames[i].labels.end(),
                    [](const Label& l) { return l.box.has_value(); }))
      labeled.push_back(i);
  const std::size_t count = std::min(kLabelCheck.max_frames, labeled.size());
  std::vector<BoxCount> found(count);
  parallel_for(count, [&](std::size_t k) {
    found[k] = judge_boxes(drive, drive.frames[labeled[(2 * k + 1) * labeled.size() / (2 * count)]]);
  });
  BoxCount all;
  std::size_t frames = 0;
  for (const BoxCount& boxes : found) {
    all.judged += boxes.judged, all.passed += boxes.passed;
    frames += boxes.judged > 0 ? 1 : 0;
  }
  if (all.judged < kLabelCheck.min_boxes || frames < kLabelCheck.min_frames ||
      static_cast<double>(all.passed) <= kLabelCheck.max_passed_boxes * static_cast<double>(all.judged))
    return {};
  return {
      fmt::format("rays of the LiDAR pass through {} of {} labeled boxes: the labels seem to be of another drive, of other "
                  "frames, or in other axes; check the label file",
                  all.passed, all.judged)};
}

}  // namespace dvi::diagnostics
