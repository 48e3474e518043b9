#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/named.h"

namespace dvi::holdout {

using dvi::to_string;  // for the enum below, beside the overloads of this namespace

/// The errors of masks that detectors and annotators make, as named by `--mask-errors` (docs/holdout.md).
enum class MaskErrors { none, miss, burst, late, tight, boxes, false_boxes };
constexpr auto names_of(MaskErrors) {
  using enum MaskErrors;
  return std::array{std::pair{none, "none"},        std::pair{miss, "miss"},   std::pair{burst, "burst"},
                    std::pair{late, "late"},        std::pair{tight, "tight"}, std::pair{boxes, "boxes"},
                    std::pair{false_boxes, "false"}};
}
/// Throws UsageError for an unknown name.
MaskErrors parse_mask_errors(const std::string& text);

/// Sizes and probabilities of mask errors.
struct MaskErrorParams {
  double miss_probability = 0.2;          ///< per frame
  std::size_t burst_frames = 5;           ///< missed in a row
  double min_late_share = 1.0 / 256;      ///< smallest masked share of an image: 900 pixels of 640x360
  int opening_radius_px = 3;              ///< details narrower than 7 px are removed
  int erosion_radius_px = 2;              ///< by which tight masks are too small
  double false_probability = 0.05;        ///< of a false box, per frame
  int min_box_px = 40, max_box_px = 120;  ///< edges of a false box
};
inline constexpr MaskErrorParams kMaskErrors;

/// The errors in the masks of one object in one camera, one entry per frame.
struct ObjectErrors {
  MaskErrors kind = MaskErrors::none;
  std::vector<bool> missed;                          ///< whether the object is missed
  std::vector<std::optional<cv::Rect>> false_boxes;  ///< a box that is masked although no object is there
};

/// Draws the errors of one object, which depend on the arguments only. `visible` is whether the object is in the image, per
/// frame. miss: each frame has its own draw. burst: the object is missed in five consecutive frames among those in which it is
/// visible; in all of them if they are at most five. false: each frame has its own draw; one frame has a box if none is drawn.
ObjectErrors draw_errors(MaskErrors kind, const std::vector<bool>& visible, cv::Size image, std::uint64_t seed);

/// Returns the erroneous mask (0 or 255) of a frame, given the true silhouette (0 or 255) of the object.
cv::Mat1b add_errors(const cv::Mat1b& silhouette, const ObjectErrors& errors, std::size_t frame);

}  // namespace dvi::holdout
