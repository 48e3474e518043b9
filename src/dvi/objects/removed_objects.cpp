#include "dvi/objects/removed_objects.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/core/threads.h"
#include "dvi/image/region.h"
#include "dvi/objects/motion.h"

namespace dvi::objects {
namespace {

// The pixels of one object in one frame.
struct ObjectPixels {
  std::size_t pixels = 0;
  bool completed = false;
  std::string type;
};

std::size_t count_pixels(const Label& label, const CameraEvidence& evidence, const MaskOptions& options) {
  cv::Mat1b mask = draw_label(label, evidence.drive.camera, evidence.drive.camera_from_lidar, options);
  if (evidence.source == MaskSource::labels) mask = grown(mask, options.label_dilation_px());
  return static_cast<std::size_t>(cv::countNonZero(mask));
}

std::map<int, ObjectPixels> measure_frame(const CameraEvidence& evidence, const CameraObjects& objects, std::size_t frame,
                                          const MaskOptions& options) {
  std::map<int, ObjectPixels> out;
  const auto add = [&](const std::vector<Label>& labels, bool completed) {
    for (const Label& label : labels) {
      if (label.track < 0) continue;
      const std::size_t pixels = count_pixels(label, evidence, options);
      if (pixels == 0) continue;
      ObjectPixels& object = out[label.track];
      object.pixels += pixels;
      object.completed = object.completed || completed;
      if (object.type.empty()) object.type = label.type;
    }
  };
  // Mask files show objects without labels; all others have labels, which `shown` repeats.
  add(evidence.source == MaskSource::files ? (*objects.shown)[frame] : (*objects.labels)[frame], false);
  add((*objects.completed)[frame], true);
  return out;
}

std::map<int, MotionState> find_motions(const CameraEvidence& evidence, const CameraObjects& objects) {
  std::map<int, MotionState> out;
  if (evidence.source == MaskSource::labels)
    for (const TrackMotion& motion : measure_track_motions(evidence.drive, *objects.labels, evidence.world_from_lidar))
      out[motion.track] = motion.moves ? MotionState::moving : MotionState::stationary;
  if (evidence.source == MaskSource::found)
    for (const std::vector<Label>& frame : *objects.labels)
      for (const Label& label : frame) out[label.track] = MotionState::moving;
  for (const ObjectMotion& motion : objects.motions) out.try_emplace(motion.object, motion.state);
  return out;
}

const char* name_of(MotionState state) {
  return state == MotionState::moving ? "moving" : state == MotionState::stationary ? "static" : "unknown";
}

}  // namespace

std::vector<RemovedObject> list_removed_objects(const CameraEvidence& evidence, const CameraObjects& objects,
                                                const MaskOptions& options) {
  const std::vector<Frame>& frames = evidence.drive.frames;
  std::vector<std::map<int, ObjectPixels>> measured(frames.size());
  parallel_for(measured.size(), [&](std::size_t i) { measured[i] = measure_frame(evidence, objects, i, options); });
  std::map<int, RemovedObject> list;
  for (std::size_t i = 0; i < frames.size(); ++i)
    for (const auto& [number, shown] : measured[i]) {
      RemovedObject& object = list[number];
      object.number = number;
      if (object.type.empty()) object.type = shown.type;
      object.frames.push_back(frames[i].number);
      if (shown.completed) object.completed.push_back(frames[i].number);
      object.pixels += shown.pixels;
    }
  const std::map<int, MotionState> motions = find_motions(evidence, objects);
  std::vector<RemovedObject> out;
  for (auto& [number, object] : list) {
    if (const auto motion = motions.find(number); motion != motions.end()) object.motion = motion->second;
    out.push_back(std::move(object));
  }
  return out;
}

ObjectCounts count_objects(const std::vector<RemovedObject>& objects) {
  ObjectCounts out{.removed = objects.size()};
  std::set<int> frames;
  for (const RemovedObject& object : objects) {
    out.completed += object.completed.empty() ? 0 : 1;
    frames.insert(object.completed.begin(), object.completed.end());
    std::vector<int> whole;
    std::set_difference(object.frames.begin(), object.frames.end(), object.completed.begin(), object.completed.end(),
                        std::back_inserter(whole));
    if (whole.empty()) continue;
    out.late += !object.completed.empty() && object.completed.front() < whole.front() ? 1 : 0;
    out.with_gaps += std::any_of(object.completed.begin(), object.completed.end(),
                                 [&](int frame) { return frame > whole.front() && frame < whole.back(); })
                         ? 1
                         : 0;
  }
  out.completed_frames = frames.size();
  return out;
}

void to_json(nlohmann::json& json, const ObjectCounts& counts) {
  json = {{"removed", counts.removed},
          {"completed", counts.completed},
          {"completed_frames", counts.completed_frames},
          {"late", counts.late},
          {"with_gaps", counts.with_gaps}};
}

std::vector<std::string> describe_incomplete(const ObjectCounts& counts, const std::string& source) {
  std::vector<std::string> out;
  const auto describe = [&](std::size_t objects, const char* words) {
    if (objects > 0)
      out.push_back(
          fmt::format("{} of {} objects {} ({}); dvi run completes them, in {} frames in all; "
                      "--set objects.complete=false uses masks as given",
                      objects, counts.removed, words, source, counts.completed_frames));
  };
  describe(counts.late, "are visible before the first frame that shows them");
  describe(counts.with_gaps, "are missing in frames between others that show them");
  return out;
}

nlohmann::json objects_json(const std::vector<RemovedObject>& objects, const std::string& source) {
  nlohmann::json list = nlohmann::json::array();
  for (const RemovedObject& object : objects)
    list.push_back({{"object", object.number},
                    {"class", object.type.empty() ? nlohmann::json() : nlohmann::json(object.type)},
                    {"evidence", source},
                    {"motion", name_of(object.motion)},
                    {"first_frame", object.frames.front()},
                    {"last_frame", object.frames.back()},
                    {"frames", object.frames.size()},
                    {"completed_frames", object.completed},
                    {"removed_pixels", object.pixels}});
  return {{"schema", "dvi-objects/1"}, {"objects", list}};
}

}  // namespace dvi::objects
