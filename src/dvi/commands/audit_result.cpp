#include "dvi/commands/audit_result.h"

#include <array>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/core/frame_name.h"
#include "dvi/core/json_file.h"
#include "dvi/core/json_text.h"
#include "dvi/datasets/pose_file.h"
#include "dvi/inputs/collect_evidence.h"
#include "dvi/inputs/make_views.h"
#include "dvi/inputs/rig.h"
#include "dvi/media/image_file.h"
#include "dvi/objects/completion/box_masks.h"
#include "dvi/result/fill_import.h"
#include "dvi/result/result_layout.h"
#include "dvi/result/source_masks.h"

namespace dvi::commands {
namespace {

/// An entry of sources.json.
struct ListedSource {
  std::string drive, camera, frame;

  bool is_of_sequence(const ListedSource& other) const { return drive == other.drive && camera == other.camera; }
  cv::Vec3f gain;
};

std::vector<ListedSource> read_sources(const fs::path& file) {
  const char* remedy = "dvi audit takes the output folder of dvi run";
  if (!fs::exists(file)) throw InputError(file.parent_path(), "is not a result: it has no sources.json", remedy);
  std::vector<ListedSource> sources;
  try {
    const nlohmann::json document = read_json(file);
    for (const nlohmann::json& s : document.at("sources")) {
      if (s.at("number") != sources.size()) throw InputError(file, "does not number its sources in order");
      const auto gain = s.at("exposure_gain").get<std::array<float, 3>>();
      sources.push_back({s.at("drive"), s.at("camera"), s.at("frame"), {gain[2], gain[1], gain[0]}});
    }
  } catch (const nlohmann::json::exception& e) {
    throw InputError(file, fmt::format("is not what dvi run writes: {}", e.what()));
  }
  if (sources.empty()) throw InputError(file, "lists no source", remedy);
  return sources;
}

/// Makes the views in the order of sources.json. Baselines copy from the first drive only.
Views make_listed_views(const std::vector<ListedSource>& sources, const inputs::Recordings& drives, const objects::Masks& masks,
                        const fs::path& out) {
  const Views all = inputs::make_unposed_views(drives, masks);
  std::map<std::pair<int, std::string>, std::size_t> index;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Drive& drive = drives[static_cast<std::size_t>(all[i].sequence)].drive;
    index[{all[i].sequence, drive.frames[all[i].frame].name}] = i;
  }
  Views views;
  views.cleaned_sequences = all.cleaned_sequences;
  std::vector<std::size_t> found;
  std::size_t sequence = 0;  // sources are ordered by sequence
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const ListedSource& source = sources[i];
    if (i > 0 && !source.is_of_sequence(sources[i - 1])) ++sequence;
    while (sequence < drives.size() && drives[sequence].drive.camera_name != source.camera) ++sequence;
    if (sequence >= drives.size())
      throw InputError(out, fmt::format("was made from another drive or camera, {} {}", source.drive, source.camera),
                       "give all its drives, the target first");
    const auto it = index.find({static_cast<int>(sequence), source.frame});
    if (it == index.end())
      throw InputError(drives[sequence].drive.path, "has no frame " + source.frame + ", which the result copies from",
                       "give the drives that the result was made from");
    found.push_back(it->second);
    views.views.push_back(all[it->second]);
  }
  views.images = Lazy<cv::Mat3b>::through(found.size(), [all, found](std::size_t i) { return all.images[found[i]]; });
  views.masks = Lazy<cv::Mat1b>::through(found.size(), [all, found](std::size_t i) { return all.masks[found[i]]; });
  return views;
}

/// Returns the poses that the run used to separate static from moving objects. A baseline uses the given poses only.
inputs::Poses read_run_poses(const fs::path& out, const inputs::Recordings& drives, const job::Job& job) {
  inputs::Poses poses = inputs::use_given_poses(drives);
  const fs::path file = out / "map/poses.txt";
  if (job.read.remove == job::Remove::moving && fs::exists(file))
    poses.front().world_from_lidar = datasets::read_poses(file, drives.front().drive);
  return poses;
}

cv::Mat1b read_result_mask(const fs::path& file, const Camera& camera) {
  if (!fs::exists(file))
    throw InputError(file, "is missing: it is the mask of a source frame", "run again into another folder");
  return media::read_mask(file, {camera.width, camera.height});
}

/// The relation of the masks of a run to the given masks. given: the run uses them for the target's own frames. extended: it
/// removes more. refined: it removes more, and less where they cover background.
enum class RunMasks { given, extended, refined };

RunMasks relate_masks(const objects::GivenMasks& given) {
  return given.complete ? RunMasks::given : given.refined ? RunMasks::refined : RunMasks::extended;
}

// Returns a mask without its bounding boxes, of which a run removes only the objects in them.
cv::Mat1b remove_boxes(const cv::Mat1b& mask) {
  cv::Mat1b out = mask.clone();
  for (const objects::BoxPart& part : objects::find_box_parts(mask)) out(part.area).setTo(0, part.mask);
  return out;
}

/// Returns all masks of the run, from which no pixel may be copied: the masks of the drives together with shadows and with
/// masks that were completed, detected, found in scans, or reprojected.
Lazy<cv::Mat1b> collect_run_masks(const Views& views, const std::vector<std::string>& names, RunMasks relation,
                                  const fs::path& out) {
  return {views.size(), [views, names, relation, out](std::size_t i) {
            const bool own = i < names.size();
            if (own && relation == RunMasks::given) return views.masks[i]->clone();
            const std::string file = own ? picture_file("masks", names[i]) : result::source_mask_file(i);
            const cv::Mat1b of_run = read_result_mask(out / file, views[i].camera);
            return cv::Mat1b(of_run | (relation == RunMasks::refined ? remove_boxes(*views.masks[i]) : *views.masks[i]));
          }};
}

audit::ImportedFrames find_imported_frames(const fs::path& out, const std::vector<std::string>& names) {
  audit::ImportedFrames imported{{}, out / result::file_before_import("")};
  for (const std::string& name : names)
    if (result::read_external_file(out, name)) imported.names.insert(name);
  return imported;
}

nlohmann::json json_of(const audit::Audit& audit, const fs::path& out) {
  nlohmann::json findings = nlohmann::json::object();
  for (std::size_t b = 0; b < audit::kBreaches.size(); ++b) {
    const audit::Finding& f = audit.findings[b];
    findings[audit::kBreaches[b]] = {{"pixels", f.pixels}};
    if (f.pixels > 0) findings[audit::kBreaches[b]]["first"] = {{"frame", f.frame}, {"x", f.x}, {"y", f.y}};
  }
  return {{"schema", "dvi-audit/1"},
          {"path", out.string()},
          {"passed", audit.passed()},
          {"frames", audit.frames},
          {"removed_pixels", audit.removed},
          {"copied_pixels", audit.copied},
          {"imported_pixels", audit.imported},
          {"harmonization", {{"median", audit.change_median}, {"p95", audit.change_p95}}},
          {"findings", findings}};
}

std::string text_of(const audit::Audit& audit, const fs::path& out) {
  static const std::array<const char*, audit::kBreaches.size()> kDescriptions{
      "mask: the result's mask differs from the objects to remove in the drive",
      "outside: outside of the mask, the result differs from the drive's image",
      "provenance: kind and provenance contradict each other, or refer to a missing source",
      "masked source: pixels are copied from inside a mask",
      "color: source and recorded harmonization do not reproduce the color of the result",
      "imported: an import changed a pixel that the run had observed, or has no record of its file"};
  std::string text = fmt::format(
      "{}\n  frames   {}\n  removed  {} pixels, {} of them copied: each was compared with its source\n"
      "  harmonization changed the copies by {:.1f} gray levels in the median, {:.1f} at the 95th percentile\n",
      out.string(), audit.frames, audit.removed, audit.copied, audit.change_median, audit.change_p95);
  if (audit.imported > 0) text += fmt::format("  imported {} unobserved pixels from another program\n", audit.imported);
  for (std::size_t b = 0; b < audit::kBreaches.size(); ++b) {
    const audit::Finding& f = audit.findings[b];
    if (f.pixels > 0)
      text +=
          fmt::format("  {}\n    {} pixels, the first in frame {} at {}, {}\n", kDescriptions[b], f.pixels, f.frame, f.x, f.y);
  }
  return text + (audit.passed() ? "  passed: no pixel comes from a mask, every copy can be reproduced" : "  FAILED");
}

}  // namespace

AuditReport audit_result(const fs::path& out, const std::vector<std::string>& drives, const std::string& masks,
                         Progress& progress) {
  const std::vector<ListedSource> sources = read_sources(out / "sources.json");
  job::Job job;
  job.table().load_toml(out / "dvi.toml");
  if (job.sources.size() + 1 != drives.size())
    throw InputError(out, fmt::format("was made from {} drive(s), not {}", job.sources.size() + 1, drives.size()),
                     "give the same drives, the target first");
  job.target = drives.front();
  job.sources.assign(drives.begin() + 1, drives.end());
  if (!masks.empty()) job.read.masks = {job::MasksFrom::parse(masks)};
  const bool detected = !job.read.detector.empty() && masks.empty();
  job.read.detector.clear();  // the detected masks are in the result
  inputs::Recordings open =
      inputs::open_recordings(job, detected ? inputs::MaskNeed::optional : inputs::MaskNeed::required, progress);
  if (!job::is_baseline(job.method)) open = inputs::add_other_cameras(std::move(open), job, progress);
  if (detected)
    for (inputs::Recording& recording : open) recording.masks_from.insert(MaskSource::detected);
  const inputs::Poses poses = read_run_poses(out, open, job);
  const objects::GivenMasks given = objects::draw_given_masks(inputs::collect_evidence(open, poses), job.removal());
  Views views = make_listed_views(sources, open, given.masks, out);
  for (std::size_t i = 0; i < sources.size(); ++i) views.views[i].gain = sources[i].gain;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < views.targets(); ++i)
    names.push_back(join_frame_name(views.cleaned_sequences > 1 ? sources[i].camera : "", sources[i].frame));
  views.masks = collect_run_masks(views, names, relate_masks(given), out);

  progress.begin("audit", names.size());
  AuditReport report{audit::audit_result({out, names, find_imported_frames(out, names)}, views, progress.tick()), {}, {}};
  progress.end();
  report.json = json_text(json_of(report.audit, out));
  report.text = text_of(report.audit, out);
  return report;
}

}  // namespace dvi::commands
