#include "dvi/objects/reprojected_mask.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "dvi/drive/deskew.h"
#include "dvi/drive/nearest_in_time.h"
#include "dvi/drive/outline.h"

namespace dvi::objects {
namespace {

constexpr int kBlockPx = 4;        // pixels: rays of a LiDAR lie about as close
constexpr int kObjectBlocks = 6;   // blocks each way in which the nearest return is of the same object: a window is no wider
constexpr int kClosedGapPx = 25;   // pixels: an object seen from beside it is stretched, and has no holes
constexpr int kDrawnMarginPx = 4;  // pixels: calibration, and what lies between blocks
constexpr float kFarthestM = 1e4;  // meters: infinity, for any rig
constexpr float kNoDepth = std::numeric_limits<float>::max();

cv::Size blocks_of(const Camera& camera) {
  return {(camera.width + kBlockPx - 1) / kBlockPx, (camera.height + kBlockPx - 1) / kBlockPx};
}

cv::Rect pixels_of(cv::Point block, const Camera& camera) {
  return cv::Rect(block.x * kBlockPx, block.y * kBlockPx, kBlockPx, kBlockPx) & cv::Rect(0, 0, camera.width, camera.height);
}

/// The depth of the nearest return in each block, meters; kNoDepth where there is none.
cv::Mat1f nearest_depths(const RigCamera& view, const std::vector<Eigen::Vector3d>& returns) {
  cv::Mat1f out(blocks_of(view.camera), kNoDepth);
  for (const Eigen::Vector3d& point : returns) {
    const Eigen::Vector3d p = view.camera_from_world * point;
    if (p.z() < kNearPlane || !view.camera.in_front(p)) continue;
    const Eigen::Vector2d pixel = view.camera.project(p);
    if (!view.camera.contains(pixel)) continue;
    float& depth = out(cvRound(pixel.y()) / kBlockPx, cvRound(pixel.x()) / kBlockPx);
    depth = std::min(depth, static_cast<float>(p.z()));
  }
  return out;
}

// The least value in a window of so many blocks each way.
cv::Mat1f least_round(const cv::Mat1f& depths, int reach) {
  cv::Mat1f out;
  cv::erode(depths, out, cv::Mat1b(2 * reach + 1, 2 * reach + 1, uchar{1}));
  return out;
}

cv::Mat1b masked_blocks(const cv::Mat1b& mask, const Camera& camera) {
  cv::Mat1b out(blocks_of(camera), uchar{0});
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x)
      if (cv::countNonZero(mask(pixels_of({x, y}, camera))) > 0) out(y, x) = 255;
  return out;
}

// A block of one image as another shows it if it lies at that depth: pixels of the other, none where it is behind the camera.
std::array<Eigen::Vector2d, 2> extent(const cv::Rect& block, float depth, const Camera& from, const Camera& to,
                                      const SE3& to_from_from) {
  Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  for (const int x : {block.x, block.x + block.width})
    for (const int y : {block.y, block.y + block.height}) {
      const Eigen::Vector3d p = to_from_from * Eigen::Vector3d(static_cast<double>(depth) * from.ray({x - 0.5, y - 0.5}));
      const Eigen::Vector2d pixel = p.z() < kNearPlane ? Eigen::Vector2d(-1e9, -1e9) : to.project(p);
      low = low.cwiseMin(pixel);
      high = high.cwiseMax(pixel);
    }
  return {low, high};
}

// What the mask hides, drawn into the other image: each block as deep as the nearest return in it, and as the nearest of the
// object that it may belong to, for rays pass through glass.
void draw_hidden(const cv::Mat1b& mask, const cv::Mat1f& depths, const Camera& from, const Camera& to, const SE3& to_from_from,
                 cv::Mat1b& out) {
  const cv::Mat1b masked = masked_blocks(mask, from);
  cv::Mat1f own = depths.clone();
  own.setTo(kNoDepth, masked == 0);
  const cv::Mat1f object = least_round(own, kObjectBlocks);
  const float least = *std::min_element(own.begin(), own.end());
  for (int y = 0; y < masked.rows; ++y)
    for (int x = 0; x < masked.cols; ++x) {
      if (masked(y, x) == 0) continue;
      const cv::Rect block = pixels_of({x, y}, from);
      for (float depth : {own(y, x), object(y, x) == kNoDepth ? least : object(y, x)}) {
        if (depth == kNoDepth) continue;
        const auto [low, high] = extent(block, depth, from, to, to_from_from);
        cv::rectangle(out, to_drawing_pixel(low.x() - kDrawnMarginPx, low.y() - kDrawnMarginPx),
                      to_drawing_pixel(high.x() + kDrawnMarginPx, high.y() + kDrawnMarginPx), 255, cv::FILLED);
      }
    }
}

// What may lie outside of the first camera's image, which knows nothing of it.
void draw_outside(const cv::Mat1f& depths, const Camera& from, const Camera& to, const SE3& to_from_from, cv::Mat1b& out) {
  const cv::Mat1f nearest = least_round(depths, kObjectBlocks);
  for (int y = 0; y < nearest.rows; ++y)
    for (int x = 0; x < nearest.cols; ++x)
      for (const float depth : {nearest(y, x), kFarthestM}) {
        if (depth == kNoDepth) continue;
        const cv::Rect block = pixels_of({x, y}, from);
        const auto [low, high] = extent(block, depth, from, to, to_from_from);
        if (!to.contains(low) || !to.contains(high)) out(block) = 255;
      }
}

// The returns of the scan nearest to a time, world axes.
std::vector<Eigen::Vector3d> returns_near(const Drive& drive, std::int64_t time_ns, const Trajectory& world_from_lidar) {
  const auto nearest = nearest_in_time(drive.scan_headers.begin(), drive.scan_headers.end(), time_ns);
  if (nearest == drive.scan_headers.end() || time_ns < nearest->start_ns - kMaxRigGapNs ||
      time_ns > nearest->end_ns + kMaxRigGapNs)
    return {};
  return to_world(*drive.scans[static_cast<std::size_t>(nearest - drive.scan_headers.begin())], *nearest, world_from_lidar);
}

}  // namespace

cv::Mat1b reproject_mask(const cv::Mat1b& mask, const RigCamera& masked, const RigCamera& other,
                         const std::vector<Eigen::Vector3d>& returns) {
  const SE3 other_from_masked = other.camera_from_world * masked.camera_from_world.inverse();
  cv::Mat1b out(other.camera.height, other.camera.width, uchar{0});
  const cv::Mat1f depths = nearest_depths(masked, returns);
  const bool measured = std::any_of(depths.begin(), depths.end(), [](float depth) { return depth < kNoDepth; });
  if (!measured) return cv::Mat1b(out.size(), uchar{255});
  draw_hidden(mask, depths, masked.camera, other.camera, other_from_masked, out);
  cv::morphologyEx(out, out, cv::MORPH_CLOSE, cv::Mat1b(kClosedGapPx, kClosedGapPx, uchar{1}));
  draw_outside(nearest_depths(other, returns), other.camera, masked.camera, other_from_masked.inverse(), out);
  return out;
}

Lazy<cv::Mat1b> reproject_masks(const Drive& drive, const Lazy<cv::Mat1b>& own, const Drive& other,
                                const Trajectory& world_from_lidar) {
  return {other.frames.size(), [=](std::size_t i) {
            const Frame& frame = other.frames[i];
            const Frame* const together = nearest_in_time(drive.frames, frame.time_ns, kMaxRigGapNs);
            const auto here = world_from_lidar.at(frame.time_ns);
            const auto there = together ? world_from_lidar.at(together->time_ns) : std::nullopt;
            if (!here || !there) return cv::Mat1b(other.camera.height, other.camera.width, uchar{255});
            const auto mask = own[static_cast<std::size_t>(together - drive.frames.data())];
            return reproject_mask(*mask, {drive.camera, drive.camera_from_lidar * there->inverse()},
                                  {other.camera, other.camera_from_lidar * here->inverse()},
                                  returns_near(other, frame.time_ns, world_from_lidar));
          }};
}

}  // namespace dvi::objects
