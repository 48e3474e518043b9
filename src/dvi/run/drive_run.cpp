#include "dvi/run/drive_run.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "dvi/core/threads.h"
#include "dvi/drive/nearest_in_time.h"
#include "dvi/inputs/check_setup.h"
#include "dvi/inputs/collect_evidence.h"
#include "dvi/inputs/make_views.h"
#include "dvi/inputs/memory_plan.h"
#include "dvi/inputs/rig.h"
#include "dvi/result/stage_fields.h"  // IWYU pragma: keep
#include "dvi/run/make_map.h"
#include "dvi/run/refine.h"
#include "dvi/run/run_stages.h"
#include "dvi/run/smoothed_frames.h"

namespace dvi::run {

using align::Cameras;
using depth::DepthMap, depth::Target;
using exposure::Gains;
using harmonize::FilledFrame, harmonize::HarmonizeInput, harmonize::Unobserved;
using inputs::Inputs, inputs::Poses, inputs::Recordings;
using map::StaticMap, map::VisibleMap;
using objects::Evidence;
using regularize::Labeling;
using result::FilledView, result::StageCache;
using sample::Candidates;
using synthesize::CompletedViews, synthesize::SynthesizedFrame;

namespace {

bool is_synthesized(const job::Options& options) { return options.harmonize.unobserved == Unobserved::synthesize; }

}  // namespace

FillContext::FillContext(const StaticMap& map, const Views& views, const job::Options& options, result::CpuClock& cpu)
    : stages(options, cpu), depths(views, [&](std::size_t view) {  // 3.1
        return cpu.time("depth", depth::compute_depth_map, map, views[view], options.depth);
      }) {
  if (options.harmonize.surface_classes || is_synthesized(options)) ground.emplace(map, views);
}

void DriveRun::plan(StageCache::Missing missing) { compute_stages(missing, {}); }

void DriveRun::load_plan(const ReplaceMasks& replace_masks) { compute_stages(StageCache::Missing::refuse, replace_masks); }

void DriveRun::compute_stages(StageCache::Missing missing, const ReplaceMasks& replace_masks) {
  const StageCache stages = folder_.make_stage_cache(progress_, missing);
  poses_ = stages.load_or_compute("poses", [&] { return estimate_poses(); });  // 3.1: LOAM, 3.5: further drives
  Evidence evidence = inputs::collect_evidence(drives_, poses_);
  evidence.set_grounds(stages.load_or_compute("ground", [&] {
    progress_.begin("ground", 0);
    objects::Grounds grounds = evidence.grounds();
    progress_.end();
    return grounds;
  }));
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
  if (replace_masks) views_.masks = replace_masks(views_);
  context_.emplace(map_, views_, options_, cpu_);
  harmonized_ = Lazy<PackedHarmonizedFrame>(frames(), [this](std::size_t frame) {
    HarmonizedFrame made = harmonize(frame);
    return PackedHarmonizedFrame{harmonize::PackedFrame(made.filled), made.energy, std::move(made.classes)};
  });
  if (is_synthesized(options_))
    completed_views_ =
        folder_.make_fill_cache(progress_, missing).load_or_compute("completed_views", [&] { return complete_views(); });
}

HarmonizedFrame DriveRun::harmonize(std::size_t frame) const {
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

HarmonizedFrame DriveRun::harmonize_cached(std::size_t frame) const {
  const auto packed = harmonized_[frame];
  return {packed->filled.unpack(*views_.images[frame]), packed->energy, packed->classes};
}

SynthesizedFrame DriveRun::synthesize(std::size_t frame, HarmonizedFrame harmonized, const CompletedViews& completed) const {
  return context_->stages.synthesize({std::move(harmonized.filled), std::move(harmonized.classes), *context_->ground}, views_,
                                     frame, completed);
}

CompletedViews DriveRun::complete_views() {
  const std::vector<std::size_t> selected = synthesize::select_views_to_complete(views_);
  progress_.begin("completion", selected.size());
  CompletedViews completed;
  make_and_use(
      selected.size(), [&](std::size_t i) { return harmonize_cached(selected[i]); },
      [&](std::size_t i, HarmonizedFrame harmonized) {
        const SynthesizedFrame made = synthesize(selected[i], std::move(harmonized), completed);
        if (!made.guide.group.empty())
          completed.push_back(synthesize::make_completed_view(made, views_, selected[i], *context_->ground));
        progress_.advance();
      },
      bytes_per_frame());
  progress_.end();
  return completed;
}

FilledView DriveRun::fill(std::size_t frame) const {
  const bool is_completed = std::any_of(completed_views_.begin(), completed_views_.end(),
                                        [frame](const synthesize::CompletedView& made) { return made.view == frame; });
  HarmonizedFrame harmonized = is_completed ? harmonize_cached(frame) : harmonize(frame);
  const std::optional<regularize::Energies> energy = harmonized.energy;
  if (!is_synthesized(options_)) return {std::move(harmonized.filled), energy};
  return {synthesize(frame, std::move(harmonized), completed_views_).frame, energy};
}

void DriveRun::fill_frames(const std::vector<std::size_t>& frames, const result::FinishedFrame& hand_on) {
  const auto finish_frame = [&](std::size_t number, const harmonize::FilledFrame& frame) {
    if (hand_on) hand_on(number, frame);
    progress_.advance();
  };
  progress_.begin("fill", frames.size());
  write_frames(frames, folder_.make_writer(views_, cameras_, cpu_, finish_frame));
  progress_.end();
}

void DriveRun::write_frames(const std::vector<std::size_t>& frames, const WriteFrame& write) {
  for_each_smoothed(frames, views_,
                    {.fill = [&](std::size_t frame) { return fill(frame); },
                     .smoothing = make_smoothing(options_.smooth, cpu_),  // 3.6
                     .write = write,
                     .bytes_per_frame = bytes_per_frame()});
}

int DriveRun::number_of(std::size_t frame) const {
  const std::vector<Frame>& of_first = drives_.front().drive.frames;
  if (views_[frame].sequence == 0) return of_first[views_[frame].frame].number;
  return nearest_in_time(of_first.begin(), of_first.end(), views_[frame].time_ns)->number;
}

std::size_t DriveRun::bytes_per_frame() const {
  std::size_t most = 0;
  for (const inputs::Recording& open : drives_)
    if (const Camera& camera = open.drive.camera; open.is_cleaned)
      most = std::max(most, inputs::estimate_frame_bytes({camera.width, camera.height}));
  return most;
}

result::RunReport DriveRun::finish() {
  return folder_.complete(
      {.views = views_, .map = &map_, .poses = poses_, .cameras = cameras_, .cpu = cpu_, .objects = objects_}, progress_);
}

sections::PlannedSection DriveRun::load_section(const sections::Section& section) const {
  const StageCache stages = folder_.make_stage_cache(progress_, StageCache::Missing::refuse);
  auto poses = stages.load<Poses>("poses");
  auto objects = stages.load<objects::Objects>("objects");
  auto gains = stages.load<Gains>("exposure");
  auto cameras = stages.load<Cameras>("alignment");
  Views views = inputs::refine_views(inputs::make_views({drives_, poses, {}}, progress_), gains, cameras);
  return {section,          drives_,          std::move(poses),  std::move(objects.front()),
          std::move(views), std::move(gains), std::move(cameras)};
}

StaticMap DriveRun::load_map() const {
  return folder_.make_stage_cache(progress_, StageCache::Missing::refuse).load("map", StaticMap(Scratch::of_process()));
}

Recordings DriveRun::open_drives() const {
  progress_.plan(plan_run_stages(job_));
  Recordings drives =
      inputs::add_other_cameras(inputs::open_recordings(job_, inputs::MaskNeed::required, progress_), job_, progress_);
  inputs::require_provenance_range(drives);
  return drives;
}

Poses DriveRun::estimate_poses() const {
  inputs::verify(drives_, job_, progress_);  // damage is reported before hours of work
  return inputs::estimate_poses(drives_, job_, progress_);
}

StaticMap DriveRun::build_map() const {
  const Inputs inputs{drives_, poses_, masks_};
  inputs::check_setup(inputs, progress_);
  return run::build_map(inputs, options_.map, progress_);
}

HarmonizeInput DriveRun::make_harmonize_input(const Target& target, const Candidates& candidates) const {
  const auto& [stages, depths, ground] = *context_;
  HarmonizeInput input;
  if (options_.harmonize.illumination_change) input.illumination = stages.compare_illumination(target, candidates);
  if (options_.harmonize.surface_classes) {
    input.classes = stages.classify_surfaces(target, candidates, *ground);
    input.ground = &*ground;
  }
  input.known = stages.sample_known(target, candidates);
  return input;
}

}  // namespace dvi::run
