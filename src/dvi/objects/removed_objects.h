#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "dvi/objects/camera_objects.h"
#include "dvi/objects/evidence.h"
#include "dvi/objects/residue.h"

namespace dvi::objects {

/// The frames in which the result still shows an object.
struct ObjectResidue {
  std::vector<int> frames;          ///< numbers of these frames, ascending
  std::size_t unmasked_frames = 0;  ///< those in which most of the object was not removed
  double highest_score = 0;         ///< over all frames, FrameResidue::score()
  int highest_frame = -1;           ///< number of its frame
  cv::Rect highest_box;             ///< extent of the object there, in pixels
};

/// One removed object in the frames of a camera.
struct RemovedObject {
  std::string camera;  ///< empty if the result has one camera
  int number = -1;
  std::string type;  ///< its class, in lower case; empty if it is unknown
  MotionState motion = MotionState::unknown;
  MaskSources evidence;                  ///< the sources that show it
  std::vector<int> frames;               ///< numbers of the frames in which it is removed, ascending
  std::vector<int> completed;            ///< those in which its masks, labels, or detections lack a part of it or all of it
  std::size_t pixels = 0;                ///< removed pixels in all frames; overlapping objects count for each
  std::optional<ObjectResidue> residue;  ///< none if it was not measured or the object is too small in all frames
};

/// Lists the removed objects of a camera by their numbers. Labels without a track and masks without scans are left out, because
/// they do not show which object they belong to. `read_result` reads the frames in which the residue of the objects is
/// measured; if it is empty, the residue is not measured.
std::vector<RemovedObject> list_removed_objects(const CameraEvidence& evidence, const CameraObjects& objects,
                                                const MaskOptions& options, const ReadResult& read_result = {});

/// Returns the motion of the objects of a camera, by number; unknown ones are missing.
std::map<int, MotionState> find_motions(const CameraEvidence& evidence, const CameraObjects& objects);

/// Counts of removed objects, for summaries. An object that several cameras show is one object.
struct ObjectCounts {
  std::size_t removed = 0;
  std::size_t completed = 0;         ///< those that were completed in at least one frame
  std::size_t completed_frames = 0;  ///< frames in which at least one object was completed
  std::size_t late = 0;              ///< objects that were completed before the first frame whose mask shows them whole
  std::size_t with_gaps = 0;         ///< objects that were completed between such frames
  std::size_t visible = 0;           ///< objects that the result still shows in at least two consecutive frames
};
ObjectCounts count_objects(const std::vector<RemovedObject>& objects);
void to_json(nlohmann::json& json, const ObjectCounts& counts);

/// Describes masks, labels, or detections (`source`) that begin late or have gaps, one sentence each, with counts.
std::vector<std::string> describe_incomplete(const ObjectCounts& counts, const std::string& source);

/// Describes objects that the result still shows, one sentence each: the largest ones, and the number of others.
std::vector<std::string> describe_visible(const std::vector<RemovedObject>& objects);

/// Writes objects as objects.json lists them.
nlohmann::json objects_json(const std::vector<RemovedObject>& objects);

/// Writes objects as objects.csv lists them, which has a line per object and camera, for spreadsheets. Frames are joined by
/// blanks. The first objects are those that remain visible, then those with the highest score of their residue.
std::string objects_csv(const std::vector<RemovedObject>& objects);

}  // namespace dvi::objects
