#include "dvi/commands/make_masks.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/commands/outline_masks.h"
#include "dvi/core/json_text.h"
#include "dvi/core/threads.h"
#include "dvi/inputs/collect_evidence.h"
#include "dvi/inputs/memory_plan.h"
#include "dvi/inputs/rig.h"
#include "dvi/labels/mask_folder.h"
#include "dvi/labels/write_labels.h"
#include "dvi/media/contact_sheet.h"
#include "dvi/media/write_image.h"
#include "dvi/objects/motion.h"
#include "dvi/result/usable_folder.h"

namespace dvi::commands {
namespace {

constexpr std::size_t kMaskRows = 12, kMaskColumns = 2;

cv::Mat3b make_sheet(const Drive& drive, const Lazy<cv::Mat1b>& masks) {
  const std::size_t count = std::min(drive.frames.size(), kMaskRows * kMaskColumns);
  std::vector<media::SheetCell> cells(count);
  parallel_for(count, [&](std::size_t k) {
    const std::size_t i = count < 2 ? 0 : k * (drive.frames.size() - 1) / (count - 1);
    cells[k] = {media::make_thumbnail(media::draw_mask_overlay(*drive.images[i], *masks[i]), 640), drive.frames[i].name};
  });
  std::vector<std::vector<media::SheetCell>> rows;
  for (std::size_t k = 0; k < count; k += kMaskColumns)
    rows.emplace_back(cells.begin() + static_cast<std::ptrdiff_t>(k),
                      cells.begin() + static_cast<std::ptrdiff_t>(std::min(count, k + kMaskColumns)));
  return media::make_contact_sheet(rows, 640);
}

void list_detected_tracks(const Drive& drive, const FrameLabels& objects, nlohmann::json& tracks) {
  struct Span {
    std::string type;
    std::size_t first = 0, last = 0, frames = 0;
  };
  std::map<int, Span> spans;
  for (std::size_t i = 0; i < objects.size(); ++i)
    for (const Label& label : objects[i]) {
      if (label.source != MaskSource::detected) continue;
      Span& span = spans.try_emplace(label.track, Span{label.type, i}).first->second;
      span.last = i;
      ++span.frames;
    }
  for (const auto& [track, span] : spans)
    tracks.push_back({{"track", track},
                      {"type", span.type},
                      {"removed", true},
                      {"first_frame", drive.frames[span.first].number},
                      {"last_frame", drive.frames[span.last].number},
                      {"frames", span.frames}});
}

nlohmann::json tracks_json(const inputs::Recording& open, const FrameLabels& removed, const Trajectory& world_from_lidar) {
  const Drive& drive = open.drive;
  const bool is_given = open.masks_from.contains(MaskSource::files) || open.masks_from.contains(MaskSource::labels);
  FrameLabels labels = is_given ? drive.labels() : FrameLabels(drive.frames.size());
  for (std::size_t i = 0; i < labels.size(); ++i)
    std::copy_if(removed[i].begin(), removed[i].end(), std::back_inserter(labels[i]),
                 [](const Label& label) { return is_of_scans(label.source); });
  std::set<int> gone;
  for (const std::vector<Label>& frame : removed)
    for (const Label& label : frame) gone.insert(label.track);
  nlohmann::json tracks = nlohmann::json::array();
  for (const objects::TrackMotion& motion : objects::measure_track_motions(drive, labels, world_from_lidar))
    tracks.push_back({{"track", motion.track},
                      {"type", motion.type},
                      {"moves", motion.moves},
                      {"removed", gone.contains(motion.track)},
                      {"speed_mps", motion.speed_mps},
                      {"displacement_m", motion.displacement_m},
                      {"displacement_sigma_m", motion.displacement_sigma_m},
                      {"first_frame", drive.frames[motion.first].number},
                      {"last_frame", drive.frames[motion.last].number},
                      {"frames", motion.frames}});
  list_detected_tracks(drive, removed, tracks);
  return tracks;
}

// Returns the dilation of labels and detections if there are any, else that of mask files.
int dilation_px(const inputs::Recording& open, const objects::MaskOptions& options) {
  const MaskSources& from = open.masks_from;
  if (from.contains(MaskSource::labels) || from.contains(MaskSource::detected)) return options.label_dilation_px();
  return from.contains(MaskSource::files) ? options.file_dilation_px() : 0;
}

// Opens the drive once for each of its cameras whose masks are wanted.
inputs::Recordings open_cameras(const job::Job& job, Progress& progress) {
  inputs::bound_memory(job.memory_mb, {});
  inputs::Recordings drives{inputs::open_recording(job.target, job.read, inputs::MaskNeed::required, progress)};
  if (!job::has_other_cameras(job.read.camera)) return drives;
  drives.front().is_cleaned = true;
  job::Job without_sources = job;
  without_sources.read.source_cameras = "none";
  drives = inputs::add_other_cameras(std::move(drives), without_sources, progress);
  std::erase_if(drives, [](const inputs::Recording& open) { return !open.is_cleaned; });  // named by a warning
  return drives;
}

// The masks of a camera, and how they were found.
struct MadeMasks {
  const inputs::Recording& open;
  const objects::CameraMasks& found;
  const Trajectory& world_from_lidar;
};

// Writes the masks of a camera, and the sheet and lists in the folder `lists`. Returns masks.json.
nlohmann::json write_masks(const MadeMasks& made, const job::Job& job, const fs::path& lists, Progress& progress) {
  const auto& [open, found, world_from_lidar] = made;
  const Drive& drive = open.drive;
  const fs::path folder = labels::camera_masks(job.out, drive.camera_name);
  make_folder(folder);
  make_folder(lists);
  std::vector<double> shares(drive.frames.size());
  const Lazy<cv::Mat1b>& masks = found.images;
  parallel_for(drive.frames.size(), [&](std::size_t i) {
    const cv::Mat1b& mask = *masks[i];
    shares[i] = static_cast<double>(cv::countNonZero(mask)) / static_cast<double>(mask.total());
    media::write_png(folder / (drive.frames[i].name + ".png"), mask);
    progress.advance();
  });
  media::write_png(lists / "contact.png", make_sheet(drive, masks));
  nlohmann::json frames = nlohmann::json::array();
  for (std::size_t i = 0; i < shares.size(); ++i)
    frames.push_back({{"number", drive.frames[i].number}, {"name", drive.frames[i].name}, {"share", shares[i]}});
  nlohmann::json report{{"schema", "dvi-masks/1"},
                        {"drive", drive.path.string()},
                        {"camera", drive.camera_name},
                        {"source", inputs::mask_source(open)},
                        {"remove", to_string(job.read.remove)},
                        {"dilate_px", dilation_px(open, job.options.masks)},
                        {"tracks", tracks_json(open, *found.objects.labels, world_from_lidar)},
                        {"frames", frames}};
  write_file(lists / "masks.json", json_text(report) + "\n");
  const labels::DrawnLabels drawn = outline_masks(drive, found);
  labels::write_coco(lists / "coco.json", drawn);
  labels::write_cvat(lists / "annotations.xml", drawn);
  return report;
}

}  // namespace

std::string make_masks(const job::Job& job, Progress& progress) {
  result::require_apart(job);
  require_empty(job.out, "masks");  // existing masks may have been edited by hand
  const inputs::Recordings drives = open_cameras(job, progress);
  inputs::verify(drives, job, progress);
  const inputs::Poses poses = inputs::estimate_poses(drives, job, progress);
  const objects::Masks masks = inputs::find_masks(drives, poses, job, progress);
  const fs::path out = job.out;
  std::size_t frames = 0;
  for (const inputs::Recording& open : drives) frames += open.drive.frames.size();
  progress.begin("write", frames);
  nlohmann::json reports = nlohmann::json::array();
  for (std::size_t k = 0; k < drives.size(); ++k) {
    const fs::path lists = job::has_other_cameras(job.read.camera) ? out / drives[k].drive.camera_name : out;
    reports.push_back(write_masks({drives[k], masks[k], poses[k].world_from_lidar}, job, lists, progress));
  }
  progress.end();
  if (!job::has_other_cameras(job.read.camera)) return json_text(reports.front());
  return json_text({{"schema", "dvi-masks/1"}, {"drive", drives.front().drive.path.string()}, {"cameras", reports}});
}

}  // namespace dvi::commands
