#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <utility>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"
#include "dvi/core/named.h"
#include "dvi/drive/drive.h"

namespace dvi::labels {

/// The meaning of black and white in mask files: white = remove, or black = remove as for COLMAP and nerfstudio.
enum class Polarity { automatic, white, black };
constexpr auto names_of(Polarity) {
  return std::array{std::pair{Polarity::automatic, "auto"}, std::pair{Polarity::white, "white"},
                    std::pair{Polarity::black, "black"}};
}

/// The rules by which the pixels of mask files are read.
struct MaskReading {
  Polarity polarity = Polarity::automatic;
  std::string classes = {};  ///< of images of class ids, see parse_classes(); empty: all values other than 0
};

/// Sets drive.masks to the drive.mask_files, read by these rules. Automatic rules are decided by a sample of the files'
/// folders; the sample becomes part of other_files, and a warning states the decision. Throws InputError if the files are
/// images of class ids and no class is selected.
void read_masks(Drive& drive, const MaskReading& reading);

/// The part of masks that is painted, by which their polarity is decided.
struct PaintedShare {
  double share = 0;       ///< fraction of the image that is not black, in the median
  std::size_t masks = 0;  ///< the number of inspected masks
  std::string where;      ///< their folder or file, for the warning
};

/// Decides the meaning of black and white by the part that is painted, and adds a warning unless white means remove as usual.
Polarity decide_polarity(Drive& drive, const PaintedShare& painted);

/// Reads one mask for all frames, such as that of the vehicle's hood. With automatic polarity the smaller part is removed; a
/// warning states if that is the black part. The file becomes part of other_files. Throws InputError if its size differs from
/// that of the drive's images.
cv::Mat1b read_static_mask(Drive& drive, const fs::path& file, Polarity polarity);

}  // namespace dvi::labels
