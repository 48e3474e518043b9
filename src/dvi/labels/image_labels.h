#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "dvi/drive/drive.h"
#include "dvi/drive/outline.h"
#include "dvi/labels/labels.h"

namespace dvi::labels {

/// The largest absolute image coordinate in pixels; larger ones are malformed. Tools write coordinates slightly outside the
/// image.
inline constexpr double kMaxCoordinatePx = 1e6;
/// The maximum number of corners of a polygon. Each of them costs time in each row.
inline constexpr std::size_t kMaxCorners = 100'000;

/// Lists the names of all images of the recording in the order of its frames: by number if all names are numbers, otherwise by
/// name. Includes images outside --frames.
std::vector<std::string> list_names_in_order(const Drive& drive);

/// The frames that the images of a label file belong to.
struct ImageFrames {
  std::vector<std::optional<std::string>> frames;  ///< the name per image; none for an image of another camera
  std::optional<std::string> warning;              ///< see MatchedNames
};

/// Finds the frames of the images in a label file, such as "front/000012.jpg", by their names without folder and ending; see
/// match_names(). Images of other cameras are recognized only if a folder in some name is named like the drive's camera. Throws
/// InputError if no image is one of the recording, or if two have the same name.
ImageFrames find_image_frames(const fs::path& file, const std::vector<std::string>& images, const Drive& drive);

/// Collects labels of shapes drawn in images. Shapes outside their image are counted, but are not labels.
class ImageLabels {
 public:
  ImageLabels(const fs::path& file, const Drive& drive);

  cv::Size size() const { return size_; }
  bool wanted(const std::string& frame) const { return wanted_.contains(frame); }
  /// Marks a frame as labeled, even if it has no labels.
  void know(const std::string& frame) { out_.frames[frame]; }
  /// Throws InputError about `image` if an image of this size is not one of the drive.
  void require_size(const std::string& image, cv::Size size) const;

  /// Notes a label of a frame that is not wanted, for the warning about frames that the recording does not have.
  void note(const std::string& frame) { out_.frames[frame].emplace_back(); }
  /// Add a shape to a label without geometry.
  void add_box(const std::string& frame, Label label, cv::Point2d low, cv::Point2d high);
  void add_polygons(const std::string& frame, Label label, const std::vector<Polygon>& polygons);
  void add_outline(const std::string& frame, Label label, Instance outline);

  void warn(std::string text) { out_.warnings.push_back(std::move(text)); }
  NamedLabels take();

 private:
  void add(const std::string& frame, Label label, bool shows);

  fs::path file_;
  cv::Size size_;
  std::set<std::string> wanted_;
  NamedLabels out_;
  std::size_t labels_ = 0, unobserved_ = 0;
  std::string first_unobserved_;
};

}  // namespace dvi::labels
