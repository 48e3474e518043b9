#pragma once

#include <string>
#include <vector>

#include "dvi/align/align.h"
#include "dvi/baselines/baselines.h"
#include "dvi/core/files.h"
#include "dvi/core/options.h"
#include "dvi/depth/depth.h"
#include "dvi/depth/plane_sweep.h"
#include "dvi/drive/drive.h"
#include "dvi/exposure/exposure.h"
#include "dvi/harmonize/harmonize.h"
#include "dvi/job/choices.h"
#include "dvi/labels/mask_reading.h"
#include "dvi/map/build_map.h"
#include "dvi/media/video.h"
#include "dvi/objects/evidence.h"
#include "dvi/objects/label_masks.h"
#include "dvi/odometry/odometry.h"
#include "dvi/regularize/regularize.h"
#include "dvi/sample/sample.h"
#include "dvi/smooth/smooth.h"

namespace dvi::job {

/// The options of all stages.
struct Options {
  objects::MaskOptions masks;
  objects::ObjectOptions objects;
  odometry::OdometryOptions odometry;
  map::MapOptions map;
  exposure::ExposureOptions exposure;
  align::AlignOptions align;
  depth::DepthOptions depth;
  depth::PlaneSweepOptions plane_sweep;
  sample::SampleOptions sample;
  regularize::RegularizeOptions regularize;
  harmonize::HarmonizeOptions harmonize;
  smooth::SmoothOptions smooth;
  baselines::FlowOptions flow;
  media::VideoOptions video;

  void describe(OptionTable& table);
  /// Throws UsageError with the first option whose value is not allowed.
  void check() const;
};

/// The data to read, for every command that opens a drive.
struct ReadChoice {
  std::string camera;                         ///< cameras to clean: NAME, NAME,NAME, or all; empty: the drive's first
  std::vector<std::string> topics;            ///< of bags: "image=/front/image_raw"
  std::string frames;                         ///< "A:B" or "A"; empty: all
  std::vector<MasksFrom> masks{MasksFrom{}};  ///< their union is removed, with the detections of `detector`
  labels::MaskReading mask_files;             ///< how mask files are read, also those of source drives
  bool is_source = false;  ///< classes select mask files only: labeled objects of a source drive are not background
  std::string ego_mask;    ///< a file: one mask for all frames of the camera; empty: none
  std::string detector;    ///< MODEL.onnx that detects objects to remove in all drives; empty: none
  PosesFrom poses;
  std::string source_cameras = "all";  ///< other cameras of each drive to copy from: all, none, or NAME,NAME
  Remove remove = Remove::labeled;
};

/// One call of `dvi run`.
struct Job {
  std::string out, target;
  std::vector<std::string> sources;  ///< source drives of the same street
  ReadChoice read;
  Method method = Method::dvi;
  int memory_mb = 2000;  ///< limit for the whole program, in megabytes; table() documents its parts
  int sections = 0;      ///< parts of the drive that are planned alone (sections/section.h); 0: by the number of frames
  Options options;
  bool force = false;

  /// Returns the table of all options, [job] included. It refers to this job.
  OptionTable table();

  /// Returns how objects are removed. Baselines use masks as given.
  objects::RemovalOptions removal() const;
};

/// Sets the options in which a method differs from the default.
void use_method(Method method, Options& options);

/// Formats OUT/dvi.toml: all user options, and the developer options that differ from their default or their method's.
std::string effective_toml(Job job);

/// Returns the first camera of a list (ReadChoice::camera), which the other cameras refer to; empty: the drive's first.
std::string first_camera(const std::string& cameras);

/// Returns whether a list of cameras is `all`, which leaves out cameras that cannot be cleaned with the others.
bool is_all_cameras(const std::string& cameras);

/// Returns whether a list of cameras has another one than the first.
bool has_other_cameras(const std::string& cameras);

/// Throws UsageError if a list of cameras has another one than the first; `user` is the command or option that takes one
/// camera.
void require_one_camera(const std::string& cameras, const std::string& user);

/// Returns whether a camera is in a list of cameras.
bool is_listed(const std::string& camera, const std::string& cameras);

/// Parses "A:B", both included, or "A", that frame only. Throws UsageError for other texts.
FrameRange parse_frames(const std::string& text);

}  // namespace dvi::job
