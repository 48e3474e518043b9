#pragma once

#include <cmath>
#include <optional>

#include "dvi/core/error.h"
#include "dvi/core/options.h"
#include "dvi/drive/drive.h"
#include "dvi/drive/mask_source.h"

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

/// Draws the union of the masks of these sources, per frame of a drive, 255 = remove: its mask files, dilated as the options
/// state, and the labels in `objects` (per frame) that are from these sources. A labeled object is drawn as its instance mask
/// and the ground below its 3D box, else as the convex hull of its projected 3D box, else as its 2D box. Objects that were
/// found in scans are drawn as their outlines, which have a margin and include the ground. Throws InputError if the drive has
/// no mask files or no labels although it should.
Lazy<cv::Mat1b> draw_label_masks(const Drive& drive, const MaskSources& sources, const SharedLabels& objects,
                                 const MaskOptions& options);

/// Draws the mask of one label into an image of the camera, without dilation.
cv::Mat1b draw_label(const Label& label, const Camera& camera, const SE3& camera_from_lidar, const MaskOptions& options);

}  // namespace dvi::objects
