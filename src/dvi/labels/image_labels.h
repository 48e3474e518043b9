#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "dvi/drive/drive.h"
#include "dvi/drive/outline.h"
#include "dvi/labels/labels.h"

namespace dvi::labels {

/// Places in images farther than this from the first pixel are malformed [px]. Tools write what lies somewhat outside.
inline constexpr double kFarthestPixel = 1e6;
/// Corners of a polygon. Each costs time in each row.
inline constexpr std::size_t kMostCorners = 100'000;

/// Names of all images of the recording in the order of its frames: by number where all names are numbers, else by name.
/// --frames leaves none out.
std::vector<std::string> names_in_order(const Drive& drive);

/// Frames that a label file's images belong to.
struct ImageFrames {
  std::vector<std::optional<std::string>> frames;  ///< names, one per image; none for an image of another camera
  std::optional<std::string> warning;              ///< as of MatchedNames
};

/// Finds the frames of the images that a label file names, such as "front/000012.jpg": by their names without folder and
/// ending, as match_names() compares them. Images of other cameras can only be told where a folder in some name is called as
/// the drive's camera. Throws InputError if no image is one of the recording, or two have one name.
ImageFrames frames_of_images(const fs::path& file, const std::vector<std::string>& images, const Drive& drive);

/// Labels of shapes drawn in images. A shape outside of its image is no label, but counts.
class ImageLabels {
 public:
  ImageLabels(const fs::path& file, const Drive& drive);

  cv::Size size() const { return size_; }
  bool wanted(const std::string& frame) const { return wanted_.contains(frame); }
  /// The frame is labeled, be it with nothing.
  void know(const std::string& frame) { out_.frames[frame]; }
  /// InputError of `image` where images of this size are not the drive's.
  void require_size(const std::string& image, cv::Size size) const;

  /// A label of a frame that is not wanted: for the warning about frames that are none of the recording.
  void note(const std::string& frame) { out_.frames[frame].emplace_back(); }
  /// Each takes a label without geometry.
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
