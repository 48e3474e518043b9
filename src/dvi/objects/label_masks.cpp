#include "dvi/objects/label_masks.h"

#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/drive/outline.h"
#include "dvi/image/region.h"

namespace dvi::objects {
namespace {

// Returns points along the edges of a box, which are curves in the image of a wide camera.
std::vector<Eigen::Vector3d> sample_edges(const std::array<Eigen::Vector3d, 8>& corners) {
  constexpr int kParts = 12;
  std::vector<Eigen::Vector3d> out;
  for (int i = 0; i < 8; ++i)
    for (const int bit : {1, 2, 4})
      for (int k = 0; (i & bit) == 0 && k <= kParts; ++k)
        out.emplace_back(corners[i] + static_cast<double>(k) / kParts * (corners[i | bit] - corners[i]));
  return out;
}

// Returns points whose hull is the part of a box in front of the camera. Edges are clipped at the near plane.
std::vector<Eigen::Vector3d> find_visible_corners(const Box& box, const Camera& camera, const SE3& camera_from_lidar) {
  std::array<Eigen::Vector3d, 8> corners = box.corners();
  for (Eigen::Vector3d& c : corners) c = camera_from_lidar * c;
  if (camera.is_wide()) return sample_edges(corners);
  std::vector<Eigen::Vector3d> visible;
  for (int i = 0; i < 8; ++i) {
    if (corners[i].z() >= kNearPlane) visible.push_back(corners[i]);
    for (const int bit : {1, 2, 4}) {
      const int j = i ^ bit;
      if (j < i || (corners[i].z() < kNearPlane) == (corners[j].z() < kNearPlane)) continue;
      const double u = (kNearPlane - corners[i].z()) / (corners[j].z() - corners[i].z());
      visible.emplace_back(corners[i] + u * (corners[j] - corners[i]));
    }
  }
  return visible;
}

// Returns the bottom face of a box, grown sideways.
Box make_footprint(const Box& box, double margin) {
  Box ground = box;
  ground.frame_from_box.t -= 0.5 * box.size.z() * box.frame_from_box.R.col(2);
  ground.size = {box.size.x() + 2 * margin, box.size.y() + 2 * margin, 0};
  return ground;
}

Lazy<cv::Mat1b> draw_mask_files(const Drive& drive, const MaskOptions& options) {
  if (drive.masks.empty())
    throw InputError(drive.path, "has no mask files", "give --masks DIR, or --masks labels if the drive has labels");
  const int radius = options.file_dilation_px();
  if (radius == 0) return drive.masks;
  return {drive.masks.size(), [masks = drive.masks, radius](std::size_t i) { return grown(*masks[i], radius); }};
}

}  // namespace

cv::Mat1b draw_label(const Label& label, const Camera& camera, const SE3& camera_from_lidar, const MaskOptions& options) {
  cv::Mat1b mask(camera.height, camera.width, uchar{0});
  if (label.instance) {
    draw(*label.instance, mask);
    if (label.box)
      draw_hull(find_visible_corners(make_footprint(*label.box, options.footprint_margin_m), camera, camera_from_lidar), camera,
                mask);
  } else if (label.box) {
    Box box = *label.box;
    box.size.array() += 2 * options.box_margin_m;
    draw_hull(find_visible_corners(box, camera, camera_from_lidar), camera, mask);
  } else if (label.rect) {
    const cv::Rect2d& r = *label.rect;
    const cv::Point corner = to_drawing_pixel(std::floor(r.x), std::floor(r.y));
    const cv::Point opposite = to_drawing_pixel(std::ceil(r.x + r.width), std::ceil(r.y + r.height));
    mask(cv::Rect(corner, opposite) & cv::Rect(0, 0, mask.cols, mask.rows)) = 255;
  }
  return mask;
}

Lazy<cv::Mat1b> draw_label_masks(const Drive& drive, const MaskSources& sources, const SharedLabels& objects,
                                 const MaskOptions& options) {
  Lazy<cv::Mat1b> files;
  if (sources.contains(MaskSource::files)) {
    files = draw_mask_files(drive, options);
    if (sources.size() == 1) return files;
  }
  if (sources.contains(MaskSource::labels) && !drive.has_labels())
    throw InputError(drive.path, "has no labels", "give --masks DIR or --masks FILE");
  return {drive.frames.size(),
          [files, objects, sources, camera = drive.camera, pose = drive.camera_from_lidar, options](std::size_t i) {
            cv::Mat1b dilated(camera.height, camera.width, uchar{0}), exact(dilated.clone());
            for (Label label : (*objects)[i]) {
              if (!sources.contains(label.source)) continue;
              const bool is_outlined = is_of_scans(label.source);
              if (is_outlined) label.box.reset();  // the outline includes the ground
              (is_outlined ? exact : dilated) |= draw_label(label, camera, pose, options);
            }
            if (!files.empty()) exact |= *files[i];
            return cv::Mat1b(grown(dilated, options.label_dilation_px()) | exact);
          }};
}

}  // namespace dvi::objects
