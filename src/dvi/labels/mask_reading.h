#pragma once

#include <array>
#include <string>
#include <utility>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"
#include "dvi/core/named.h"
#include "dvi/drive/drive.h"

namespace dvi::labels {

/// What black and white mean in mask files: white = remove, or black = remove, as for COLMAP and nerfstudio.
enum class Polarity { automatic, white, black };
constexpr auto names_of(Polarity) {
  return std::array{std::pair{Polarity::automatic, "auto"}, std::pair{Polarity::white, "white"},
                    std::pair{Polarity::black, "black"}};
}

/// How the pixels of mask files are read.
struct MaskReading {
  Polarity polarity = Polarity::automatic;
  std::string classes = {};  ///< of pictures of class ids, as parse_classes() takes them; empty: what is not 0
};

/// Sets drive.masks to the drive.mask_files, read so. Of what is automatic it decides by a sample of the files' folders, which
/// become other_files, and warns of what it decides. InputError where the files are pictures of class ids and no class is
/// named.
void read_masks(Drive& drive, const MaskReading& reading);

/// One mask of all frames, such as that of the vehicle's hood. Where the polarity is automatic the smaller part is removed,
/// and a warning of the drive says so where that is black. The file becomes one of other_files. InputError where its size is
/// not that of the drive's images.
cv::Mat1b read_static_mask(Drive& drive, const fs::path& file, Polarity polarity);

}  // namespace dvi::labels
