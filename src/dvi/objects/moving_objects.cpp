#include "dvi/objects/moving_objects.h"

#include <set>
#include <utility>

#include <fmt/format.h>

#include "dvi/core/text.h"
#include "dvi/drive/nearest_in_time.h"
#include "dvi/objects/draw_masks.h"
#include "dvi/objects/image_masks.h"
#include "dvi/objects/merge_labels.h"
#include "dvi/objects/motion_segmentation.h"
#include "dvi/objects/upper_edges.h"

namespace dvi::objects {
namespace {

void warn_of_untrusted(const CameraEvidence& evidence, const std::vector<std::size_t>& contradictory_scans,
                       Progress& progress) {
  const Drive& drive = evidence.drive;
  const auto warn = [&](const std::vector<std::size_t>& scans, const char* reason) {
    if (scans.empty()) return;
    std::set<int> frames;
    for (const std::size_t scan : scans)
      if (const Frame* frame = nearest_in_time(drive.frames, drive.scan_headers[scan].time_ns, kMaxFrameToScanNs))
        frames.insert(frame->number);
    progress.warn(fmt::format("{}: {} of {} scans {}, so moving objects are not searched in them (frames {})", evidence.name,
                              scans.size(), drive.scan_headers.size(), reason,
                              frames.empty() ? "none" : format_ranges({frames.begin(), frames.end()})));
  };
  std::vector<std::size_t> known;
  for (std::size_t i = 0; i < evidence.untrusted_scans.size(); ++i)
    if (evidence.untrusted_scans[i]) known.push_back(i);
  warn(known, "have poses known to be wrong");
  warn(contradictory_scans, "contradict the other scans at many positions, which indicates wrong poses");
}

}  // namespace

const DriveMotion& MovingObjects::of_drive(std::size_t camera) {
  const auto [entry, is_new] = drives_.try_emplace(camera);
  if (is_new) entry->second = find(camera);
  return entry->second;
}

FrameLabels MovingObjects::draw_outlines_in(std::size_t camera) {
  const CameraEvidence& evidence = evidence_[camera];
  return draw_outlines(*of_drive(evidence_.own_camera(camera)).tracks, evidence.drive, evidence.world_from_lidar,
                       options_.masks.footprint_margin_m);
}

FrameLabels MovingObjects::find_in(std::size_t index) {
  const CameraEvidence camera = evidence_[index].restricted_to({MaskSource::found});
  const std::vector<Track>& tracks = *of_drive(evidence_.own_camera(index)).tracks;
  if (tracks.empty() && !camera.rig_of)
    progress_.warn(camera.name + ": its scans show no moving objects" +
                   (evidence_[index].sources.size() == 1 ? ", so nothing is removed" : ""));
  FrameLabels labels = draw_outlines_in(index);
  set_source(labels, MaskSource::found);
  if (!evidence_.ground(index)) return labels;
  const SharedLabels outlines = shared(std::move(labels));
  labels = extend_in_images({evidence_, index}, draw_plain_masks(camera, outlines, options_), outlines, tracks);
  set_source(labels, MaskSource::found);
  return labels;
}

DriveMotion MovingObjects::find(std::size_t camera) {
  const CameraEvidence& evidence = evidence_[camera];
  DriveMotion out{evidence_.ground(camera), nullptr, share_tracks(std::vector<Track>())};
  if (!out.ground) return out;
  out.returns = std::make_shared<MovingReturns>(
      evidence.drive, ScanPoses{evidence.world_from_lidar, options_.pose_error_m, evidence.untrusted_scans}, *out.ground);
  progress_.begin("traffic", evidence.drive.scan_headers.size());
  MotionSegmentation segmentation = segment_motion(*out.returns, progress_.tick());
  progress_.end();
  warn_of_untrusted(evidence, segmentation.contradictory_scans, progress_);
  find_upper_edges(evidence, *out.returns, segmentation.tracks);
  out.tracks = share_tracks(std::move(segmentation.tracks));
  return out;
}

}  // namespace dvi::objects
