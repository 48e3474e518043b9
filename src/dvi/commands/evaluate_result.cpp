#include "dvi/commands/evaluate_result.h"

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/commands/label_scans.h"
#include "dvi/core/error.h"
#include "dvi/core/frame_name.h"
#include "dvi/core/json_file.h"
#include "dvi/datasets/pose_file.h"
#include "dvi/inputs/recordings.h"
#include "dvi/inputs/rig.h"
#include "dvi/job/job.h"
#include "dvi/labels/labels.h"
#include "dvi/objects/completion/labeled_boxes.h"

namespace dvi::commands {
namespace {

// What ghosts are counted in, or the reason why they cannot be counted.
using SceneOrReason = std::variant<metrics::GhostScene, std::string>;

// Determines how the drive of a run is read for its labels.
job::ReadChoice choose_labels(job::ReadChoice choice, const fs::path& labels) {
  const std::vector<job::MasksFrom> given = choice.masks;
  using Kind = job::MasksFrom::Kind;
  const auto has_no_labels = [&](const job::MasksFrom& from) {
    const bool has_masks =
        from.kind == Kind::path && fs::exists(from.path) && !labels::holds_labels(from.path, job::first_camera(choice.camera));
    return from.kind == Kind::found || from.kind == Kind::none || has_masks;
  };
  if (!labels.empty())
    choice.masks = {job::MasksFrom{Kind::path, labels.string()}};
  else
    std::erase_if(choice.masks, has_no_labels);
  if (choice.masks.empty()) choice.masks = {job::MasksFrom{}};
  if (!labels.empty() || choice.masks != given) choice.mask_files.classes.clear();
  if (choice.mask_files.polarity == labels::Polarity::automatic)
    choice.mask_files.polarity = labels::Polarity::white;  // masks are not used
  choice.detector.clear();
  choice.ego_mask.clear();
  choice.poses = {};
  return choice;
}

// Opens the target of a run and its cameras, with labels if there are any.
inputs::Recordings open_labeled(job::Job job, const fs::path& labels, Progress& progress) {
  job.sources.clear();
  job.read = choose_labels(job.read, labels);
  return inputs::add_other_cameras(inputs::open_recordings(job, inputs::MaskNeed::optional, progress), job, progress);
}

std::vector<metrics::StationaryObject> find_stationary_objects(const Drive& drive, const Trajectory& world_from_lidar) {
  std::vector<metrics::StationaryObject> out;
  for (const objects::LabeledBoxes& object : objects::LabeledBoxes::collect(drive, drive.labels(), world_from_lidar))
    if (const std::optional<Box> box = object.find_stationary_box()) out.push_back({object.track(), object.type(), *box});
  return out;
}

std::map<int, Instance> collect_outlines(const std::vector<Label>& labels) {
  std::map<int, Instance> outlines;
  for (const Label& label : labels)
    if (label.instance && label.track >= 0) outlines[label.track] = *label.instance;
  return outlines;
}

// Collects the cameras of the sources that are frames of the target drive.
metrics::GhostScene make_scene(const fs::path& out, const inputs::Recordings& drives) {
  const Trajectory world_from_lidar = datasets::read_poses(out / "map/poses.txt", drives.front().drive);
  metrics::GhostScene scene;
  scene.objects = find_stationary_objects(drives.front().drive, world_from_lidar);
  std::map<std::pair<std::string, std::string>, metrics::GhostSource> cameras;  // by camera and frame
  for (const inputs::Recording& recording : drives)
    for (const Frame& frame : recording.drive.frames)
      if (const std::optional<SE3> pose = world_from_lidar.at(frame.time_ns))
        cameras[{recording.drive.camera_name, frame.name}] = {
            recording.drive.camera, recording.drive.camera_from_lidar * pose->inverse(), collect_outlines(frame.labels)};
  const fs::path file = out / "sources.json";
  try {
    const nlohmann::json document = read_json(file);
    const nlohmann::json& sources = document.at("sources");
    const std::string target = sources.at(0).at("drive"), own_camera = sources.at(0).at("camera");
    const std::vector<std::string> cleaned = list_cameras(list_frames(out));
    for (const nlohmann::json& source : sources) {
      const std::string drive = source.at("drive"), camera = source.at("camera"), frame = source.at("frame");
      const auto found = cameras.find({camera, frame});
      const bool is_judged = drive == target && found != cameras.end();
      scene.sources.push_back(is_judged ? std::optional(found->second) : std::nullopt);
      if (drive != target) continue;
      if (std::find(cleaned.begin(), cleaned.end(), camera) != cleaned.end())
        scene.frames.push_back(join_frame_name(camera, frame));
      else if (camera == own_camera)
        scene.frames.push_back(frame);
    }
  } catch (const nlohmann::json::exception& e) {
    throw InputError(file, fmt::format("is not what dvi run writes: {}", e.what()));
  }
  return scene;
}

SceneOrReason find_scene(const fs::path& out, const fs::path& labels, Progress& progress) {
  if (!fs::exists(out / "dvi.toml") || !fs::exists(out / "sources.json")) return out.string() + " is not a result of dvi run";
  if (!fs::exists(out / "map/poses.txt")) return out.string() + " has no poses";
  job::Job job;
  job.table().load_toml(out / "dvi.toml");
  if (job.read.remove == job::Remove::moving) return "stationary objects are not removed (--remove moving)";
  const inputs::Recordings drives = open_labeled(job, labels, progress);
  metrics::GhostScene scene = make_scene(out, drives);
  const Drive& target = drives.front().drive;
  if (!target.has_labels())
    return fmt::format("{} has no labels; give --labels FILE with 3D boxes and tracks", target.path.filename().string());
  if (scene.objects.empty())
    return fmt::format("the labels of {} have no stationary object: four 3D boxes of one track at one place",
                       target.path.filename().string());
  return scene;
}

SceneOrReason find_scene_or_reason(const fs::path& out, const fs::path& labels, Progress& progress) {
  if (!labels.empty() && !fs::exists(labels)) throw InputError(labels, "does not exist", "--labels takes a file of labels");
  if (!labels.empty()) return find_scene(out, labels, progress);
  Progress quiet(ProgressStyle::quiet);  // warnings about labels that the user did not give would be out of place
  try {
    return find_scene(out, labels, quiet);
  } catch (const InputError& e) {  // answered: the scores do not depend on the drive
    return std::string(e.what());
  } catch (const UsageError& e) {  // answered: options of an earlier version
    return std::string(e.what());
  }
}

}  // namespace

metrics::Evaluation evaluate_result(const metrics::EvaluationFolders& folders, const DriveTruth& drive, Progress& progress) {
  const SceneOrReason found = find_scene_or_reason(folders.out, drive.labels, progress);
  metrics::Evaluation evaluation = metrics::evaluate(folders, progress.parts());
  if (const auto* scene = std::get_if<metrics::GhostScene>(&found)) {
    progress.begin("ghosts", scene->frames.size());
    evaluation.ghosts = metrics::count_ghosts(folders.out, *scene, progress.tick());
  } else {
    evaluation.ghosts_left_out = std::get<std::string>(found);
  }
  progress.end();
  if (!drive.points.empty()) evaluation.points = score_points(folders.out, drive.points, progress);
  return evaluation;
}

}  // namespace dvi::commands
