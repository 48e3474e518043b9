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

struct MaskOptions {
  std::optional<double> dilate_px = {};  ///< none: kLabelDilationPx for masks made from labels, 0 for mask files
  double box_margin_m = 0.1;
  double footprint_margin_m = 0.3;
  bool shadows = true;

  void describe(OptionTable& table) {
    table.section("masks");
    table.add_automatic("dilate_px", {&dilate_px}, {0, 100},
                        "Radius by which masks are dilated; auto: 7 for masks made from labels, 0 for mask files.");
    table.add("shadows", shadows, "Remove cast shadows and reflections on the ground with their objects.");
    table.developer();
    table.add("box_margin_m", box_margin_m, {0, 5}, "Margin added to all sides of 3D boxes before they are projected.");
    table.add("footprint_margin_m", footprint_margin_m, {0, 5},
              "Margin of the ground below a 3D box that is masked with the object: it holds wheels and shadow.");
  }
  void check() const {
    check_ranges(*this);
    if (dilate_px && *dilate_px != std::floor(*dilate_px)) throw UsageError("masks.dilate_px must be a whole number or auto");
  }

  static constexpr int kLabelDilationPx = 7;
  int label_dilation_px() const { return static_cast<int>(dilate_px.value_or(kLabelDilationPx)); }
  int file_dilation_px() const { return static_cast<int>(dilate_px.value_or(0)); }
};

/// Where masks come from: the drive's own PNG files, its labels, a network that sees objects in its images, the drive's own
/// scans and images, in which what moves is found, or the masks of the rig's first camera (reprojected_mask.h).
enum class MaskSource { files, labels, detected, found, reprojected };
constexpr auto names_of(MaskSource) {
  return std::array{std::pair{MaskSource::files, "files"}, std::pair{MaskSource::labels, "labels"},
                    std::pair{MaskSource::detected, "detector"}, std::pair{MaskSource::found, "found"},
                    std::pair{MaskSource::reprojected, "reprojected"}};
}

/// What a drive offers when nobody says otherwise: mask files where there are any, else labels, else what is found.
MaskSource default_mask_source(const Drive& drive);

/// What to remove from each frame, 255 = remove: the drive's mask files, dilated where the options say so, or masks made from
/// `objects` (as its frames). Of a labeled object the instance mask and the ground below its 3D box where there is one, else
/// the hull of its projected 3D box, else its 2D box.
Lazy<cv::Mat1b> draw_label_masks(const Drive& drive, MaskSource source, const SharedLabels& objects,
                                 const MaskOptions& options);

/// The mask of one label in an image of the camera, neither grown nor clipped by others.
cv::Mat1b draw_label(const Label& label, const Camera& camera, const SE3& camera_from_lidar, const MaskOptions& options);

}  // namespace dvi::objects
