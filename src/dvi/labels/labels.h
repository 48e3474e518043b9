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

/// The labels of a file, and what does not fit the drive.
struct FileLabels {
  FrameLabels frames;                 ///< as drive.frames
  std::vector<std::string> warnings;  ///< labels of no frame of the recording, in words that name them
  bool all_round = false;             ///< 3D boxes of whatever stands round the vehicle, not only of what one camera sees
  Gap after_the_last;                 ///< frames behind the last one the file knows, where they are more than a twentieth
  bool all_strays = false;            ///< it has labels, but none of a frame of the recording
  std::vector<fs::path> files;        ///< all that were read
};

/// One kind of label files.
struct LabelFormat {
  std::string name;                                      ///< for a person
  std::function<bool(std::string_view text)> recognize;  ///< of the text from its first character that is no blank on
  std::function<FileLabels(const fs::path&, const Drive&)> read;
};

/// All kinds; a new reader is one file and one line there.
const std::vector<LabelFormat>& label_formats();

/// The labels of a file, recognized by its content. What labels leave out of count (DontCare, MOTS' ignore regions) is no
/// label. InputError where the file is none of these formats, is malformed or was made for another camera. Of LabelMe, which
/// writes a file per image, `file` may be the folder.
FileLabels read_labels(const fs::path& file, const Drive& drive);

/// Whether a folder has label files of LabelMe, one per image, which read_labels() takes.
bool is_label_folder(const fs::path& folder);

/// Throws InputError, with the name of the format and a remedy, if a file, or the first label file of a folder, has a known
/// format that dvi does not read. An empty folder and all other files are fine.
void refuse_unread_labels(const fs::path& path);

/// A label file's text from its first character that is neither blank nor part of a byte order mark.
std::string_view label_text(std::string_view all);

/// Adds the labels of a file to drive.frames, and notes the file and its warnings. Outlines join the label of the same track.
/// Returns the frames after the last labeled one.
Gap add_labels(Drive& drive, const fs::path& file);

using LabelsByNumber = std::map<int, std::vector<Label>>;
using LabelsByName = std::map<std::string, std::vector<Label>>;

/// Labels by the names of frames, and what does not fit.
struct NamedLabels {
  LabelsByName frames;
  std::vector<std::string> warnings;
};

/// The formats, of a file's whole text. A frame that the file names without an object has an empty list. All boxes are in
/// LiDAR axes.
LabelsByNumber read_tracklets(const fs::path& file);
/// Boxes stand in the axes of a camera; `lidar_from_camera` takes them from there.
LabelsByNumber read_kitti_tracking(const fs::path& file, const SE3& lidar_from_camera);
/// `size` is that of the images. Track numbers are those of the tracking labels.
LabelsByNumber read_mots(const fs::path& file, cv::Size size);
/// Rectangles and outlines are those in the images of `camera`; where it is empty, there are none, and the boxes are of what
/// stands all round the vehicle.
struct BoxesFile {
  LabelsByName frames;
  std::string camera;
};
BoxesFile read_boxes_json(const fs::path& file);
/// COCO: polygons (all parts are one object), run lengths, or boxes where there is no segmentation. Image files are frames by
/// their names.
NamedLabels read_coco(const fs::path& file, const Drive& drive);
/// CVAT 1.1, for video and for images. Frame n of a track is the n-th image of the recording, from 0. Between two shapes of a
/// track corners move linearly; after the last it stays to the end of the task, unless it is outside.
NamedLabels read_cvat(const fs::path& file, const Drive& drive);

/// LabelMe: polygons, rectangles and circles, a JSON file per image. `source` is the folder or the only file, for messages.
NamedLabels read_labelme(const fs::path& source, const std::vector<fs::path>& files, const Drive& drive);

}  // namespace dvi::labels
