#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"
#include "dvi/drive/gap.h"

namespace dvi::labels {

/// The labels of a file and its differences from the drive.
struct FileLabels {
  FrameLabels frames;                 ///< one list per frame of the drive
  std::vector<std::string> warnings;  ///< about labels of frames that the recording does not have
  bool all_around = false;  ///< the 3D boxes are of objects all around the vehicle, not only in the view of one camera
  Gap frames_after_last;    ///< frames after the last labeled one, if they are more than 5 % of all
  bool has_only_unknown_frames = false;  ///< it has labels, but none for a frame of the recording
  std::vector<fs::path> files;           ///< all files that were read
};

/// One format of label files.
struct LabelFormat {
  std::string name;                                      ///< the name in messages
  std::function<bool(std::string_view text)> recognize;  ///< gets the text without leading blanks
  std::function<FileLabels(const fs::path&, const Drive&)> read;
};

/// Returns all formats. A new reader is one file and one line there.
const std::vector<LabelFormat>& label_formats();

/// Reads the labels of a file, whose format is recognized by its content. Ignores regions that labels exclude (DontCare, MOTS'
/// ignore regions). `file` may be a folder with one label file per image; see find_label_folder(). Throws InputError if the
/// file has none of these formats, is malformed, or is for another camera.
FileLabels read_labels(const fs::path& file, const Drive& drive);

/// Returns whether a file or folder, which exists, has labels of a camera for read_labels(), instead of masks: a folder with
/// one label file per image, or a file that is not a video.
bool holds_labels(const fs::path& path, const std::string& camera);

/// Throws InputError with the name of the format and a remedy if a file, or the first label file of a folder, has a known
/// format that dvi does not support. Accepts empty folders and all other files.
void refuse_unread_labels(const fs::path& path);

/// Returns a label file's text without leading blanks and byte order mark.
std::string_view label_text(std::string_view all);

/// Adds the labels of a file to drive.frames, and the file and its warnings to the drive. Adds outlines to the label of the
/// same track. Returns the frames after the last labeled one.
Gap add_labels(Drive& drive, const fs::path& file);

using LabelsByNumber = std::map<int, std::vector<Label>>;
using LabelsByName = std::map<std::string, std::vector<Label>>;

/// Labels by the names of frames, and warnings.
struct NamedLabels {
  LabelsByName frames;
  std::vector<std::string> warnings;
};

/// Read one format each from a whole file. A frame that the file lists without an object has an empty list. All boxes are in
/// LiDAR axes. Each throws InputError if the file is malformed.
LabelsByNumber read_tracklets(const fs::path& file);
/// Transforms the boxes, which are in the axes of a camera, by `lidar_from_camera`.
LabelsByNumber read_kitti_tracking(const fs::path& file, const SE3& lidar_from_camera);
/// Requires images of `size`. The track numbers are those of the tracking labels.
LabelsByNumber read_mots(const fs::path& file, cv::Size size);
/// The labels of a boxes.json. Its rectangles and outlines are in the images of `camera`. If `camera` is empty, there are none,
/// and the boxes are of objects all around the vehicle.
struct BoxesFile {
  LabelsByName frames;
  std::string camera;
};
BoxesFile read_boxes_json(const fs::path& file);
/// Reads COCO: polygons (all parts are one object), run lengths, or boxes if there is no segmentation. The image files are
/// frames by name.
NamedLabels read_coco(const fs::path& file, const Drive& drive);
/// The segments of COCO panoptic JSON as labels, and the PNG files of their pixels.
struct PanopticLabels {
  NamedLabels labels;
  std::vector<fs::path> images;
};
/// Reads COCO panoptic JSON. The PNG files lie in the folder beside it with its name without extension, or beside the JSON
/// file. Reads things only, not stuff such as road and sky, unless all categories are stuff. Throws InputError if the PNG file
/// of a frame is missing.
PanopticLabels read_panoptic(const fs::path& file, const Drive& drive);
/// Reads CVAT 1.1 for video and for images. Frame n of a track is the n-th image of the recording, from 0. Corners are
/// interpolated linearly between two shapes of a track; the last shape stays until the end of the task, unless it is marked as
/// outside.
NamedLabels read_cvat(const fs::path& file, const Drive& drive);

/// Reads LabelMe: polygons, rectangles, circles and masks, one JSON file per image. `source` is the folder or the only file,
/// for messages.
NamedLabels read_labelme(const fs::path& source, const std::vector<fs::path>& files, const Drive& drive);

}  // namespace dvi::labels
