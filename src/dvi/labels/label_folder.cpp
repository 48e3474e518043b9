#include "dvi/labels/label_folder.h"

#include <algorithm>

#include "dvi/labels/mask_folder.h"

namespace dvi::labels {
namespace {

// Lists the folders that may hold a camera's labels, the most specific first.
std::vector<fs::path> list_candidates(const fs::path& given, const std::string& camera) {
  std::vector<fs::path> folders;
  for (const char* part : {"labels", "mask_data", "masks"}) folders.push_back(given / part / camera);
  folders.push_back(given / camera / "labels");
  folders.push_back(given / camera / "mask_data");
  folders.push_back(given / camera);
  for (const char* part : {"labels", "mask_data"}) folders.push_back(given / part);
  folders.push_back(given);
  return folders;
}

}  // namespace

std::optional<LabelFolder> find_label_texts(const fs::path& folder, const std::string& ending,
                                            bool (*recognize)(std::string_view text)) {
  const std::vector<fs::path> files = list_files(folder, {ending});
  if (files.empty() || !recognize(label_text(read_file(files.front())))) return std::nullopt;
  return LabelFolder{folder, files, {}};
}

const std::vector<LabelFolderFormat>& label_folder_formats() {
  static const std::vector<LabelFolderFormat> formats = {
      {"LabelMe JSON", [](const fs::path& folder) { return find_label_texts(folder, ".json", is_labelme); },
       [](const LabelFolder& labels, const Drive& drive) { return read_labelme(labels.folder, labels.files, drive); }},
      {"Grounded-SAM-2", find_named_arrays, read_named_arrays},
      {"YOLO labels", find_yolo, read_yolo},
  };
  return formats;
}

std::optional<FoundLabelFolder> find_label_folder(const fs::path& given, const std::string& camera) {
  for (const fs::path& folder : list_candidates(given, camera)) {
    if (!fs::is_directory(folder)) continue;
    for (const LabelFolderFormat& format : label_folder_formats())
      if (auto labels = format.find(folder)) return FoundLabelFolder{std::move(*labels), &format};
  }
  return std::nullopt;
}

bool attach_camera_labels(Drive& drive, const fs::path& given) {
  const auto found = find_label_folder(given, drive.camera_name);
  if (!found) return false;
  const fs::path inner = found->labels.folder.lexically_relative(given);
  if (std::find(inner.begin(), inner.end(), fs::path(drive.camera_name)) == inner.end()) return false;
  const FileLabels read = read_labels(given, drive);
  for (std::size_t i = 0; i < read.frames.size(); ++i) drive.frames[i].labels = read.frames[i];
  drive.warnings.insert(drive.warnings.end(), read.warnings.begin(), read.warnings.end());
  drive.other_files.insert(drive.other_files.end(), read.files.begin(), read.files.end());
  drive.labeled = true;
  drive.labeled_around = false;
  return true;
}

}  // namespace dvi::labels
