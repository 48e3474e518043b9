#pragma once

#include <array>
#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/core/interrupt.h"
#include "dvi/drive/view.h"

namespace dvi::audit {

/// An error of a pixel of a result.
enum class Breach : std::uint8_t {
  mask,           ///< the mask of the result differs from the masks of the drive
  outside,        ///< outside the mask, the result differs from the image of the drive
  provenance,     ///< kind and provenance contradict each other, or name a source or position that does not exist or has no
                  ///< colors; named "receipt" in files
  masked_source,  ///< copied from inside a mask
  color,          ///< source and recorded harmonization do not reproduce the color
  imported,       ///< an import changed a pixel that the run had observed, or has no record
};
inline constexpr std::array<const char*, 6> kBreaches{"mask", "outside", "receipt", "masked_source", "color", "imported"};

/// The number of pixels with an error, and the first of them.
struct Finding {
  std::size_t pixels = 0;
  std::string frame;
  int x = 0, y = 0;
};

/// The result of an audit.
struct Audit {
  std::size_t frames = 0, removed = 0, copied = 0;  ///< pixels in masks, and copied pixels among them
  std::size_t imported = 0;                         ///< pixels that another program filled
  double change_median = 0, change_p95 = 0;         ///< |harmonization| of copied pixels, mean over channels, gray levels
  std::array<Finding, kBreaches.size()> findings;   ///< indexed by Breach

  bool passed() const;
};

/// The frames whose fill was imported from another program, and the folder of their images before that: frames/NAME.png and
/// kind/NAME.png, as the run wrote them.
struct ImportedFrames {
  std::set<std::string> names;
  fs::path before;
};

/// A result to be audited.
struct AuditedResult {
  fs::path out;
  std::vector<std::string> names;  ///< of the target's frames (the views of drive 0)
  ImportedFrames imported;
};

/// Checks every pixel of a result against the drives. `views` have the numbers of the sources in OUT/sources.json, with the
/// images and masks of the drives. Throws InputError if an image is missing, truncated, or differs in size, or if the result
/// has frames that the drive does not have. Calls `tick` once per frame.
Audit audit_result(const AuditedResult& result, const Views& views, const Tick& tick = [] {});

}  // namespace dvi::audit
