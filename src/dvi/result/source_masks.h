#pragma once

#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/drive/view.h"

namespace dvi::result {

/// Where a result keeps the mask of a source frame, relative to the result; numbered as sources.json numbers it.
std::string source_mask_file(std::size_t number);

/// Keeps with a result what was masked in the frames of other drives and cameras that it copies from, so that `dvi audit` can
/// check that nothing comes from there: such masks may have been found, carried over, or have shadows added, and no drive holds
/// them. Those of the target's own frames are in the result anyway.
class SourceMasks {
 public:
  SourceMasks(fs::path out, const Views& views) : out_(std::move(out)), views_(views) {}

  /// Writes the masks of a frame's sources unless it has done so before; returns their files, relative to the result,
  /// ascending. Safe to call from several threads.
  std::vector<std::string> keep(const cv::Mat_<cv::Vec3w>& provenance);

 private:
  fs::path out_;
  const Views& views_;
  std::mutex mutex_;
  std::set<std::size_t> written_;
};

}  // namespace dvi::result
