#include "dvi/objects/carried.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "dvi/drive/outline.h"

namespace dvi::objects {
namespace {

constexpr int kBlock = 4;         // pixels: rays of a LiDAR lie about as close
constexpr int kObject = 6;        // blocks each way in which the nearest return is of the same object: a window is no wider
constexpr int kGap = 25;          // pixels: an object seen from beside it is stretched, and has no holes
constexpr int kMargin = 4;        // pixels: calibration, and what lies between blocks
constexpr float kFarthest = 1e4;  // meters: infinity, for any rig
constexpr float kNone = std::numeric_limits<float>::max();

cv::Size blocks_of(const Camera& camera) {
  return {(camera.width + kBlock - 1) / kBlock, (camera.height + kBlock - 1) / kBlock};
}

cv::Rect pixels_of(cv::Point block, const Camera& camera) {
  return cv::Rect(block.x * kBlock, block.y * kBlock, kBlock, kBlock) & cv::Rect(0, 0, camera.width, camera.height);
}

/// The depth of the nearest return in each block, meters; kNone where there is none.
cv::Mat1f nearest_depths(const RigCamera& view, const std::vector<Eigen::Vector3d>& returns) {
  cv::Mat1f out(blocks_of(view.camera), kNone);
  for (const Eigen::Vector3d& point : returns) {
    const Eigen::Vector3d p = view.camera_from_world * point;
    if (p.z() < kNearPlane || !view.camera.in_front(p)) continue;
    const Eigen::Vector2d pixel = view.camera.project(p);
    if (!view.camera.contains(pixel)) continue;
    float& depth = out(cvRound(pixel.y()) / kBlock, cvRound(pixel.x()) / kBlock);
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
  own.setTo(kNone, masked == 0);
  const cv::Mat1f object = least_round(own, kObject);
  const float least = *std::min_element(own.begin(), own.end());
  for (int y = 0; y < masked.rows; ++y)
    for (int x = 0; x < masked.cols; ++x) {
      if (masked(y, x) == 0) continue;
      const cv::Rect block = pixels_of({x, y}, from);
      for (float depth : {own(y, x), object(y, x) == kNone ? least : object(y, x)}) {
        if (depth == kNone) continue;
        const auto [low, high] = extent(block, depth, from, to, to_from_from);
        cv::rectangle(out, to_drawing_pixel(low.x() - kMargin, low.y() - kMargin),
                      to_drawing_pixel(high.x() + kMargin, high.y() + kMargin), 255, cv::FILLED);
      }
    }
}

// What may lie outside of the first camera's image, which knows nothing of it.
void draw_outside(const cv::Mat1f& depths, const Camera& from, const Camera& to, const SE3& to_from_from, cv::Mat1b& out) {
  const cv::Mat1f nearest = least_round(depths, kObject);
  for (int y = 0; y < nearest.rows; ++y)
    for (int x = 0; x < nearest.cols; ++x)
      for (const float depth : {nearest(y, x), kFarthest}) {
        if (depth == kNone) continue;
        const cv::Rect block = pixels_of({x, y}, from);
        const auto [low, high] = extent(block, depth, from, to, to_from_from);
        if (!to.contains(low) || !to.contains(high)) out(block) = 255;
      }
}

}  // namespace

cv::Mat1b carried_mask(const cv::Mat1b& mask, const RigCamera& masked, const RigCamera& other,
                       const std::vector<Eigen::Vector3d>& returns) {
  const SE3 other_from_masked = other.camera_from_world * masked.camera_from_world.inverse();
  cv::Mat1b out(other.camera.height, other.camera.width, uchar{0});
  const cv::Mat1f depths = nearest_depths(masked, returns);
  const bool measured = std::any_of(depths.begin(), depths.end(), [](float depth) { return depth < kNone; });
  if (!measured) return cv::Mat1b(out.size(), uchar{255});
  draw_hidden(mask, depths, masked.camera, other.camera, other_from_masked, out);
  cv::morphologyEx(out, out, cv::MORPH_CLOSE, cv::Mat1b(kGap, kGap, uchar{1}));
  draw_outside(nearest_depths(other, returns), other.camera, masked.camera, other_from_masked.inverse(), out);
  return out;
}

}  // namespace dvi::objects
