#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dvi/align/align.h"
#include "dvi/baselines/baselines.h"
#include "dvi/core/files.h"
#include "dvi/core/options.h"
#include "dvi/depth/depth.h"
#include "dvi/drive/drive.h"
#include "dvi/exposure/exposure.h"
#include "dvi/harmonize/harmonize.h"
#include "dvi/io/video.h"
#include "dvi/map/build_map.h"
#include "dvi/masks/masks.h"
#include "dvi/odometry/odometry.h"
#include "dvi/plane_sweep/plane_sweep.h"
#include "dvi/regularize/regularize.h"
#include "dvi/sample/sample.h"
#include "dvi/smooth/smooth.h"

namespace dvi::pipeline {

/// The options of all stages.
struct Options {
  masks::MaskOptions masks;
  odometry::OdometryOptions odometry;
  map::MapOptions map;
  exposure::ExposureOptions exposure;
  align::AlignOptions align;
  depth::DepthOptions depth;
  plane_sweep::PlaneSweepOptions plane_sweep;
  sample::SampleOptions sample;
  regularize::RegularizeOptions regularize;
  harmonize::HarmonizeOptions harmonize;
  smooth::SmoothOptions smooth;
  baselines::FlowOptions flow;
  io::VideoOptions video;

  void describe(OptionTable& table);
  /// UsageError for what the single ranges cannot express.
  void check() const;
};

/// What to read: shared by every command that opens a drive.
struct ReadChoice {
  std::string camera;               ///< empty: the drive's first
  std::string frames;               ///< "A:B"; empty: all
  std::string masks;                ///< DIR | FILE | labels | auto; empty: the drive's own
  std::string poses = "auto";       ///< auto | given | loam | FILE
  std::string remove = "labelled";  ///< moving | labelled | all
};

/// One call of `dvi run`.
struct Job {
  std::string out, target;
  std::vector<std::string> sources;  ///< further drives of the same place
  ReadChoice read;
  std::string method = "dvi";
  int memory_mb = 1000;  ///< of images, scans, masks and depth kept for further use
  Options options;
  bool force = false;

  /// Everything that OUT/dvi.toml holds.
  OptionTable table();
};

/// What `--method` takes: dvi, its published form, and baselines.
const std::vector<std::string>& methods();

/// Whether a method looks at images and masks only: it needs no poses and no scans.
bool is_baseline(const std::string& method);

/// Sets the options in which a method differs from the default. UsageError for an unknown one.
void use_method(const std::string& method, Options& options);

/// "A:B", both included. UsageError otherwise.
FrameRange parse_frames(const std::string& text);

}  // namespace dvi::pipeline
