#pragma once

#include <map>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"
#include "dvi/io/reader.h"

namespace dvi::io {

/// The labels of a file, and what does not fit the drive.
struct FileLabels {
  FrameLabels frames;                 ///< as drive.frames
  std::vector<std::string> warnings;  ///< labels of no frame of the recording, in words that name them
  Gap after_the_last;                 ///< frames behind the last one the file knows, where they are more than a twentieth
};

/// The labels of a file. Recognises by content: KITTI's tracklet_labels.xml, KITTI tracking labels, MOTS
/// instances_txt, boxes.json. What labels leave out of count (DontCare, MOTS' ignore regions) is no label. InputError where
/// the file is none of these, is malformed or was made for another camera.
FileLabels read_labels(const fs::path& file, const Drive& drive);

/// Adds the labels of a file to drive.frames, and notes the file and its warnings. Outlines join the label of the same track.
/// Returns the frames after the last labelled one.
Gap add_labels(Drive& drive, const fs::path& file);

using LabelsByNumber = std::map<int, std::vector<Label>>;
using LabelsByName = std::map<std::string, std::vector<Label>>;

/// The four formats, of a file's whole text. A frame that the file names without an object has an empty list. All boxes are in
/// LiDAR axes.
LabelsByNumber read_tracklets(const fs::path& file);
/// Boxes stand in the axes of a camera; `lidar_from_camera` takes them from there.
LabelsByNumber read_kitti_tracking(const fs::path& file, const SE3& lidar_from_camera);
/// `size` is that of the images. Track numbers are those of the tracking labels.
LabelsByNumber read_mots(const fs::path& file, cv::Size size);
LabelsByName read_boxes_json(const fs::path& file);

}  // namespace dvi::io
