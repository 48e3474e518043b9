#pragma once

#include <array>
#include <utility>

#include "dvi/core/named.h"
#include "dvi/core/options.h"
#include "dvi/drive/drive.h"

namespace dvi::masks {

struct MaskOptions {
  int dilate_px = 7;
  double box_margin_m = 0.1;
  double footprint_margin_m = 0.3;
  bool shadows = true;

  void describe(OptionTable& table) {
    table.section("masks");
    table.add("dilate_px", dilate_px, {0, 100}, "Radius by which masks made from labels are dilated.");
    table.add("shadows", shadows, "Remove cast shadows and reflections on the ground with their objects.");
    table.developer();
    table.add("box_margin_m", box_margin_m, {0, 5}, "Margin added to all sides of 3D boxes before they are projected.");
    table.add("footprint_margin_m", footprint_margin_m, {0, 5},
              "Margin of the ground below a 3D box that is masked with the object: it holds wheels and shadow.");
  }
  void check() const { check_ranges(*this); }
};

/// Where masks come from: the drive's own PNG files, its labels, a network that sees objects in its images, the drive's own
/// scans and images, in which what moves is found, or the masks of the rig's first camera (carried.h).
enum class MaskSource { files, labels, detected, found, carried };
constexpr auto names_of(MaskSource) {
  return std::array{std::pair{MaskSource::files, "files"}, std::pair{MaskSource::labels, "labels"},
                    std::pair{MaskSource::detected, "detector"}, std::pair{MaskSource::found, "found"},
                    std::pair{MaskSource::carried, "carried"}};
}

/// What a drive offers when nobody says otherwise: mask files where there are any, else labels, else what is found.
MaskSource default_mask_source(const Drive& drive);

/// What to remove from each frame, 255 = remove: the drive's mask files, or masks made from `objects` (as its frames). Of a
/// labelled object the instance mask and the ground below its 3D box where there is one, else the hull of its projected 3D box,
/// else its 2D box.
Lazy<cv::Mat1b> find_masks(const Drive& drive, MaskSource source, const SharedLabels& objects, const MaskOptions& options);

/// The mask of one label in an image of the camera, neither grown nor clipped by others.
cv::Mat1b label_mask(const Label& label, const Camera& camera, const SE3& camera_from_lidar, const MaskOptions& options);

}  // namespace dvi::masks
