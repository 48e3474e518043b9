#include "dvi/labels/scan_labels.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/core/error.h"
#include "dvi/labels/class_ids.h"

namespace dvi::labels {
namespace {

constexpr std::size_t kMaxInspectedFiles = 25;
constexpr std::size_t kMaxNamedScans = 5;

// Returns the label files of a folder by scan, an empty path for a scan without one. Adds a warning about these.
std::vector<fs::path> match_scans(Drive& drive, const fs::path& folder) {
  std::vector<fs::path> files;
  std::vector<std::string> missing;
  for (const ScanHeader& header : drive.scan_headers) {
    fs::path file = folder / (header.name + ".label");
    if (!fs::exists(file)) {
      missing.push_back(header.name);
      file.clear();
    }
    files.push_back(std::move(file));
  }
  if (missing.size() == files.size())
    throw InputError(folder,
                     fmt::format("has no label file of a scan of the drive: its scans are {} to {}, the first file is {}",
                                 drive.scan_headers.front().name, drive.scan_headers.back().name,
                                 list_files(folder, {".label"}).front().filename().string()),
                     "name the files as the scans: NAME.label");
  if (!missing.empty())
    drive.warnings.push_back(
        fmt::format("{} of {} scans have no labels in {}, and nothing is labeled in them: {}{}", missing.size(), files.size(),
                    folder.string(),
                    fmt::join(missing.begin(),
                              missing.begin() + static_cast<std::ptrdiff_t>(std::min(missing.size(), kMaxNamedScans)), ", "),
                    missing.size() > kMaxNamedScans ? ", ..." : ""));
  return files;
}

// Adds a warning if the labels have none of the classes, such as labels by the ids of a training.
void warn_of_other_classes(Drive& drive, const fs::path& folder, const std::vector<fs::path>& files,
                           const std::set<int>& classes) {
  std::set<int> present;
  std::size_t inspected = 0;
  const std::size_t step = (files.size() + kMaxInspectedFiles - 1) / kMaxInspectedFiles;
  for (std::size_t i = 0; i < files.size(); i += step) {
    if (files[i].empty()) continue;
    ++inspected;
    for (const std::uint32_t value : read_point_labels(files[i])) present.insert(class_of_point(value));
  }
  if (std::any_of(present.begin(), present.end(), [&](int id) { return classes.contains(id); })) return;
  drive.warnings.push_back(fmt::format(
      "none of {} inspected files in {} has a label of the removed classes ({}); their labels are {}; the ids must be those of "
      "SemanticKITTI, or of --classes",
      inspected, folder.string(), fmt::join(classes, ", "), fmt::join(present, ", ")));
}

using FilesPerScan = std::vector<fs::path>;

// Adds the labels in a file to those of a scan that are 0.
void add_labels_of(const fs::path& file, const Scan& scan, const std::set<int>& classes, PointLabels& labels) {
  const std::vector<std::uint32_t> read = read_point_labels(file);
  if (read.size() != scan.size_in_file())
    throw InputError(file, fmt::format("has {} labels, but its scan has {} points", read.size(), scan.size_in_file()),
                     "give the labels of these scans, one per point");
  for (std::size_t i = 0; i < scan.size(); ++i)
    if (const std::uint32_t value = read[scan.index_in_file(i)];
        labels.values[i] == 0 && classes.contains(class_of_point(value)))
      labels.values[i] = value;
}

}  // namespace

std::optional<fs::path> find_point_label_folder(const fs::path& given) {
  for (const fs::path& folder : {given, given / "labels", given / "predictions"})
    if (fs::is_directory(folder) && !list_files(folder, {".label"}).empty()) return folder;
  return std::nullopt;
}

std::vector<std::uint32_t> read_point_labels(const fs::path& file) {
  const std::string bytes = read_file(file);
  std::vector<std::uint32_t> values(bytes.size() / sizeof(std::uint32_t));
  if (bytes.size() != values.size() * sizeof(std::uint32_t))
    throw InputError(file, fmt::format("{} bytes are not a whole number of labels of 4 bytes", bytes.size()),
                     "write one uint32 per point, as in SemanticKITTI");
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

std::set<int> select_point_classes(const std::string& classes, bool moving_only) {
  std::set<int> ids;
  if (classes.empty())
    for (const PointClass& entry : kPointClasses) ids.insert({entry.stationary, entry.moving});
  else
    ids = parse_classes(classes.find(':') == std::string::npos ? "semantic-kitti:" + classes : classes).ids;
  ids.erase(0);
  if (moving_only) std::erase_if(ids, [](int id) { return !is_moving_point_class(id); });
  return ids;
}

void attach_point_labels(Drive& drive, const std::vector<fs::path>& folders, const std::set<int>& classes) {
  if (drive.scan_headers.empty())
    throw InputError(folders.front(), "has labels of points, but the drive has no scans", "give --masks DIR or --masks FILE");
  std::vector<FilesPerScan> sources;
  for (const fs::path& folder : folders) {
    sources.push_back(match_scans(drive, folder));
    warn_of_other_classes(drive, folder, sources.back(), classes);
    for (const fs::path& file : sources.back())
      if (!file.empty()) drive.other_files.push_back(file);
  }
  drive.point_labels = {drive.scan_headers.size(), [scans = drive.scans, sources, classes](std::size_t i) {
                          const auto scan = scans[i];
                          PointLabels labels{std::vector<std::uint32_t>(scan->size(), 0)};
                          for (const FilesPerScan& files : sources)
                            if (!files[i].empty()) add_labels_of(files[i], *scan, classes, labels);
                          return labels;
                        }};
}

}  // namespace dvi::labels
