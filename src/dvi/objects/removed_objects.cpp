#include "dvi/objects/removed_objects.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/core/threads.h"
#include "dvi/image/region.h"
#include "dvi/objects/motion.h"

namespace dvi::objects {
namespace {

constexpr std::size_t kMaxDescribedObjects = 5;

// One object in one frame.
struct ObjectPixels {
  std::size_t pixels = 0;
  bool completed = false;
  std::string type;
  MaskSources evidence;
  std::optional<FrameResidue> residue;
  cv::Rect box;
};

// Measures the removed objects of a camera in its frames and, if there is one, in a result.
class ObjectMeasurement {
 public:
  ObjectMeasurement(const CameraEvidence& evidence, const CameraObjects& objects, const MaskOptions& options,
                    const ReadResult& read_result)
      : evidence_(evidence), objects_(objects), options_(options), read_result_(read_result) {}

  std::map<int, ObjectPixels> measure(std::size_t frame) const {
    std::map<int, ObjectPixels> out;
    std::map<int, cv::Mat1b> silhouettes;
    const bool dilates_completed = evidence_.has(MaskSource::labels);
    const auto add = [&](const std::vector<Label>& labels, bool completed) {
      for (const Label& label : labels) {
        if (label.track < 0) continue;
        const cv::Mat1b silhouette = draw_label(label, evidence_.drive.camera, evidence_.drive.camera_from_lidar, options_);
        const bool is_dilated = completed ? dilates_completed : label.source == MaskSource::labels;
        const auto pixels = static_cast<std::size_t>(
            cv::countNonZero(is_dilated ? grown(silhouette, options_.label_dilation_px()) : silhouette));
        if (pixels == 0) continue;
        cv::Mat1b& whole = silhouettes[label.track];
        whole = whole.empty() ? silhouette : cv::Mat1b(whole | silhouette);
        ObjectPixels& object = out[label.track];
        object.pixels += pixels;
        object.completed = object.completed || completed;
        if (object.type.empty()) object.type = label.type;
        if (!completed) object.evidence.insert(label.source);
      }
    };
    add(collect_labels(frame), false);
    add((*objects_.completed)[frame], true);
    if (out.empty() || !read_result_) return out;
    if (const std::optional<ResultImages> images = read_result_(frame))
      for (auto& [number, object] : out) {
        object.residue = measure_residue(*images, silhouettes[number]);
        object.box = cv::boundingRect(silhouettes[number]);
      }
    return out;
  }

 private:
  // Returns the labels in a frame that show removed objects: those of the sources, and the parts of other objects that masks
  // show.
  std::vector<Label> collect_labels(std::size_t frame) const {
    std::vector<Label> out;
    std::set<int> tracks;
    for (const Label& label : (*objects_.labels)[frame]) {
      if (!evidence_.has(label.source)) continue;
      out.push_back(label);
      tracks.insert(label.track);
    }
    if (!evidence_.has(MaskSource::files)) return out;  // labels of other sources show their objects themselves
    for (const Label& label : (*objects_.shown)[frame]) {
      if (tracks.contains(label.track)) continue;
      out.push_back(label);
      out.back().source = MaskSource::files;
    }
    return out;
  }

  const CameraEvidence& evidence_;
  const CameraObjects& objects_;
  const MaskOptions& options_;
  const ReadResult& read_result_;
};

// Adds a frame to the residue of an object.
void add_residue(const ObjectPixels& shown, int frame, std::optional<ObjectResidue>& residue) {
  const FrameResidue& found = *shown.residue;
  if (!residue) residue.emplace();
  if (found.is_visible()) {
    residue->frames.push_back(frame);
    residue->unmasked_frames += found.is_unmasked() ? 1 : 0;
  }
  if (residue->highest_frame >= 0 && found.score() <= residue->highest_score) return;
  residue->highest_score = found.score();
  residue->highest_frame = frame;
  residue->highest_box = shown.box;
}

// Returns whether a result still shows an object: in two consecutive of its frames, because the score is wrong in single frames
// at times.
bool is_visible(const RemovedObject& object) {
  if (!object.residue || object.residue->frames.empty()) return false;
  if (object.frames.size() <= 1) return true;
  const std::vector<int>& visible = object.residue->frames;
  for (auto frame = object.frames.begin(); std::next(frame) != object.frames.end(); ++frame)
    if (std::binary_search(visible.begin(), visible.end(), *frame) &&
        std::binary_search(visible.begin(), visible.end(), *std::next(frame)))
      return true;
  return false;
}

// Returns "frame 3", or "frames 3-5, 8".
std::string describe_frames(const std::vector<int>& frames) {
  std::vector<std::string> ranges;
  for (std::size_t first = 0, next = 1; next <= frames.size(); ++next) {
    if (next < frames.size() && frames[next] == frames[next - 1] + 1) continue;
    ranges.push_back(next - first == 1 ? std::to_string(frames[first]) : fmt::format("{}-{}", frames[first], frames[next - 1]));
    first = next;
  }
  return fmt::format("frame{} {}", frames.size() == 1 ? "" : "s", fmt::join(ranges, ", "));
}

std::string describe_residue(const RemovedObject& object) {
  const ObjectResidue& residue = *object.residue;
  const bool is_unmasked = 2 * residue.unmasked_frames > residue.frames.size();
  return fmt::format("object {}{} remains visible in {}{}: {}", object.number,
                     object.type.empty() ? "" : " (" + object.type + ")", describe_frames(residue.frames),
                     object.camera.empty() ? "" : " of " + object.camera,
                     is_unmasked ? "most of it was not removed" : "its pixels in other frames were used as sources");
}

const char* name_of(MotionState state) {
  return state == MotionState::moving ? "moving" : state == MotionState::stationary ? "static" : "unknown";
}

nlohmann::json residue_json(const RemovedObject& object) {
  if (!object.residue) return {};
  const ObjectResidue& residue = *object.residue;
  const cv::Rect& box = residue.highest_box;
  return {{"remains_visible", is_visible(object)},        {"visible_frames", residue.frames},
          {"unmasked_frames", residue.unmasked_frames},   {"highest_score", std::round(1000 * residue.highest_score) / 1000},
          {"highest_score_frame", residue.highest_frame}, {"highest_score_box", {box.x, box.y, box.width, box.height}}};
}

// Quotes a field that holds a separator, as RFC 4180 requires.
std::string quote(const std::string& field) {
  if (field.find_first_of(",\"\n\r") == std::string::npos) return field;
  std::string out = "\"";
  for (const char c : field) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

std::string format_residue(const RemovedObject& object) {
  if (!object.residue) return "not measured,,,,,,,,";
  const ObjectResidue& residue = *object.residue;
  const cv::Rect& box = residue.highest_box;
  return fmt::format("{},{},{},{:.3f},{},{},{},{},{}", is_visible(object) ? "yes" : "no", fmt::join(residue.frames, " "),
                     residue.unmasked_frames, residue.highest_score, residue.highest_frame, box.x, box.y, box.width,
                     box.height);
}

}  // namespace

std::map<int, MotionState> find_motions(const CameraEvidence& evidence, const CameraObjects& objects) {
  std::map<int, MotionState> out;
  if (evidence.has(MaskSource::labels))
    for (const TrackMotion& motion : measure_track_motions(evidence.drive, *objects.labels, evidence.world_from_lidar))
      out[motion.track] = motion.moves ? MotionState::moving : MotionState::stationary;
  if (evidence.has(MaskSource::found))
    for (const std::vector<Label>& frame : *objects.labels)
      for (const Label& label : frame)
        if (label.source == MaskSource::found) out[label.track] = MotionState::moving;
  for (const ObjectMotion& motion : objects.motions) out.try_emplace(motion.object, motion.state);
  return out;
}

std::vector<RemovedObject> list_removed_objects(const CameraEvidence& evidence, const CameraObjects& objects,
                                                const MaskOptions& options, const ReadResult& read_result) {
  const std::vector<Frame>& frames = evidence.drive.frames;
  std::vector<std::map<int, ObjectPixels>> measured(frames.size());
  const ObjectMeasurement measurement(evidence, objects, options, read_result);
  parallel_in_order(measured.size(), [&](std::size_t i) { measured[i] = measurement.measure(i); });
  std::map<int, RemovedObject> list;
  for (std::size_t i = 0; i < frames.size(); ++i)
    for (const auto& [number, shown] : measured[i]) {
      RemovedObject& object = list[number];
      object.number = number;
      if (object.type.empty()) object.type = shown.type;
      object.evidence.insert(shown.evidence.begin(), shown.evidence.end());
      object.frames.push_back(frames[i].number);
      if (shown.completed) object.completed.push_back(frames[i].number);
      object.pixels += shown.pixels;
      if (shown.residue) add_residue(shown, frames[i].number, object.residue);
    }
  const std::map<int, MotionState> motions = find_motions(evidence, objects);
  // Masks without track numbers show the objects that are completed only.
  const MaskSources shown_by =
      evidence.restricted_to({MaskSource::files, MaskSource::labels, MaskSource::detected, MaskSource::reprojected}).sources;
  std::vector<RemovedObject> out;
  for (auto& [number, object] : list) {
    if (const auto motion = motions.find(number); motion != motions.end()) object.motion = motion->second;
    if (object.evidence.empty()) object.evidence = shown_by;
    out.push_back(std::move(object));
  }
  return out;
}

ObjectCounts count_objects(const std::vector<RemovedObject>& objects) {
  std::set<int> removed, completed, late, with_gaps, visible;
  std::set<std::pair<std::string, int>> frames;
  for (const RemovedObject& object : objects) {
    removed.insert(object.number);
    if (!object.completed.empty()) completed.insert(object.number);
    if (is_visible(object)) visible.insert(object.number);
    for (const int frame : object.completed) frames.emplace(object.camera, frame);
    std::vector<int> whole;
    std::set_difference(object.frames.begin(), object.frames.end(), object.completed.begin(), object.completed.end(),
                        std::back_inserter(whole));
    if (whole.empty()) continue;
    if (!object.completed.empty() && object.completed.front() < whole.front()) late.insert(object.number);
    if (std::any_of(object.completed.begin(), object.completed.end(),
                    [&](int frame) { return frame > whole.front() && frame < whole.back(); }))
      with_gaps.insert(object.number);
  }
  return {.removed = removed.size(),
          .completed = completed.size(),
          .completed_frames = frames.size(),
          .late = late.size(),
          .with_gaps = with_gaps.size(),
          .visible = visible.size()};
}

void to_json(nlohmann::json& json, const ObjectCounts& counts) {
  json = {{"removed", counts.removed}, {"completed", counts.completed}, {"completed_frames", counts.completed_frames},
          {"late", counts.late},       {"with_gaps", counts.with_gaps}, {"visible", counts.visible}};
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

std::vector<std::string> describe_visible(const std::vector<RemovedObject>& objects) {
  std::vector<const RemovedObject*> visible;
  for (const RemovedObject& object : objects)
    if (is_visible(object)) visible.push_back(&object);
  std::stable_sort(visible.begin(), visible.end(),
                   [](const RemovedObject* a, const RemovedObject* b) { return a->pixels > b->pixels; });
  std::vector<std::string> out;
  for (std::size_t i = 0; i < std::min(visible.size(), kMaxDescribedObjects); ++i) out.push_back(describe_residue(*visible[i]));
  if (const std::size_t others = visible.size() - out.size(); others > 0)
    out.push_back(fmt::format("{} other object{} visible, see objects.json", others, others == 1 ? " remains" : "s remain"));
  return out;
}

nlohmann::json objects_json(const std::vector<RemovedObject>& objects) {
  nlohmann::json list = nlohmann::json::array();
  for (const RemovedObject& object : objects) {
    list.push_back({{"object", object.number},
                    {"class", object.type.empty() ? nlohmann::json() : nlohmann::json(object.type)},
                    {"evidence", to_string(object.evidence)},
                    {"motion", name_of(object.motion)},
                    {"first_frame", object.frames.front()},
                    {"last_frame", object.frames.back()},
                    {"frames", object.frames.size()},
                    {"completed_frames", object.completed},
                    {"removed_pixels", object.pixels},
                    {"residue", residue_json(object)}});
    if (!object.camera.empty()) list.back()["camera"] = object.camera;
  }
  return {{"schema", "dvi-objects/1"}, {"objects", list}};
}

std::string objects_csv(const std::vector<RemovedObject>& objects) {
  std::vector<const RemovedObject*> order;
  for (const RemovedObject& object : objects) order.push_back(&object);
  const auto rank = [](const RemovedObject* object) {
    return std::pair(is_visible(*object), object->residue ? object->residue->highest_score : -1.0);
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](const RemovedObject* a, const RemovedObject* b) { return rank(a) > rank(b); });
  std::string text =
      "object,camera,class,evidence,motion,first_frame,last_frame,frames,completed_frames,removed_pixels,remains_visible,"
      "visible_frames,unmasked_frames,highest_score,highest_score_frame,box_x,box_y,box_width,box_height\r\n";
  for (const RemovedObject* object : order)
    text +=
        fmt::format("{},{},{},{},{},{},{},{},{},{},{}\r\n", object->number, quote(object->camera), quote(object->type),
                    quote(to_string(object->evidence)), name_of(object->motion), object->frames.front(), object->frames.back(),
                    object->frames.size(), fmt::join(object->completed, " "), object->pixels, format_residue(*object));
  return text;
}

}  // namespace dvi::objects
