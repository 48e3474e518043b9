#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "dvi/core/error.h"
#include "dvi/core/named.h"
#include "dvi/core/options.h"
#include "dvi/drive/drive.h"

namespace dvi::objects {

/// The options of masks.
struct MaskOptions {
  std::optional<double> dilate_px = {};  ///< empty: kLabelDilationPx for masks drawn from labels, 0 for mask files
  double box_margin_m = 0.1;             ///< on all sides of 3D boxes
  double footprint_margin_m = 0.3;       ///< around the ground below 3D boxes
  bool shadows = true;                   ///< whether cast shadows and reflections are removed

  void describe(OptionTable& table) {
    table.section("masks");
    table.add_automatic("dilate_px", {&dilate_px}, {0, 100},
                        "Radius by which masks are dilated; auto: 7 for masks made from labels, 0 for mask files.");
    table.add("shadows", shadows, "Remove cast shadows and reflections on the ground with their objects.");
    table.developer();
    table.add("box_margin_m", box_margin_m, {0, 5}, "Margin added to all sides of 3D boxes before they are projected.");
    table.add("footprint_margin_m", footprint_margin_m, {0, 5},
              "Margin of the ground below a 3D box that is masked with the object, with its wheels and shadow.");
  }
  void check() const {
    check_ranges(*this);
    if (dilate_px && *dilate_px != std::floor(*dilate_px)) throw UsageError("masks.dilate_px must be a whole number or auto");
  }

  static constexpr int kLabelDilationPx = 7;
  int label_dilation_px() const { return static_cast<int>(dilate_px.value_or(kLabelDilationPx)); }
  int file_dilation_px() const { return static_cast<int>(dilate_px.value_or(0)); }
};

/// The source of masks. files: the drive's own mask files. labels: its labels. detected: a network that detects objects in its
/// images. found: motion segmentation in its scans and images. reprojected: the masks of the rig's first camera
/// (reprojected_mask.h).
enum class MaskSource { files, labels, detected, found, reprojected };
constexpr auto names_of(MaskSource) {
  return std::array{std::pair{MaskSource::files, "files"}, std::pair{MaskSource::labels, "labels"},
                    std::pair{MaskSource::detected, "detector"}, std::pair{MaskSource::found, "found"},
                    std::pair{MaskSource::reprojected, "reprojected"}};
}

/// Returns the default source of a drive: mask files if it has any, else labels, else motion segmentation.
MaskSource choose_mask_source(const Drive& drive);

/// Draws the masks of a drive, per frame, 255 = remove. They are its mask files, dilated as the options state, or drawn from
/// `objects` (per frame). A labeled object is drawn as its instance mask and the ground below its 3D box, else as the convex
/// hull of its projected 3D box, else as its 2D box. Throws InputError if the drive has no data of that source.
Lazy<cv::Mat1b> draw_label_masks(const Drive& drive, MaskSource source, const SharedLabels& objects,
                                 const MaskOptions& options);

/// Draws the mask of one label into an image of the camera, without dilation.
cv::Mat1b draw_label(const Label& label, const Camera& camera, const SE3& camera_from_lidar, const MaskOptions& options);

}  // namespace dvi::objects
