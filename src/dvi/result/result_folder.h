#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/core/folder_lock.h"
#include "dvi/inputs/make_views.h"
#include "dvi/metrics/artifacts.h"
#include "dvi/result/filled_view.h"
#include "dvi/result/run_report.h"
#include "dvi/result/stage_cache.h"

namespace dvi::result {

/// InputError where `out` holds anything but a result of dvi, unless forced. Looks only.
void require_usable_folder(const fs::path& out, bool force);

/// InputError where job.out is, holds or lies in an input of the job. Looks only.
void require_apart(const job::Job& job);

/// What a run found out, for what stands beside its frames.
struct RunResults {
  const Views& views;
  const map::StaticMap* map = nullptr;  ///< a baseline has none
  const inputs::Poses& poses;
  const align::Cameras& cameras;
  const CpuClock& cpu;
  const FrameLabels& objects;  ///< of the target: what was removed
};

/// Called with a frame of the target once it is written; may be empty.
using FinishedFrame = std::function<void(std::size_t number, const harmonize::FilledFrame& frame)>;

/// The output folder of a run: which frames in it are finished, and how a frame is written.
///
/// What is finished in it is listed by manifests (manifest.h), each written after the files that it lists: OUT/.dvi/job.json has
/// the drives that the folder belongs to, .dvi/plan.json the plan, .dvi/stages/NAME.json a cached stage, .dvi/frames/NAME.json
/// the images of a frame, .dvi/costs/NAME.json the cost of a part, .dvi/report.json the report, and .dvi/result.json all else.
/// What is missing, damaged, or made from other options or inputs is made again. OUT/.dvi/masks is what source_masks.h keeps. A
/// folder of other drives, or of anything else, is refused unless forced; one that is, holds, or lies in an input always. Only
/// files that the manifest of a frame lists are deleted.
class ResultFolder {
 public:
  /// InputError where the folder is refused. Looks only. `content`: content_of() the drives, where it is known already.
  ResultFolder(const job::Job& job, const inputs::Recordings& drives, std::string content = "");
  ~ResultFolder();  ///< removes the folder again if it was made here and nothing was written
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  /// The report of this very run, if the folder holds all of it already.
  std::optional<RunReport> finished_report(Progress& progress) const;

  /// Takes the folder for this run. InputError where it cannot be written, or another process writes into it.
  void claim();

  /// Takes the folder together with others that fill frames of its plan. InputError where it is no plan of this job, or another
  /// process keeps it to itself.
  void join();

  /// As claim(), to complete what others filled. InputError where it is no plan of this job.
  void claim_plan();

  /// What earlier calls computed before they filled frames.
  StageCache stage_cache(Progress& progress, StageCache::Missing missing = StageCache::Missing::made) const;

  /// Writes down that all stages before the fill are kept, and which options they were made with.
  void write_plan(const Progress& progress) const;

  /// The views of the target that are still to be made, ascending. From here on the result counts as unfinished, if there are
  /// any.
  std::vector<std::size_t> missing_frames(const Views& views, Progress& progress);

  /// Keeps what these frames cost for who completes the result.
  void keep_fill_cost(const std::vector<std::size_t>& frames, const CpuClock& cpu, const Progress& progress) const;

  /// The names of the target's frames, known from missing_frames() on.
  const std::vector<std::string>& frame_names() const { return names_; }

  /// Writes everything of a frame, its manifest last, and hands it on. Safe to call from several threads.
  std::function<void(std::size_t view, const FilledView& finished)> writer(const Views& views, const align::Cameras& cameras,
                                                                           CpuClock& cpu, Progress& progress,
                                                                           const FinishedFrame& hand_on = {}) const;

  /// Writes what stands beside the frames, the report last, and removes frames of earlier runs. The report's cost is this
  /// process's, and that of a plan and its fills where the result was made by them.
  RunReport complete(const RunResults& results, Progress& progress);

 private:
  fs::path frame_manifest(const std::string& name) const { return out_ / ".dvi/frames" / (name + ".json"); }
  fs::path result_manifest() const { return out_ / ".dvi/result.json"; }
  void refuse_other_drives() const;
  std::string own_options() const;  ///< what dvi.toml says
  bool is_finished(const std::string& name) const;
  std::string frame_name(const Views& views, std::size_t view) const;
  void remove_other_frames() const;
  void remove_other_source_masks() const;
  void remove_map() const;
  RunReport report(const RunResults& results, const metrics::Artifacts& artifacts, const Progress& progress) const;

  const job::Job& job_;
  const inputs::Recordings& drives_;
  const fs::path out_;
  const std::string identity_, content_, fingerprint_;
  bool created_ = false;
  std::optional<FolderLock> lock_;
  std::vector<std::string> names_;  // of the target's views
  std::size_t made_ = 0;            // frames that were missing
  bool planned_ = false;            // by another process
};

/// After an interrupted run into `out`: what the same run, called again, finds done there, for a person.
std::string kept_in(const fs::path& out);

/// The pictures of a frame: `frames/NAME.png` and so on.
const std::vector<std::string>& picture_folders();

}  // namespace dvi::result
