#include "dvi/run/run.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/core/error.h"
#include "dvi/core/threads.h"
#include "dvi/depth/depths.h"
#include "dvi/ground/road_ground.h"
#include "dvi/inputs/check_setup.h"
#include "dvi/inputs/collect_evidence.h"
#include "dvi/inputs/make_views.h"
#include "dvi/inputs/memory_plan.h"
#include "dvi/inputs/rig.h"
#include "dvi/result/plan_manifest.h"
#include "dvi/result/result_folder.h"
#include "dvi/result/stage_fields.h"  // IWYU pragma: keep
#include "dvi/run/frame_stages.h"
#include "dvi/run/make_map.h"
#include "dvi/run/refine.h"
#include "dvi/run/run_baseline.h"
#include "dvi/run/run_stages.h"
#include "dvi/run/smoothed_frames.h"
#include "dvi/synthesize/completed_views.h"

namespace dvi::run {

using align::Cameras;
using depth::DepthMap, depth::Depths, depth::Target;
using exposure::Gains;
using ground::RoadGround, map::StaticMap, map::VisibleMap;
using harmonize::FilledFrame, harmonize::HarmonizeInput, harmonize::Unobserved;
using inputs::Poses, inputs::Recordings, inputs::Inputs;
using objects::Evidence, objects::Masks, objects::Objects;
using regularize::Labeling;
using result::FilledView, result::ResultFolder, result::StageCache;
using sample::Candidates;
using synthesize::CompletedViews, synthesize::SynthesizedFrame;

namespace {

bool is_synthesized(const job::Options& options) { return options.harmonize.unobserved == Unobserved::synthesize; }

/// The data that all frames share while they are filled.
struct FillContext {
  FillContext(const StaticMap& map, const Views& views, const job::Options& options, result::CpuClock& cpu)
      : stages(options, cpu), depths(views, [&](std::size_t view) {  // 3.1
          return cpu.time("depth", depth::compute_depth_map, map, views[view], options.depth);
        }) {
    if (options.harmonize.surface_classes || is_synthesized(options)) ground.emplace(map, views);
  }

  FrameStages stages;
  Depths depths;
  std::optional<RoadGround> ground;
};

/// A frame whose unobserved pixels are interpolated, with the data that their synthesis needs.
struct HarmonizedFrame {
  FilledFrame filled;
  std::optional<regularize::Energies> energy;
  cv::Mat1b classes;  ///< Values of harmonize::SurfaceClass; empty: all unknown.

  std::size_t bytes() const {
    return bytes_of(filled.color) + bytes_of(filled.mask) + bytes_of(filled.kind) + bytes_of(filled.provenance) +
           bytes_of(filled.used) + bytes_of(filled.confidence) + bytes_of(filled.depth) + bytes_of(classes);
  }
};

/// A run of one job: plan() computes the stages before the fill, fill() fills one frame, and finish() writes all other files.
class Run {
 public:
  /// Opens the drives and checks the output folder. `content` is the content_of() the drives (fingerprints.h), if it is known.
  Run(const job::Job& job, Progress& progress, std::string content = "")
      : job_(job),
        options_(job.options),
        progress_(progress),
        drives_(open_drives()),
        folder_(job, drives_, std::move(content)) {}

  ResultFolder& folder() { return folder_; }

  /// Computes each stage before the fill, or loads it from the cache.
  void plan(StageCache::Missing missing = StageCache::Missing::compute);

  /// Fills one frame of the target, given by its view.
  FilledView fill(std::size_t frame) const;
  /// Fills, smooths, and writes frames, and passes each to `hand_on`.
  void fill_frames(const std::vector<std::size_t>& frames, const result::FinishedFrame& hand_on = {});

  result::RunReport finish();

  /// Returns the views of the target whose frames are not finished, ascending.
  std::vector<std::size_t> find_missing_frames() { return folder_.find_missing_frames(views_, progress_); }
  std::size_t frames() const { return views_.of_sequence(0).second; }
  /// Returns the number of a frame in the drive.
  int number_of(std::size_t frame) const { return drives_.front().drive.frames[views_[frame].frame].number; }
  /// Returns "A:B" for each range of consecutive frames.
  std::vector<std::string> ranges_of(const std::vector<std::size_t>& frames) const;
  std::size_t bytes_per_frame() const {
    const Camera& camera = drives_.front().drive.camera;
    return inputs::estimate_frame_bytes({camera.width, camera.height});
  }
  const result::CpuClock& cpu() const { return cpu_; }

 private:
  Recordings open_drives() const;
  Poses estimate_poses() const;
  StaticMap build_map() const;
  HarmonizeInput make_harmonize_input(const Target& target, const Candidates& candidates) const;
  HarmonizedFrame harmonize(std::size_t frame) const;
  SynthesizedFrame synthesize(std::size_t frame, HarmonizedFrame harmonized, const CompletedViews& completed) const;
  CompletedViews complete_views();

  const job::Job& job_;
  const job::Options& options_;
  Progress& progress_;
  const Recordings drives_;
  ResultFolder folder_;
  result::CpuClock cpu_;

  Poses poses_;
  Objects objects_;
  Masks masks_;
  StaticMap map_{Scratch::of_process()};
  Cameras cameras_;
  Views views_;
  std::optional<FillContext> context_;
  Lazy<HarmonizedFrame> harmonized_;  // those of views that are completed are needed twice
  CompletedViews completed_views_;
};

void Run::plan(StageCache::Missing missing) {
  const StageCache stages = folder_.make_stage_cache(progress_, missing);
  poses_ = stages.load_or_compute("poses", [&] { return estimate_poses(); });  // 3.1: LOAM, 3.5: further drives
  const Evidence evidence = inputs::collect_evidence(drives_, poses_);
  objects_ =
      stages.load_or_compute("objects", [&] { return objects::find_objects(evidence, job_.removal(), progress_); });  // 3.1
  masks_ = objects::draw_masks(evidence, objects_, job_.removal(), progress_);
  map_ = stages.load_or_compute("map", [&] { return build_map(); }, StaticMap(Scratch::of_process()));  // 3.1
  inputs::use_free_map_memory_for_work();
  const Views posed = inputs::make_views({drives_, poses_, masks_}, progress_);
  const VisibleMap visible(map_, posed);
  const Refinement refine{posed, visible, drives_, options_};
  const Gains gains = stages.load_or_compute("exposure", [&] { return estimate_exposure(refine, progress_); });
  cameras_ = stages.load_or_compute("alignment", [&] { return align(refine, progress_); });  // 3.1, eq. 1
  views_ = inputs::refine_views(posed, gains, cameras_);
  context_.emplace(map_, views_, options_, cpu_);
  harmonized_ = Lazy<HarmonizedFrame>(frames(), [this](std::size_t frame) { return harmonize(frame); });
  if (is_synthesized(options_))
    completed_views_ =
        folder_.make_fill_cache(progress_, missing).load_or_compute("completed_views", [&] { return complete_views(); });
}

HarmonizedFrame Run::harmonize(std::size_t frame) const {
  const auto& [stages, depths, ground] = *context_;
  DepthMap depth = depths.make_map(frame);  // 3.1
  depth = stages.plane_sweep({views_, frame, depth, depths.visibility});
  const Target target{views_, frame, depth, depths.visibility};
  Candidates candidates = stages.sample(target);                             // 3.2
  const Labeling labels = stages.regularize(std::move(candidates), target);  // 3.3, eqs. 2-4
  HarmonizeInput input = make_harmonize_input(target, labels.candidates);
  FilledFrame filled = stages.harmonize(target, labels.candidates, input);  // 3.4, eq. 5
  return {std::move(filled), labels.energy, std::move(input.classes)};
}

SynthesizedFrame Run::synthesize(std::size_t frame, HarmonizedFrame harmonized, const CompletedViews& completed) const {
  return context_->stages.synthesize({std::move(harmonized.filled), std::move(harmonized.classes), *context_->ground}, views_,
                                     frame, completed);
}

CompletedViews Run::complete_views() {
  const std::vector<std::size_t> selected = synthesize::select_views_to_complete(views_);
  progress_.begin("completion", selected.size());
  CompletedViews completed;
  make_and_use(
      selected.size(), [&](std::size_t i) { return harmonized_[selected[i]]; },
      [&](std::size_t i, const std::shared_ptr<const HarmonizedFrame>& harmonized) {
        const SynthesizedFrame made = synthesize(selected[i], *harmonized, completed);
        if (!made.guide.group.empty())
          completed.push_back(synthesize::make_completed_view(made, views_, selected[i], *context_->ground));
        progress_.advance();
      },
      bytes_per_frame());
  progress_.end();
  return completed;
}

FilledView Run::fill(std::size_t frame) const {
  const bool is_completed = std::any_of(completed_views_.begin(), completed_views_.end(),
                                        [frame](const synthesize::CompletedView& made) { return made.view == frame; });
  HarmonizedFrame harmonized = is_completed ? *harmonized_[frame] : harmonize(frame);
  const std::optional<regularize::Energies> energy = harmonized.energy;
  if (!is_synthesized(options_)) return {std::move(harmonized.filled), energy};
  return {synthesize(frame, std::move(harmonized), completed_views_).frame, energy};
}

void Run::fill_frames(const std::vector<std::size_t>& frames, const result::FinishedFrame& hand_on) {
  const auto finish_frame = [&](std::size_t number, const harmonize::FilledFrame& frame) {
    if (hand_on) hand_on(number, frame);
    progress_.advance();
  };
  progress_.begin("fill", frames.size());
  for_each_smoothed(frames, this->frames(),
                    {.fill = [&](std::size_t frame) { return fill(frame); },
                     .smoothing = make_smoothing(options_.smooth, cpu_),  // 3.6
                     .write = folder_.make_writer(views_, cameras_, cpu_, finish_frame),
                     .bytes_per_frame = bytes_per_frame()});
  progress_.end();
}

result::RunReport Run::finish() {
  return folder_.complete(
      {.views = views_, .map = &map_, .poses = poses_, .cameras = cameras_, .cpu = cpu_, .objects = objects_.front()},
      progress_);
}

Recordings Run::open_drives() const {
  progress_.plan(plan_run_stages(job_));
  return inputs::add_other_cameras(inputs::open_recordings(job_, inputs::MaskNeed::required, progress_), job_, progress_);
}

Poses Run::estimate_poses() const {
  inputs::verify(drives_, job_, progress_);  // damage is reported before hours of work
  return inputs::estimate_poses(drives_, job_, progress_);
}

StaticMap Run::build_map() const {
  const Inputs inputs{drives_, poses_, masks_};
  inputs::check_setup(inputs, progress_);
  return run::build_map(inputs, options_.map, progress_);
}

HarmonizeInput Run::make_harmonize_input(const Target& target, const Candidates& candidates) const {
  const auto& [stages, depths, ground] = *context_;
  HarmonizeInput input;
  if (options_.harmonize.illumination_change) input.illumination = stages.compare_illumination(target, candidates);
  if (options_.harmonize.surface_classes) input.classes = stages.classify_surfaces(target, candidates, *ground);
  input.known = stages.sample_known(target, candidates);
  return input;
}

std::vector<std::string> Run::ranges_of(const std::vector<std::size_t>& frames) const {
  std::vector<std::string> out;
  for (std::size_t first = 0, next = 1; next <= frames.size(); ++next) {
    if (next < frames.size() && frames[next] == frames[next - 1] + 1) continue;
    out.push_back(fmt::format("{}:{}", number_of(frames[first]), number_of(frames[next - 1])));
    first = next;
  }
  return out;
}

}  // namespace

result::RunReport run(const job::Job& job, Progress& progress, const FrameSink& sink) {
  result::require_usable_folder(job);
  if (job::is_baseline(job.method)) return run_baseline(job, progress, sink);
  Run run(job, progress);
  if (const std::optional<result::RunReport> finished = run.folder().read_finished_report(progress)) return *finished;
  run.folder().claim();
  run.plan();
  const std::vector<std::size_t> missing = run.find_missing_frames();
  if (sink.begin) sink.begin(run.folder().frame_names(), missing);
  run.fill_frames(missing, sink.finished);
  return run.finish();
}

PlanReport plan(const job::Job& job, Progress& progress) {
  result::require_usable_folder(job);
  if (job::is_baseline(job.method))
    throw UsageError(
        fmt::format("--method {} cannot be planned: it fills each frame alone; use dvi run", to_string(job.method)));
  Run run(job, progress);
  run.folder().claim();
  run.plan();
  PlanReport report;
  for (std::size_t i = 0; i < run.frames(); ++i) report.frames.push_back(run.number_of(i));
  report.finished = report.frames.size() - run.find_missing_frames().size();
  run.folder().write_plan(progress);
  return report;
}

FillReport fill(const job::Job& job, const std::optional<FrameRange>& range, Progress& progress) {
  Run run(job, progress, result::read_plan(job.out).content);
  run.folder().join();
  run.plan(StageCache::Missing::refuse);
  const auto is_in_range = [&](std::size_t i) { return !range || range->contains(run.number_of(i)); };
  FillReport report;
  for (std::size_t i = 0; i < run.frames(); ++i) report.frames += is_in_range(i) ? 1 : 0;
  if (report.frames == 0) throw InputError(job.out, fmt::format("has no frames {}:{}", range->first, range->last));
  std::vector<std::size_t> missing = run.find_missing_frames();
  std::erase_if(missing, [&](std::size_t i) { return !is_in_range(i); });
  run.fill_frames(missing);
  run.folder().write_fill_cost(missing, run.cpu(), progress);
  report.filled = missing.size();
  return report;
}

result::RunReport finish(const job::Job& job, Progress& progress) {
  Run run(job, progress);
  if (const std::optional<result::RunReport> finished = run.folder().read_finished_report(progress)) return *finished;
  run.folder().claim_plan();
  run.plan(StageCache::Missing::refuse);
  if (const std::vector<std::size_t> missing = run.find_missing_frames(); !missing.empty()) {
    const std::vector<std::string> ranges = run.ranges_of(missing);
    throw InputError(job.out, fmt::format("lacks {} of {} frames: {}", missing.size(), run.frames(), fmt::join(ranges, ", ")),
                     fmt::format("dvi fill {} --frames {} fills the first range", job.out, ranges.front()));
  }
  run.fill_frames({});
  return run.finish();
}

}  // namespace dvi::run
