#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dvi/depth/depths.h"
#include "dvi/ground/road_ground.h"
#include "dvi/harmonize/packed_frame.h"
#include "dvi/result/result_folder.h"
#include "dvi/run/frame_stages.h"
#include "dvi/sections/planned_section.h"
#include "dvi/synthesize/completed_views.h"

namespace dvi::run {

/// The data that all frames share while they are filled.
struct FillContext {
  FillContext(const map::StaticMap& map, const Views& views, const job::Options& options, result::CpuClock& cpu);

  FrameStages stages;
  depth::Depths depths;
  std::optional<ground::RoadGround> ground;
};

/// A frame whose unobserved pixels are interpolated, with the data that their synthesis needs.
struct HarmonizedFrame {
  harmonize::FilledFrame filled;
  std::optional<regularize::Energies> energy;
  cv::Mat1b classes;  ///< Values of harmonize::SurfaceClass; empty: all unknown.
};

/// A HarmonizedFrame in less memory.
struct PackedHarmonizedFrame {
  harmonize::PackedFrame filled;
  std::optional<regularize::Energies> energy;
  cv::Mat1b classes;

  std::size_t bytes() const { return filled.bytes() + bytes_of(classes); }
};

/// A run of one job: plan() computes the stages before the fill, fill() fills one frame, and finish() writes all other files.
class DriveRun {
 public:
  /// Opens the drives and checks the output folder. `content` is the content_of() the drives (fingerprints.h), if it is known.
  DriveRun(const job::Job& job, Progress& progress, std::string content = "")
      : job_(job),
        options_(job.options),
        progress_(progress),
        drives_(open_drives()),
        folder_(job, drives_, std::move(content)) {}

  result::ResultFolder& folder() { return folder_; }

  /// Computes each stage before the fill, or loads it from the cache.
  void plan(result::StageCache::Missing missing = result::StageCache::Missing::compute);

  /// Loads the plan as plan() does, and replaces the masks of its views, one per view.
  using ReplaceMasks = std::function<Lazy<cv::Mat1b>(const Views& planned)>;
  void load_plan(const ReplaceMasks& replace_masks);

  /// Fills one frame of the target, given by its view.
  result::FilledView fill(std::size_t frame) const;
  /// Fills, smooths, and writes frames, and passes each to `hand_on`.
  void fill_frames(const std::vector<std::size_t>& frames, const result::FinishedFrame& hand_on = {});
  /// Does the same, but writes them with `write`, which is called from several threads.
  using WriteFrame = std::function<void(std::size_t view, const result::FilledView& finished)>;
  void write_frames(const std::vector<std::size_t>& frames, const WriteFrame& write);

  result::RunReport finish();

  /// Loads the part of the plan of this section that the joint plan of all needs. The map is loaded separately.
  sections::PlannedSection load_section(const sections::Section& section) const;
  map::StaticMap load_map() const;

  /// As those of ResultFolder.
  std::vector<std::size_t> begin_fill(const std::vector<std::size_t>& frames) {
    return folder_.begin_fill(views_, frames, progress_);
  }
  void store_segments(const std::vector<std::size_t>& filled) const { folder_.store_segments(views_, filled, progress_); }
  const inputs::Recordings& drives() const { return drives_; }
  const Views& views() const { return views_; }
  std::size_t frames() const { return views_.targets(); }
  /// Returns the number in the drive of the first camera's frame that was taken with a frame.
  int number_of(std::size_t frame) const;
  /// Returns the memory that a frame in progress takes.
  std::size_t bytes_per_frame() const;
  result::CpuClock& cpu() { return cpu_; }

 private:
  void compute_stages(result::StageCache::Missing missing, const ReplaceMasks& replace_masks);
  inputs::Recordings open_drives() const;
  inputs::Poses estimate_poses() const;
  map::StaticMap build_map() const;
  harmonize::HarmonizeInput make_harmonize_input(const depth::Target& target, const sample::Candidates& candidates) const;
  HarmonizedFrame harmonize(std::size_t frame) const;
  HarmonizedFrame harmonize_cached(std::size_t frame) const;
  synthesize::SynthesizedFrame synthesize(std::size_t frame, HarmonizedFrame harmonized,
                                          const synthesize::CompletedViews& completed) const;
  synthesize::CompletedViews complete_views();

  const job::Job& job_;
  const job::Options& options_;
  Progress& progress_;
  const inputs::Recordings drives_;
  result::ResultFolder folder_;
  result::CpuClock cpu_;

  inputs::Poses poses_;
  objects::Objects objects_;
  objects::Masks masks_;
  map::StaticMap map_{Scratch::of_process()};
  align::Cameras cameras_;
  Views views_;
  std::optional<FillContext> context_;
  Lazy<PackedHarmonizedFrame> harmonized_;  // those of views that are completed are needed twice
  synthesize::CompletedViews completed_views_;
};

}  // namespace dvi::run
