#include "dvi/diagnostics/flow_pairs.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "dvi/core/median.h"
#include "dvi/core/threads.h"
#include "dvi/drive/deskew.h"
#include "dvi/drive/nearest_in_time.h"
#include "dvi/image/gray.h"
#include "dvi/image/optical_flow.h"

namespace dvi::diagnostics {
namespace {

constexpr std::size_t kPairs = 9;                         // of all tracks
constexpr std::size_t kApart[] = {1, 2, 3, 5, 8};         // frames: the nearest that shows enough motion
constexpr double kParallaxPx = 4;                         // of a return at the median range: well above the error of flow
constexpr std::size_t kReturns = 20000;                   // of a scan
constexpr int kWidest = 1400;                             // px
constexpr double kReturnsTo = 1, kReturnsToShare = 0.05;  // px and share of the flow by which the way back may miss

/// Where a pair is made: frames and the scan next to the first, as indices of the drive.
struct Stop {
  std::size_t from = 0, to = 0, scan = 0;
};

double median_range(const Scan& scan) {
  std::vector<float> ranges;
  for (std::size_t i = 0; i < scan.size(); i += 16) ranges.push_back(scan.points[i].norm());
  return median(std::move(ranges));
}

std::size_t scan_next_to(const Drive& drive, const ScanTrack& track, std::int64_t time_ns) {
  const auto begin = drive.scan_headers.begin();
  const auto nearest = nearest_in_time(begin + static_cast<std::ptrdiff_t>(track.first),
                                       begin + static_cast<std::ptrdiff_t>(track.last), time_ns);
  return static_cast<std::size_t>(nearest - begin);
}

std::optional<Stop> stop_at(const Drive& drive, const ScanTrack& track, std::size_t frame) {
  const auto here = track.world_from_lidar.at(drive.frames[frame].time_ns);
  if (!here) return std::nullopt;
  const std::size_t scan = scan_next_to(drive, track, drive.frames[frame].time_ns);
  const double range = median_range(*drive.scans[scan]);
  for (const std::size_t apart : kApart) {
    if (frame + apart >= drive.frames.size()) break;
    const auto there = track.world_from_lidar.at(drive.frames[frame + apart].time_ns);
    if (there && (there->t - here->t).norm() * drive.camera.fx >= kParallaxPx * range) return Stop{frame, frame + apart, scan};
  }
  return std::nullopt;
}

/// Some of the frames taken along a track, evenly spread.
std::vector<std::size_t> frames_along(const Drive& drive, const ScanTrack& track, std::size_t most) {
  const std::int64_t begin = drive.scan_headers[track.first].time_ns, end = drive.scan_headers[track.last - 1].time_ns;
  std::vector<std::size_t> all, some;
  for (std::size_t i = 0; i < drive.frames.size(); ++i)
    if (drive.frames[i].time_ns >= begin && drive.frames[i].time_ns < end) all.push_back(i);
  const std::size_t count = std::min(most, all.size());
  for (std::size_t k = 0; k < count; ++k) some.push_back(all[(2 * k + 1) * all.size() / (2 * count)]);
  return some;
}

/// Gray, halved until it is no wider than kWidest. Pixel x of it is pixel x * 2^halvings of the image.
cv::Mat1b small_gray(const cv::Mat3b& image) {
  cv::Mat1b gray = gray_8bit(image);
  while (gray.cols > kWidest) {
    cv::Mat1b half;
    cv::pyrDown(gray, half);
    gray = half;
  }
  return gray;
}

Camera small_camera(Camera camera) {
  while (camera.width > kWidest) {
    camera.width = (camera.width + 1) / 2, camera.height = (camera.height + 1) / 2;
    camera.fx /= 2, camera.fy /= 2, camera.cx /= 2, camera.cy /= 2;
  }
  return camera;
}

void drop_masked(const cv::Mat1b& mask, cv::Mat2f& flow) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const int step = (mask.cols + flow.cols - 1) / flow.cols;
  for (int y = 0; y < flow.rows; ++y)
    for (int x = 0; x < flow.cols; ++x)
      if (mask(std::min(y * step, mask.rows - 1), std::min(x * step, mask.cols - 1)) != 0) flow(y, x) = {nan, nan};
}

/// The flow where the flow back returns to where it began.
cv::Mat2f sure_flow(const cv::Mat1b& from, const cv::Mat1b& to) {
  cv::Mat2f flow = compute_optical_flow(from, to);
  const cv::Mat2f back = compute_optical_flow(to, from);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (int y = 0; y < flow.rows; ++y)
    for (int x = 0; x < flow.cols; ++x) {
      cv::Vec2f& f = flow(y, x);
      const int u = cvRound(static_cast<float>(x) + f[0]), v = cvRound(static_cast<float>(y) + f[1]);
      const bool inside = u >= 0 && v >= 0 && u < flow.cols && v < flow.rows;
      if (!inside || cv::norm(f + back(v, u)) > kReturnsTo + kReturnsToShare * cv::norm(f)) f = {nan, nan};
    }
  return flow;
}

FlowPair pair_of(const Drive& drive, const ScanTrack& track, const Lazy<cv::Mat1b>& masks, const Stop& stop) {
  FlowPair out{drive.frames[stop.from].time_ns, drive.frames[stop.to].time_ns, {}, track.world_from_lidar, {}};
  const auto scan = drive.scans[stop.scan];
  const std::size_t step = std::max<std::size_t>(1, scan->size() / kReturns);
  const std::vector<Eigen::Vector3d> world = to_world(*scan, drive.scan_headers[stop.scan], track.world_from_lidar, step);
  for (std::size_t i = 0; i < world.size(); i += step) out.returns.push_back(world[i]);
  out.flow = sure_flow(small_gray(*drive.images[stop.from]), small_gray(*drive.images[stop.to]));
  if (!masks.empty()) drop_masked(*masks[stop.from], out.flow);
  return out;
}

}  // namespace

FlowPairs flow_pairs(const Drive& drive, const std::vector<ScanTrack>& tracks, const Lazy<cv::Mat1b>& masks) {
  FlowPairs out{small_camera(drive.camera), {}};
  if (tracks.empty() || std::min(out.camera.width, out.camera.height) < kMinFlowSidePx) return out;
  std::vector<std::pair<const ScanTrack*, std::size_t>> places;
  for (const ScanTrack& track : tracks)
    for (const std::size_t frame : frames_along(drive, track, kPairs / tracks.size())) places.emplace_back(&track, frame);
  std::vector<std::optional<FlowPair>> found(places.size());
  parallel_for(places.size(), [&](std::size_t k) {
    const auto& [track, frame] = places[k];
    if (const auto stop = stop_at(drive, *track, frame)) found[k] = pair_of(drive, *track, masks, *stop);
  });
  for (std::optional<FlowPair>& pair : found)
    if (pair && !pair->returns.empty()) out.pairs.push_back(std::move(*pair));
  return out;
}

}  // namespace dvi::diagnostics
