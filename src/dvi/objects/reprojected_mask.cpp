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

struct ReprojectionParams {
  int block_px = 4;        ///< side of a block; about the distance between the rays of a LiDAR
  int object_blocks = 6;   ///< radius in which the nearest return is taken to be of the same object: a car window is not wider
  int closed_gap_px = 25;  ///< gaps in the result that are closed: another view stretches an object, which has no holes
  int margin_px = 4;       ///< margin of each drawn block: errors of the calibration, and gaps between blocks
  float infinity_m = 1e4;  ///< a depth that has no parallax in any rig
};
constexpr ReprojectionParams kReprojection{};

constexpr float kNoDepth = std::numeric_limits<float>::max();

// A camera that pixels are reprojected from, and the camera that they are reprojected to.
struct CameraPair {
  const Camera& from;
  const Camera& to;
  SE3 to_from_from;
};

cv::Size count_blocks(const Camera& camera) {
  const int side = kReprojection.block_px;
  return {(camera.width + side - 1) / side, (camera.height + side - 1) / side};
}

cv::Rect to_pixels(cv::Point block, const Camera& camera) {
  const int side = kReprojection.block_px;
  return cv::Rect(block.x * side, block.y * side, side, side) & cv::Rect(0, 0, camera.width, camera.height);
}

// Returns the depth in meters of the nearest return in each block, and kNoDepth where there is none.
cv::Mat1f find_nearest_depths(const RigCamera& view, const std::vector<Eigen::Vector3d>& returns) {
  cv::Mat1f out(count_blocks(view.camera), kNoDepth);
  for (const Eigen::Vector3d& point : returns) {
    const Eigen::Vector3d p = view.camera_from_world * point;
    if (view.camera.depth(p) < kNearPlane || !view.camera.in_front(p)) continue;
    const Eigen::Vector2d pixel = view.camera.project(p);
    if (!view.camera.contains(pixel)) continue;
    float& depth = out(cvRound(pixel.y()) / kReprojection.block_px, cvRound(pixel.x()) / kReprojection.block_px);
    depth = std::min(depth, static_cast<float>(view.camera.depth(p)));
  }
  return out;
}

// Returns the smallest depth around each block, within the radius of one object.
cv::Mat1f find_object_depths(const cv::Mat1f& depths) {
  const int side = 2 * kReprojection.object_blocks + 1;
  cv::Mat1f out;
  cv::erode(depths, out, cv::Mat1b(side, side, uchar{1}));
  return out;
}

cv::Mat1b find_masked_blocks(const cv::Mat1b& mask, const Camera& camera) {
  cv::Mat1b out(count_blocks(camera), uchar{0});
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x)
      if (cv::countNonZero(mask(to_pixels({x, y}, camera))) > 0) out(y, x) = 255;
  return out;
}

// Reprojects a block at a depth. Returns the corners of its bounding rectangle in the other image; they lie far outside of the
// image if the block is behind the camera.
std::array<Eigen::Vector2d, 2> reproject_block(const cv::Rect& block, float depth, const CameraPair& cameras) {
  Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  for (const int x : {block.x, block.x + block.width})
    for (const int y : {block.y, block.y + block.height}) {
      const Eigen::Vector3d p =
          cameras.to_from_from * Eigen::Vector3d(static_cast<double>(depth) * cameras.from.ray({x - 0.5, y - 0.5}));
      const Eigen::Vector2d pixel = is_beyond_near_plane(p, cameras.to) ? cameras.to.project(p) : Eigen::Vector2d(-1e9, -1e9);
      low = low.cwiseMin(pixel);
      high = high.cwiseMax(pixel);
    }
  return {low, high};
}

// Draws the masked blocks into the other image: at the depth of the nearest return in the block, and at the depth of the
// nearest return of the object that it may belong to, because rays pass through glass.
void draw_masked(const cv::Mat1b& mask, const cv::Mat1f& depths, const CameraPair& cameras, cv::Mat1b& out) {
  const cv::Mat1b masked = find_masked_blocks(mask, cameras.from);
  cv::Mat1f own = depths.clone();
  own.setTo(kNoDepth, masked == 0);
  const cv::Mat1f object = find_object_depths(own);
  const float nearest = *std::min_element(own.begin(), own.end());
  for (int y = 0; y < masked.rows; ++y)
    for (int x = 0; x < masked.cols; ++x) {
      if (masked(y, x) == 0) continue;
      const cv::Rect block = to_pixels({x, y}, cameras.from);
      for (float depth : {own(y, x), object(y, x) == kNoDepth ? nearest : object(y, x)}) {
        if (depth == kNoDepth) continue;
        const auto [low, high] = reproject_block(block, depth, cameras);
        const int margin_px = kReprojection.margin_px;
        cv::rectangle(out, to_drawing_pixel(low.x() - margin_px, low.y() - margin_px),
                      to_drawing_pixel(high.x() + margin_px, high.y() + margin_px), 255, cv::FILLED);
      }
    }
}

// Masks the blocks whose surfaces may lie outside of the masked camera's image. `cameras.to` is the masked camera.
void draw_outside(const cv::Mat1f& depths, const CameraPair& cameras, cv::Mat1b& out) {
  const cv::Mat1f nearest = find_object_depths(depths);
  for (int y = 0; y < nearest.rows; ++y)
    for (int x = 0; x < nearest.cols; ++x)
      for (const float depth : {nearest(y, x), kReprojection.infinity_m}) {
        if (depth == kNoDepth) continue;
        const cv::Rect block = to_pixels({x, y}, cameras.from);
        const auto [low, high] = reproject_block(block, depth, cameras);
        if (!cameras.to.contains(low) || !cameras.to.contains(high)) out(block) = 255;
      }
}

// Returns the returns of the scan nearest to a time, world axes.
std::vector<Eigen::Vector3d> read_returns(const Drive& drive, std::int64_t time_ns, const Trajectory& world_from_lidar) {
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
  const cv::Mat1f depths = find_nearest_depths(masked, returns);
  const bool measured = std::any_of(depths.begin(), depths.end(), [](float depth) { return depth < kNoDepth; });
  if (!measured) return cv::Mat1b(out.size(), uchar{255});
  draw_masked(mask, depths, {masked.camera, other.camera, other_from_masked}, out);
  const int gap_px = kReprojection.closed_gap_px;
  cv::morphologyEx(out, out, cv::MORPH_CLOSE, cv::Mat1b(gap_px, gap_px, uchar{1}));
  draw_outside(find_nearest_depths(other, returns), {other.camera, masked.camera, other_from_masked.inverse()}, out);
  return out;
}

Lazy<cv::Mat1b> reproject_masks(const Drive& drive, const Lazy<cv::Mat1b>& own, const Drive& other,
                                const Trajectory& world_from_lidar) {
  return {other.frames.size(), [=](std::size_t i) {
            const Frame& frame = other.frames[i];
            const Frame* const simultaneous = nearest_in_time(drive.frames, frame.time_ns, kMaxRigGapNs);
            const auto here = world_from_lidar.at(frame.time_ns);
            const auto there = simultaneous ? world_from_lidar.at(simultaneous->time_ns) : std::nullopt;
            if (!here || !there) return cv::Mat1b(other.camera.height, other.camera.width, uchar{255});
            const auto mask = own[static_cast<std::size_t>(simultaneous - drive.frames.data())];
            return reproject_mask(*mask, {drive.camera, drive.camera_from_lidar * there->inverse()},
                                  {other.camera, other.camera_from_lidar * here->inverse()},
                                  read_returns(other, frame.time_ns, world_from_lidar));
          }};
}

}  // namespace dvi::objects
