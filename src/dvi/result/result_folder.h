#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/core/folder_lock.h"
#include "dvi/inputs/make_views.h"
#include "dvi/metrics/without_truth.h"
#include "dvi/objects/removed_objects.h"
#include "dvi/result/filled_view.h"
#include "dvi/result/result_layout.h"
#include "dvi/result/result_media.h"
#include "dvi/result/run_report.h"
#include "dvi/result/stage_cache.h"

namespace dvi::result {

/// The results of a run that files other than the frames are written from.
struct RunResults {
  const Views& views;
  const map::StaticMap* map = nullptr;  ///< null for a baseline
  const inputs::Poses& poses;
  const align::Cameras& cameras;
  const CpuClock& cpu;
  /// Removed objects of each cleaned camera.
  std::span<const objects::CameraObjects> objects;
};

/// Called with each frame of the target after it was written; may be empty.
using FinishedFrame = std::function<void(std::size_t number, const harmonize::FilledFrame& frame)>;

/// The output folder of a run. It knows the layout of the folder and its finished parts, and writes frames and all other files.
///
/// Manifests (manifest.h) list the finished parts; each is written after the files that it lists: OUT/.dvi/job.json has the
/// drives of the folder, .dvi/plan.json the plan, .dvi/stages/NAME.json a cached stage, .dvi/frames/NAME.json the images of a
/// frame, .dvi/costs/NAME.json the cost of a part, .dvi/report.json the report, and .dvi/result.json all other files. Parts
/// that are missing, damaged, or made from other options or inputs are computed again. OUT/.dvi/masks has masks of source
/// frames (source_masks.h), and OUT/.dvi/before_import the images that a fill of another program replaced (fill_import.h). A
/// folder of other drives or with other contents is refused unless forced. A folder that is,
/// contains, or is inside of an input is always refused. Only files that the manifest of a frame lists are deleted.
class ResultFolder {
 public:
  /// Throws InputError if the folder is refused. Changes no file. `content` is the content_of() the drives; it is computed if
  /// empty.
  ResultFolder(const job::Job& job, const inputs::Recordings& drives, std::string content = "");
  ~ResultFolder();  ///< removes the folder if this object created it and no frame or stage was finished
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  /// Returns the report if the folder already contains the complete result of this run; otherwise none.
  std::optional<RunReport> read_finished_report(Progress& progress) const;

  /// Locks the folder for this run, and creates its subfolders. Throws InputError if it is read-only, or if another process has
  /// locked it.
  void claim();

  /// Locks the folder together with other processes that fill frames of its plan. Throws InputError if it does not contain a
  /// plan of this job, or if another process has locked it for itself.
  void join();

  /// Locks the folder together with other processes that plan sections of the drive (section_folder.h), and marks it as a
  /// result of the drives. Throws InputError as claim().
  void claim_section();

  /// Locks the folder as claim(), to complete a plan. Throws InputError if it does not contain a plan of this job.
  void claim_plan();

  /// Returns the cache of the stages before the fill.
  StageCache make_stage_cache(Progress& progress, StageCache::Missing missing = StageCache::Missing::compute) const;
  /// Returns the cache of stages that also depend on the options of the fill.
  StageCache make_fill_cache(Progress& progress, StageCache::Missing missing) const {
    return {out_, fingerprint_, progress, missing};
  }

  /// Writes the options, the cost, and the manifest of the plan, after all stages before the fill are cached.
  void write_plan(const Progress& progress, std::size_t sections = 1) const;

  /// Writes the options of the whole drive into the folder of a section.
  void write_section_options(const fs::path& section) const;

  /// Returns those of the given views of the target whose frames are not finished, ascending. If there are any, marks the
  /// result as unfinished.
  std::vector<std::size_t> begin_fill(const Views& views, const std::vector<std::size_t>& frames, Progress& progress);

  /// Encodes the segments of the videos that contain these frames (result_media.h), for the process that completes the result.
  void store_segments(const Views& views, const std::vector<std::size_t>& filled, Progress& progress) const;

  /// Writes the cost of these frames, for the process that completes the result.
  void write_fill_cost(const std::vector<std::size_t>& frames, const CpuClock& cpu, const Progress& progress) const;

  /// Writes the cost of the plan of a section, for the process that completes the result.
  void write_section_cost(std::size_t section, const CostReport& cost);

  /// Returns the names of the target's frames (core/frame_name.h); empty before begin_fill() is called.
  const std::vector<std::string>& frame_names() const { return names_; }

  /// Returns a function that writes all files of a frame, its manifest last, and then passes the frame to `hand_on`. It may be
  /// called from several threads at once.
  std::function<void(std::size_t view, const FilledView& finished)> make_writer(const Views& views,
                                                                                const align::Cameras& cameras, CpuClock& cpu,
                                                                                const FinishedFrame& hand_on) const;

  /// Writes all files other than the frames, the report last, and removes frames of earlier runs. The cost in the report
  /// includes that of other processes, if claim_plan() or write_section_cost() was called.
  RunReport complete(const RunResults& results, Progress& progress);

 private:
  fs::path frame_manifest(const std::string& name) const { return result::frame_manifest(out_, name); }
  fs::path result_manifest() const { return result::result_manifest(out_); }
  void refuse_other_drives() const;
  std::string format_options() const;  ///< the text of dvi.toml
  bool is_finished(const std::string& name) const;
  std::vector<std::string> cameras() const;  ///< as list_cameras()
  std::string frame_name(const View& view) const;
  std::vector<objects::RemovedObject> list_removed(const RunResults& results) const;
  std::vector<FinishedFrames> list_finished(const Views& views) const;  ///< the frames of each cleaned camera
  void remove_other_frames() const;
  void remove_unlisted_files() const;
  void remove_map() const;
  RunReport make_report(const RunResults& results, const std::vector<objects::RemovedObject>& removed,
                        const metrics::FiguresWithoutTruth& figures, const Progress& progress) const;

  const job::Job& job_;
  const inputs::Recordings& drives_;
  const fs::path out_;
  const std::string identity_, content_, fingerprint_;
  bool created_ = false;
  std::optional<FolderLock> lock_;
  std::vector<std::string> names_;  // names of the target's frames
  std::size_t made_ = 0;            // frames that were missing
  bool planned_ = false;            // whether other processes computed parts of the result
};

/// Returns a message about the finished parts of an interrupted run, which a repeated run uses.
std::string describe_progress(const fs::path& out);

}  // namespace dvi::result
