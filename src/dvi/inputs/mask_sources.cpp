#include "dvi/inputs/mask_sources.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/labels/class_ids.h"
#include "dvi/labels/labels.h"
#include "dvi/labels/mask_folder.h"
#include "dvi/labels/mask_reading.h"
#include "dvi/labels/scan_labels.h"
#include "dvi/objects/merge_labels.h"

namespace dvi::inputs {
namespace {

using Kind = job::MasksFrom::Kind;

// The sources that the values of `--masks` name, each once, resolved for one drive.
struct NamedSources {
  bool files = false;                   // the drive's own mask files
  bool labels = false;                  // the drive's own labels
  bool found = false;                   // moving objects
  std::vector<job::MasksFrom> folders;  // folders of mask files, or videos of masks
  std::vector<fs::path> point_folders;  // folders of labels of points
  std::vector<fs::path> label_files;    // or folders of label files
};

void name_automatic(const Drive& drive, MaskNeed need, NamedSources& out) {
  if (!drive.masks.empty())
    out.files = true;
  else if (drive.has_labels())
    out.labels = true;
  else
    out.found |= need != MaskNeed::optional && !drive.scan_headers.empty();
}

void name_path(const Drive& drive, const job::MasksFrom& from, NamedSources& out) {
  if (!fs::exists(from.path))
    throw InputError(from.path, "does not exist", "--masks takes a folder, a file, labels, found, auto or none");
  const auto point_folder = fs::is_directory(from.path) ? labels::find_point_label_folder(from.path) : std::nullopt;
  if (!point_folder && !labels::holds_labels(from.path, drive.camera_name)) {
    const auto same = std::find_if(out.folders.begin(), out.folders.end(), [&](const auto& o) { return o.path == from.path; });
    if (same == out.folders.end())
      out.folders.push_back(from);
    else if (*same != from)
      throw UsageError("--masks " + to_string(*same) + " and " + to_string(from) + " contradict each other");
    return;
  }
  if (from.polarity != labels::Polarity::automatic)
    throw UsageError("--masks " + to_string(from) + ": only mask files have a polarity");
  std::vector<fs::path>& named = point_folder ? out.point_folders : out.label_files;
  const fs::path path = point_folder.value_or(from.path);
  if (std::find(named.begin(), named.end(), path) == named.end()) named.push_back(path);
}

NamedSources name_sources(const Drive& drive, const job::ReadChoice& choice, MaskNeed need) {
  NamedSources out;
  for (const job::MasksFrom& from : choice.masks) {
    if (from.kind == Kind::automatic) name_automatic(drive, need, out);
    if (from.kind == Kind::path) name_path(drive, from, out);
    if (from.kind == Kind::labels && !drive.has_labels())
      throw InputError(drive.path, "has no labels", "give --masks DIR or --masks FILE");
    out.labels |= from.kind == Kind::labels;
    if (from.kind == Kind::found && drive.scan_headers.empty())
      throw InputError(drive.path, "has no scans in which moving objects could be found", "give --masks DIR or --masks FILE");
    out.found |= from.kind == Kind::found && need != MaskNeed::optional;
  }
  const bool has_files = out.files || !out.folders.empty();
  out.labels |= choice.remove == job::Remove::all && has_files && drive.has_labels() && out.label_files.empty();
  return out;
}

// Replaces the drive's labels by those of files, or of folders with one file per image, or adds these to them.
void attach_labels(Drive& drive, const std::vector<fs::path>& files, bool and_own) {
  FrameLabels labels = and_own ? drive.labels() : FrameLabels(drive.frames.size());
  bool all_around = !and_own || drive.labeled_around;
  for (const fs::path& path : files) {
    labels::FileLabels read = labels::read_labels(path, drive);
    if (read.has_only_unknown_frames)
      throw InputError(path, "has no labels of the drive: " + read.warnings.front(),
                       "give the labels of this drive, or name its images as the labels do");
    objects::append(labels, std::move(read.frames), objects::next_track(labels));
    drive.warnings.insert(drive.warnings.end(), read.warnings.begin(), read.warnings.end());
    if (const Gap& gap = read.frames_after_last; !gap.frames.empty())
      drive.warnings.push_back(gap.what + " " + format_ranges(gap.frames));
    all_around &= read.all_around;
    drive.other_files.insert(drive.other_files.end(), read.files.begin(), read.files.end());
  }
  for (std::size_t i = 0; i < labels.size(); ++i) drive.frames[i].labels = std::move(labels[i]);
  drive.labeled = true;
  drive.labeled_around = all_around;
}

// Adds mask files to those of a drive.
void unite_masks(const std::vector<fs::path>& files, const Lazy<cv::Mat1b>& masks, Drive& drive) {
  if (drive.mask_files.empty()) {
    drive.mask_files = files;
    drive.masks = masks;
    return;
  }
  for (std::size_t i = 0; i < files.size(); ++i)
    if (drive.mask_files[i].empty())
      drive.mask_files[i] = files[i];
    else if (!files[i].empty())
      drive.other_files.push_back(files[i]);
  drive.masks = {masks.size(), [a = drive.masks, b = masks](std::size_t i) { return cv::Mat1b(*a[i] | *b[i]); }};
}

// Applies `--classes` to the labels of a drive.
void select_classes(Drive& drive, const MaskSources& sources, const job::ReadChoice& choice) {
  const std::string& classes = choice.mask_files.classes;
  const bool has_labels = sources.contains(MaskSource::labels);
  if (has_labels && (classes.empty() || choice.is_source)) labels::warn_of_unknown_types(drive);
  if (classes.empty() || choice.is_source) return;
  if (has_labels) return labels::keep_label_types(drive, classes);
  for (const MaskSource source : {MaskSource::files, MaskSource::points, MaskSource::detected})
    if (sources.contains(source)) return;
  throw UsageError("--classes " + classes + ": the drive has neither mask files nor labels to choose from");
}

// Reports a drive of whose objects no source shows anything.
void report_missing(Drive& drive, const job::ReadChoice& choice, MaskNeed need) {
  if (need == MaskNeed::optional) return;
  const auto is_none = [](const job::MasksFrom& from) { return from.kind == Kind::none; };
  if (std::all_of(choice.masks.begin(), choice.masks.end(), is_none))
    throw UsageError("--masks none removes nothing: give --detector MODEL.onnx, or masks");
  if (need == MaskNeed::required)
    throw InputError(drive.path, "has neither masks nor labels, and no scans in which moving objects could be found",
                     "give --masks DIR (PNG files named as the images, 255 = remove) or --masks FILE (labels)");
  drive.warnings.emplace_back("has neither masks nor labels nor scans, so its traffic may be copied into the result");
}

}  // namespace

void attach_mask_files(Drive& drive, const std::vector<job::MasksFrom>& folders, bool and_own, const job::ReadChoice& choice) {
  if (and_own) labels::read_masks(drive, choice.mask_files);
  if (folders.empty()) return;
  std::vector<fs::path> own_files = and_own ? drive.mask_files : std::vector<fs::path>{};
  Lazy<cv::Mat1b> own_masks = and_own ? drive.masks : Lazy<cv::Mat1b>();
  for (const job::MasksFrom& from : folders) {
    labels::MaskReading reading = choice.mask_files;
    if (from.polarity != labels::Polarity::automatic) reading.polarity = from.polarity;
    labels::attach_masks(drive, from.path);
    labels::read_masks(drive, reading);
    const std::vector<fs::path> files = std::exchange(drive.mask_files, own_files);
    const Lazy<cv::Mat1b> masks = std::exchange(drive.masks, own_masks);
    unite_masks(files, masks, drive);
    own_files = drive.mask_files;
    own_masks = drive.masks;
  }
}

MaskSources without_scans(MaskSources sources) {
  for (const MaskSource source : {MaskSource::points, MaskSource::found}) sources.erase(source);
  return sources;
}

MaskSources attach_mask_sources(Drive& drive, const job::ReadChoice& choice, MaskNeed need) {
  const NamedSources named = name_sources(drive, choice, need);
  MaskSources sources;
  if (named.files || !named.folders.empty()) sources.insert(MaskSource::files);
  if (named.labels || !named.label_files.empty()) sources.insert(MaskSource::labels);
  if (!named.point_folders.empty()) sources.insert(MaskSource::points);
  if (named.found) sources.insert(MaskSource::found);
  if (!choice.detector.empty()) sources.insert(MaskSource::detected);
  if (sources.empty()) report_missing(drive, choice, need);
  attach_mask_files(drive, named.folders, named.files, choice);
  if (!named.label_files.empty()) attach_labels(drive, named.label_files, named.labels);
  if (!named.point_folders.empty())
    labels::attach_point_labels(drive, named.point_folders,
                                labels::select_point_classes(choice.mask_files.classes, choice.remove == job::Remove::moving));
  select_classes(drive, sources, choice);
  return sources;
}

}  // namespace dvi::inputs
