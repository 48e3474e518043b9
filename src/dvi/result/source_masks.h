#pragma once

#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/drive/view.h"

namespace dvi::result {

/// Returns the file of a source frame's mask, relative to the result. `number` is its number in sources.json.
std::string source_mask_file(std::size_t number);

/// Writes the masks of frames of other drives and cameras that a result copies from, so that `dvi audit` can check that no
/// pixel is copied from a mask. Drives do not contain all of these masks, because they may be computed from scans, reprojected,
/// or extended by shadows. The masks of the target's own frames are part of the result.
class SourceMasks {
 public:
  SourceMasks(fs::path out, const Views& views) : out_(std::move(out)), views_(views) {}

  /// Writes the masks of a frame's sources that are not written yet. Returns the files of all its sources, relative to the
  /// result, ascending. May be called from several threads at once.
  std::vector<std::string> write(const cv::Mat_<cv::Vec3w>& provenance);

 private:
  fs::path out_;
  const Views& views_;
  std::mutex mutex_;
  std::set<std::size_t> written_;
};

}  // namespace dvi::result
