#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/core/interrupt.h"
#include "dvi/drive/view.h"

namespace dvi::audit {

/// What can be wrong with a pixel of a result.
enum class Breach : std::uint8_t {
  mask,           ///< the result's mask is not what the drive's masks say
  outside,        ///< outside the mask the result is not the drive's image
  receipt,        ///< kind and provenance contradict each other, or name a source or position that does not exist or has no
                  ///< colors
  masked_source,  ///< was copied from inside a mask
  color,          ///< source and recorded harmonization do not give the color that was written
};
inline constexpr std::array<const char*, 5> kBreaches{"mask", "outside", "receipt", "masked_source", "color"};

/// How many pixels are so, and the first of them.
struct Finding {
  std::size_t pixels = 0;
  std::string frame;
  int x = 0, y = 0;
};

struct Audit {
  std::size_t frames = 0, removed = 0, copied = 0;  ///< pixels in masks; of these copied
  double change_median = 0, change_p95 = 0;         ///< |harmonization| of copied pixels, mean over channels, gray levels
  std::array<Finding, kBreaches.size()> findings;   ///< as Breach

  bool passed() const;
};

/// Checks every pixel of a result against the drives: `views` are numbered as OUT/sources.json numbers its sources, with the
/// drives' own images and masks; `names` are those of the target's frames (the views of drive 0). InputError where a picture is
/// missing, cut short or of another size, or the result has frames that are not the drive's. One tick a frame.
Audit audit(const fs::path& out, const Views& views, const std::vector<std::string>& names, const Tick& tick = [] {});

}  // namespace dvi::audit
