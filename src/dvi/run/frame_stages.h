#pragma once

#include <functional>

#include "dvi/depth/plane_sweep.h"
#include "dvi/harmonize/classify_surfaces.h"
#include "dvi/harmonize/harmonize.h"
#include "dvi/harmonize/illumination_change.h"
#include "dvi/job/job.h"
#include "dvi/regularize/regularize.h"
#include "dvi/result/cpu_clock.h"
#include "dvi/sample/sample.h"
#include "dvi/synthesize/synthesize.h"

namespace dvi::run {

/// The stages that fill a frame, bound to their options. Each adds its CPU time to the clock. The options and the clock must
/// outlive this object.
struct FrameStages {
  FrameStages(const job::Options& options, result::CpuClock& cpu)
      : plane_sweep(cpu.wrap("plane_sweep", depth::sweep_planes, options.plane_sweep)),
        sample(cpu.wrap("sample", sample::sample, options.sample)),
        sample_known(cpu.wrap("sample", sample::sample_known, options.sample)),
        regularize(cpu.wrap("regularize", regularize::regularize, options.regularize)),
        compare_illumination(cpu.wrap("harmonize", harmonize::compare_illumination)),
        classify_surfaces(cpu.wrap("harmonize", harmonize::classify_surfaces)),
        harmonize(cpu.wrap("harmonize", harmonize::harmonize, options.harmonize)),
        synthesize(cpu.wrap("synthesize", synthesize::synthesize)) {}

  template <class Signature>
  using Stage = std::function<Signature>;

  Stage<depth::DepthMap(const depth::Target&)> plane_sweep;
  Stage<sample::Candidates(const depth::Target&)> sample;
  Stage<sample::Candidates(const depth::Target&, const sample::Candidates& hole)> sample_known;
  Stage<regularize::Labeling(sample::Candidates, const depth::Target&)> regularize;
  Stage<harmonize::IlluminationChange(const depth::Target&, const sample::Candidates&)> compare_illumination;
  Stage<cv::Mat1b(const depth::Target&, const sample::Candidates&, const ground::RoadGround&)> classify_surfaces;
  Stage<harmonize::FilledFrame(const depth::Target&, const sample::Candidates&, const harmonize::HarmonizeInput&)> harmonize;
  Stage<synthesize::SynthesizedFrame(synthesize::ClassifiedFrame, const Views&, std::size_t index,
                                     const synthesize::CompletedViews&)>
      synthesize;
};

}  // namespace dvi::run
