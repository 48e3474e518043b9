#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"
#include "dvi/labels/labels.h"

namespace dvi::labels {

/// The label files of a folder that has one per image.
struct LabelFolder {
  fs::path folder;
  std::vector<fs::path> files;   ///< in natural order
  std::vector<fs::path> shared;  ///< files that hold for all images, such as the names of classes
};

/// One format of label files with one file per image.
struct LabelFolderFormat {
  std::string name;                                            ///< the name in messages
  std::optional<LabelFolder> (*find)(const fs::path& folder);  ///< nothing if the folder has no files of this format
  NamedLabels (*read)(const LabelFolder& labels, const Drive& drive);
};

/// Returns all formats. A new reader is one file and one line there.
const std::vector<LabelFolderFormat>& label_folder_formats();

/// A folder of labels and its format.
struct FoundLabelFolder {
  LabelFolder labels;
  const LabelFolderFormat* format = nullptr;
};

/// Finds the label files of a camera in a folder, in the order: a folder of the camera's name (also within labels/, masks/ and
/// mask_data/), labels/ and mask_data/, the folder itself. Returns nothing if none of them has files of such a format.
std::optional<FoundLabelFolder> find_label_folder(const fs::path& given, const std::string& camera);

/// Adds the labels of a camera to the frames of its drive if the folder has them in a folder of the camera's name. Returns
/// whether it has.
bool attach_camera_labels(Drive& drive, const fs::path& given);

/// Returns the files with an ending of which the first is recognized by its text.
std::optional<LabelFolder> find_label_texts(const fs::path& folder, const std::string& ending,
                                            bool (*recognize)(std::string_view text));

/// Read one format each; see the table of docs/masks.md.
bool is_labelme(std::string_view text);
/// Returns whether the first line has a class and then numbers for a box at least, with `strict` fractions of the image.
bool is_yolo(std::string_view text, bool strict);
std::optional<LabelFolder> find_yolo(const fs::path& folder);
NamedLabels read_yolo(const LabelFolder& labels, const Drive& drive);
std::optional<LabelFolder> find_named_arrays(const fs::path& folder);
NamedLabels read_named_arrays(const LabelFolder& labels, const Drive& drive);

}  // namespace dvi::labels
