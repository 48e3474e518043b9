#pragma once

#include <functional>
#include <optional>

#include <opencv2/core/mat.hpp>

namespace dvi::objects {

/// Parameters of the residue.
struct ResidueParams {
  int max_side_px = 48;       ///< larger objects are scaled down; details beyond do not change the score, but its cost
  int min_pixels = 30;        ///< fewer pixels resemble any others by chance
  int max_thin_px = 25;       ///< the border of a silhouette is 1 px wide up to this size, and 2 px beyond
  double max_shift_x = 0.25;  ///< share of the width: objects copied from other frames are displaced
  double max_shift_y = 0.17;  ///< share of the height
  double min_overlap = 0.5;   ///< share of the pixels that are compared after the displacement
  double min_score = 0.35;    ///< frames that are filled correctly score up to 0.33
  double min_copied = 0.3;    ///< share of the pixels that are copied; others cannot show the object
  double max_unmasked = 0.5;  ///< share of the silhouette from which the object counts as not removed
};
inline constexpr ResidueParams kResidue;

/// One frame before and after the removal of objects.
struct ResultImages {
  cv::Mat3b input, result;
  cv::Mat1b removed;   ///< 255 where objects were removed
  cv::Mat1b copied;    ///< 255 where pixels of other images were copied
  cv::Mat1b things{};  ///< 255 where the scan of the frame shows something in front of the static scene; empty without scans
};

/// Reads a frame of a drive; none if the result lacks it. It is called from several threads at once.
using ReadResult = std::function<std::optional<ResultImages>(std::size_t frame)>;

/// Measures of a frame of the result that show whether an object is still visible in it.
struct FrameResidue {
  double similarity = 0;  ///< of the result and the input inside of the silhouette: 0 none, 1 equal
  double unmasked = 0;    ///< share of the silhouette that was not removed

  bool is_unmasked() const { return unmasked > kResidue.max_unmasked; }
  double score() const { return is_unmasked() ? 1 : similarity; }
  bool is_visible() const { return score() > kResidue.min_score; }
};

/// Compares the result with the input inside the silhouette of an object (255), without its border, where the background is
/// visible, and without the surfaces of the static scene that the scan shows in it. The similarity is the correlation of their
/// color gradients, at the displacement with the highest one, because an object that was copied from another frame is displaced
/// there. The correlation that noise reaches with as many pixels is subtracted. Returns none if the object is too small.
std::optional<FrameResidue> measure_residue(const ResultImages& images, const cv::Mat1b& silhouette);

}  // namespace dvi::objects
