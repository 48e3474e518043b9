#include "dvi/objects/find_objects.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "dvi/objects/completion/complete.h"
#include "dvi/objects/draw_masks.h"
#include "dvi/objects/labeled_objects.h"
#include "dvi/objects/merge_labels.h"
#include "dvi/objects/motion_segmentation.h"
#include "dvi/objects/moving_objects.h"
#include "dvi/objects/past_border.h"
#include "dvi/objects/removed_objects.h"
#include "dvi/objects/track_outlines.h"

namespace dvi::objects {
namespace {

FrameLabels run_detector(const CameraEvidence& evidence, Progress& progress) {
  const Drive& drive = evidence.drive;
  progress.begin("detect", drive.frames.size());
  FrameLabels labels = detect_objects(drive, *evidence.detector, [&] { progress.advance(); });
  progress.end();
  set_source(labels, MaskSource::detected);
  if (std::all_of(labels.begin(), labels.end(), [](const std::vector<Label>& frame) { return frame.empty(); }))
    progress.warn(drive.path.filename().string() + ": the detector finds no object to remove in any frame");
  return labels;
}

FrameLabels select_objects(const CameraEvidence& evidence, const RemovalOptions& options, Progress& progress) {
  FrameLabels labels(evidence.drive.frames.size());
  if (evidence.is_given() || evidence.sources.empty()) labels = select_removed_labels(evidence, options);
  if (evidence.has(MaskSource::detected)) append(labels, run_detector(evidence, progress), next_track(labels));
  return labels;
}

// Returns whether the masks remove nothing in any frame. The first frame decides for most drives.
bool removes_nothing(const CameraEvidence& evidence, const SharedLabels& objects, const RemovalOptions& options) {
  const Lazy<cv::Mat1b> masks = draw_object_masks(evidence, objects, options);
  for (std::size_t i = 0; i < masks.size(); ++i)
    if (cv::countNonZero(*masks[i]) > 0) return false;
  return true;
}

// Describes the objects that move in the scans although masks or labels remove nothing.
std::string describe_unmasked_motion(const FrameLabels& moving, const Drive& drive) {
  std::set<int> tracks;
  std::optional<int> first;
  for (std::size_t i = 0; i < moving.size(); ++i)
    for (const Label& label : moving[i]) {
      tracks.insert(label.track);
      if (!first) first = drive.frames[i].number;
    }
  if (!first) return {};
  return fmt::format(", but its scans show {} object{} that move{}, the first in frame {}: give --masks found to remove them",
                     tracks.size(), tracks.size() == 1 ? "" : "s", tracks.size() == 1 ? "s" : "", *first);
}

std::string describe_nothing_removed(const Drive& drive, MaskSource source, const RemovalOptions& options) {
  std::size_t labels = 0;
  for (const Frame& frame : drive.frames) labels += frame.labels.size();
  if (source == MaskSource::labels)
    return fmt::format("its labels ({} in {} frames) remove nothing{}", labels, drive.frames.size(),
                       labels > 0 && options.remove == Remove::moving ? ": no labeled object moves" : "");
  if (!drive.mask_video.empty()) return "its video of masks is black and removes nothing";
  return fmt::format(
      "its {} mask files are empty and remove nothing",
      std::count_if(drive.mask_files.begin(), drive.mask_files.end(), [](const fs::path& file) { return !file.empty(); }));
}

bool has_boxes_with_tracks(const Drive& drive) {
  return std::any_of(drive.frames.begin(), drive.frames.end(), [](const Frame& frame) {
    return std::any_of(frame.labels.begin(), frame.labels.end(), [](const Label& l) { return l.track >= 0 && l.box; });
  });
}

// Warns if --remove moving cannot distinguish stationary objects.
void warn_of_all_removed(const CameraEvidence& evidence, Progress& progress) {
  const Drive& drive = evidence.drive;
  const auto warn = [&](const char* reason, const char* remedy) {
    progress.warn(fmt::format("{}: --remove moving: {}, so everything masked is removed; {}", drive.path.filename().string(),
                              reason, remedy));
  };
  if (evidence.has(MaskSource::detected))
    warn("a detector does not show which objects are stationary",
         "remove these from the masks that dvi mask writes, or use labels with 3D boxes");
  if (evidence.has(MaskSource::files))
    warn("mask files do not show which objects are stationary",
         "remove the objects to keep from the mask files, or use labels with 3D boxes");
  if (!evidence.has(MaskSource::labels)) return;
  if (evidence.world_from_lidar.empty())
    warn("without poses it is unknown which objects are stationary", "give --poses FILE");
  else if (!has_boxes_with_tracks(drive))
    warn("no label has a 3D box and a track that show which objects are stationary", "give such labels with --masks FILE");
}

// Labels that are not a source of the masks are not evidence, such as those of a drive whose mask files are used instead.
SharedLabels select_evidence(const CameraEvidence& camera, const SharedLabels& labels) {
  const auto is_other = [&](const Label& label) { return !camera.has(label.source); };
  const auto has_others = [&](const std::vector<Label>& frame) { return std::any_of(frame.begin(), frame.end(), is_other); };
  if (std::none_of(labels->begin(), labels->end(), has_others)) return labels;
  FrameLabels out = *labels;
  for (std::vector<Label>& frame : out) std::erase_if(frame, is_other);
  return shared(std::move(out));
}

CameraMaskEvidence collect_mask_evidence(const CameraEvidence& camera, const SharedLabels& labels,
                                         const RemovalOptions& options) {
  return {camera, draw_object_masks(camera, labels, options),
          draw_object_masks(camera, shared(select_unboxed(*labels)), options), select_evidence(camera, labels)};
}

bool removes_anything(const CameraMaskEvidence& camera) {
  for (std::size_t i = 0; i < camera.removed.size(); ++i)
    if (cv::countNonZero(*camera.removed[i]) > 0) return true;
  return false;
}

// Warns that the objects of a drive cannot be completed, if there are any.
void warn_of_incomplete(const CameraEvidence& own, const std::vector<CameraMaskEvidence>& cameras, Progress& progress) {
  if (std::none_of(cameras.begin(), cameras.end(), removes_anything)) return;
  const bool is_posed = !own.world_from_lidar.empty(), has_scans = !own.drive.scan_headers.empty();
  progress.warn(fmt::format(
      "{}: without {}, an object is not removed from frames and cameras whose masks lack it; {}", own.name,
      is_posed    ? "scans"
      : has_scans ? "poses"
                  : "poses and scans",
      has_scans ? "give --poses FILE, or masks of all objects in every frame" : "give masks of all objects in every frame"));
}

// Warns of labels that do not show the motion of their objects.
void warn_of_repeated_tracks(const CameraMaskEvidence& own, Progress& progress) {
  const std::map<int, std::size_t> repeated = find_repeated_tracks(*own.labels);
  if (repeated.empty()) return;
  const auto [track, frame] = *repeated.begin();
  progress.warn(
      fmt::format("{}: {} of the labeled tracks have several 3D boxes in one frame, such as track {} in frame {}, so their "
                  "boxes do not show where the objects are in other frames; give each object a track number of its own",
                  own.camera.name, repeated.size(), track, own.camera.drive.frames[frame].number));
}

// Collects the evidence of the cameras of a drive that show objects, by their indices. Objects in its scans are not evidence.
std::map<std::size_t, CameraMaskEvidence> collect_drive_evidence(const SearchInput& input, std::size_t own,
                                                                 const Objects& objects) {
  std::map<std::size_t, CameraMaskEvidence> out;
  for (std::size_t i = own; i < input.evidence.size(); ++i)
    if (input.evidence.own_camera(i) == own && input.evidence[i].shows_objects())
      out.emplace(i, collect_mask_evidence(input.evidence[i], objects[i].labels, input.options));
  return out;
}

// Completes the objects of the drive whose own camera is `own` in all of its cameras. Returns them by number.
std::map<int, CompletedObject> complete_drive(const SearchInput& input, std::size_t own, MovingObjects& moving,
                                              Objects& objects) {
  const auto& [evidence, options, progress] = input;
  std::vector<CameraMaskEvidence> cameras;
  std::vector<CameraObjects*> objects_of;  // per camera
  for (auto& [i, camera] : collect_drive_evidence(input, own, objects)) {
    cameras.push_back(camera);
    objects_of.push_back(&objects[i]);
  }
  if (cameras.empty()) return {};
  if (!evidence.ground(own)) {
    warn_of_incomplete(evidence[own], cameras, progress);
    return {};
  }
  warn_of_repeated_tracks(cameras.front(), progress);
  const DriveMotion& motion = moving.of_drive(own);
  progress.begin("complete", motion.returns->scans());
  CompletedObjects completed({cameras, *motion.returns, *motion.ground, motion.tracks, options.masks, options.objects.refine},
                             progress.tick());
  progress.end();
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    ObjectOutlines outlines = completed.draw(cameras[i]);
    objects_of[i]->completed = shared(std::move(outlines.completed));
    objects_of[i]->shown = shared(std::move(outlines.shown));
    objects_of[i]->background = shared(std::move(outlines.background));
    objects_of[i]->motions = completed.motions();
  }
  return std::move(completed).take();
}

// Warns about mask files and labels that remove nothing.
void warn_of_nothing_removed(const SearchInput& input, std::size_t index, const SharedLabels& labels, MovingObjects& moving) {
  const auto& [evidence, options, progress] = input;
  const CameraEvidence& camera = evidence[index];
  for (const MaskSource source : {MaskSource::files, MaskSource::labels}) {
    if (!camera.has(source) || !removes_nothing(camera.restricted_to({source}), labels, options)) continue;
    const bool is_only = camera.sources.size() == 1;
    progress.warn(camera.name + ": " + describe_nothing_removed(camera.drive, source, options) +
                  (is_only ? describe_unmasked_motion(moving.draw_outlines_in(index), camera.drive) : ""));
  }
}

// Returns the number after those of all objects of a drive, in all of its cameras.
int next_object(const Evidence& evidence, std::size_t own, const Objects& objects) {
  int next = 0;
  for (std::size_t i = own; i < evidence.size(); ++i) {
    if (evidence.own_camera(i) != own) continue;
    for (const SharedLabels& labels : {objects[i].labels, objects[i].completed, objects[i].shown})
      next = std::max(next, next_track(*labels));
    for (const ObjectMotion& motion : objects[i].motions) next = std::max(next, motion.object + 1);
  }
  return next;
}

// The objects that the scans of a drive show in the frames of a camera.
struct ScanObjects {
  FrameLabels labels;  // empty: the camera does not use them
  std::vector<ObjectMotion> motions{};
};

// Finds the labeled objects in the frames of a camera. `tracks` holds those that are known, by own camera.
ScanObjects find_labeled(const SearchInput& input, std::size_t index, std::map<std::size_t, LabeledTracks>& tracks) {
  const std::size_t own = input.evidence.own_camera(index);
  const auto [entry, is_new] = tracks.try_emplace(own);
  if (is_new) entry->second = find_labeled_tracks({input.evidence, own}, input.options, input.progress);
  return {draw_labeled_tracks({input.evidence, index}, entry->second, input.options), entry->second.motions()};
}

// Adds the objects in the scans of a drive to those of other sources, with the same numbers in all cameras of the drive.
// Returns the number of the first one.
int add_scan_objects(const Evidence& evidence, std::size_t own, std::vector<ScanObjects>& found, Objects& objects) {
  const int first = next_object(evidence, own, objects);
  for (std::size_t i = own; i < evidence.size(); ++i) {
    if (evidence.own_camera(i) != own || found[i].labels.empty()) continue;
    FrameLabels labels = *objects[i].labels;
    append(labels, std::move(found[i].labels), first);
    objects[i].labels = shared(std::move(labels));
    for (const ObjectMotion& motion : found[i].motions) objects[i].motions.push_back({first + motion.object, motion.state});
  }
  return first;
}

// The tracks of the target's drive, with the number of the first one.
struct NumberedTracks {
  SharedTracks tracks;  // null: they are not removed
  int first = 0;
};

// The objects of the target's drive as the search finds them.
struct TargetSearch {
  std::map<std::size_t, CameraMaskEvidence> cameras;  // by index
  std::map<int, CompletedObject> completed;           // by number
  NumberedTracks labeled, moving;
};

// Searches the objects of all drives. Sets `target` unless it is null.
Objects search(const SearchInput& input, MovingObjects& moving, std::map<std::size_t, LabeledTracks>& tracks_of,
               TargetSearch* target) {
  const auto& [evidence, options, progress] = input;
  Objects objects;
  std::vector<ScanObjects> labeled(evidence.size()), found(evidence.size());  // per camera
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    const CameraEvidence& camera = evidence[i];
    if (options.remove == Remove::moving && !camera.rig_of) warn_of_all_removed(camera, progress);
    objects.emplace_back(shared(select_objects(camera, options, progress)));
    if (!camera.rig_of) warn_of_nothing_removed(input, i, objects.back().labels, moving);
    if (camera.has(MaskSource::points)) labeled[i] = find_labeled(input, i, tracks_of);
    if (camera.has(MaskSource::found)) found[i] = {moving.find_in(i)};
  }
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    if (evidence[i].rig_of) continue;
    if (target && i == 0)
      for (std::size_t k = 0; k < evidence.size(); ++k)
        if (evidence.own_camera(k) == 0)
          target->cameras.emplace(k, collect_mask_evidence(evidence[k], objects[k].labels, options));
    std::map<int, CompletedObject> completed;
    if (options.objects.complete) completed = complete_drive(input, i, moving, objects);
    const int first_labeled = add_scan_objects(evidence, i, labeled, objects);
    const int first_found = add_scan_objects(evidence, i, found, objects);
    if (!target || i > 0) continue;
    target->completed = std::move(completed);
    if (evidence[i].has(MaskSource::points)) target->labeled = {tracks_of.at(i).tracks, first_labeled};
    if (evidence[i].has(MaskSource::found)) target->moving = {moving.of_drive(i).tracks, first_found};
  }
  return objects;
}

// Adds objects that are tracks.
void add_tracks(const NumberedTracks& numbered, ScannedObjects& out) {
  if (!numbered.tracks) return;
  for (std::size_t k = 0; k < numbered.tracks->size(); ++k) {
    const Track& track = (*numbered.tracks)[k];
    const int number = numbered.first + static_cast<int>(k);
    out.objects[number].tracks = {share_track(numbered.tracks, k)};
    const std::string type = label_type(track);
    out.types.try_emplace(number, type.empty() ? type_by_size(track.size_m) : type);
  }
}

// Collects the classes and motions of objects that a camera shows.
void add_descriptions(const CameraEvidence& camera, const CameraObjects& objects, ScannedObjects& out) {
  for (const SharedLabels& labels : {objects.labels, objects.shown, objects.completed})
    for (const std::vector<Label>& frame : *labels)
      for (const Label& label : frame)
        if (label.track >= 0 && !label.type.empty()) out.types.try_emplace(label.track, label.type);
  for (const auto& [number, state] : find_motions(camera, objects)) out.motions.try_emplace(number, state);
}

}  // namespace

Objects find_objects(const Evidence& evidence, const RemovalOptions& options, Progress& progress) {
  const SearchInput input{evidence, options, progress};
  MovingObjects moving(input);
  std::map<std::size_t, LabeledTracks> tracks_of;  // by own camera
  return search(input, moving, tracks_of, nullptr);
}

ScannedObjects find_scanned_objects(const Evidence& evidence, const RemovalOptions& options, Progress& progress) {
  const SearchInput input{evidence, options, progress};
  MovingObjects moving(input);
  std::map<std::size_t, LabeledTracks> tracks_of;  // by own camera
  TargetSearch target;
  const Objects objects = search(input, moving, tracks_of, &target);
  const CameraEvidence& own = evidence[0];
  ScannedObjects out{own.drive, own.world_from_lidar, options.masks, evidence.ground(0), moving.of_drive(0).returns};
  for (std::size_t i = 0; i < evidence.size(); ++i)
    if (evidence.own_camera(i) == 0) add_descriptions(evidence[i], objects[i], out);
  for (auto& [i, camera] : target.cameras)
    out.cameras.push_back({camera, {objects[i].labels, objects[i].shown, objects[i].completed}});
  out.objects = std::move(target.completed);
  for (LabeledBoxes& boxes : LabeledBoxes::collect(own.drive, *target.cameras.at(0).labels, own.world_from_lidar))
    out.objects[boxes.track()].boxes = std::move(boxes);
  add_tracks(target.labeled, out);
  add_tracks(target.moving, out);
  out.all_moving = target.moving.tracks != nullptr;
  if (target.moving.tracks)
    for (std::size_t k = 0; k < target.moving.tracks->size(); ++k)
      out.motions[target.moving.first + static_cast<int>(k)] = MotionState::moving;
  return out;
}

}  // namespace dvi::objects
