#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "dvi/depth/depths.h"
#include "dvi/drive/view.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/pipeline/cpu_clock.h"
#include "dvi/pipeline/job.h"

namespace dvi::pipeline {

/// A frame after harmonisation, with what its stages said of themselves.
struct FilledView {
  harmonize::FilledFrame frame;
  double energy_before = 0, energy_after = 0;  ///< eqs. 2-4
};

/// Makes the frame of a view of the target drive.
using FillFrame = std::function<FilledView(std::size_t target)>;

/// Stages 6 to 8 for one view after another: candidates, labels, colours.
class Filler {
 public:
  Filler(const Views& views, const depth::Depths& depths, const Options& options, CpuClock& clock)
      : views_(views), depths_(depths), options_(options), clock_(clock) {}
  FilledView operator()(std::size_t target) const;

 private:
  const Views& views_;
  const depth::Depths& depths_;
  const Options& options_;
  CpuClock& clock_;
};

/// Stage 9 over a sliding window: makes the given views (in order, in blocks of parallel work) together with their neighbours
/// of the same drive, smooths each between them and hands it on.
class Smoother {
 public:
  Smoother(const FillFrame& fill_frame, std::size_t first, std::size_t last, const smooth::SmoothOptions& options,
           CpuClock& clock)
      : fill_frame_(fill_frame), first_(first), last_(last), options_(options), clock_(clock) {}

  /// The finished frames of a block of views (ascending).
  std::vector<FilledView> finish(const std::vector<std::size_t>& block);

 private:
  void fill(const std::vector<std::size_t>& block);

  const FillFrame& fill_frame_;
  std::size_t first_, last_;  // the target drive's views
  const smooth::SmoothOptions& options_;
  CpuClock& clock_;
  std::map<std::size_t, std::shared_ptr<const FilledView>> window_;
};

}  // namespace dvi::pipeline
