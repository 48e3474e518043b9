#include "dvi/inputs/make_views.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "dvi/drive/posed_view.h"

namespace dvi::inputs {
namespace {

/// Returns the sequence of each view and its frame in it.
std::shared_ptr<const std::vector<std::pair<std::size_t, std::size_t>>> find_places(const Views& views) {
  auto out = std::make_shared<std::vector<std::pair<std::size_t, std::size_t>>>();
  for (const View& view : views.views) out->emplace_back(view.sequence, view.frame);
  return out;
}

// The drives' caches hold the pixels; the sequences of the views only refer to them, so that no image is kept twice.
void attach_images(Views& views, const Recordings& drives, const objects::Masks& masks_of_cameras) {
  const auto of = [places = find_places(views)](std::size_t i) { return (*places)[i]; };
  std::vector<Lazy<cv::Mat3b>> images;
  std::vector<Lazy<cv::Mat1b>> masks, unknown;
  for (const Recording& open : drives) images.push_back(open.drive.images);
  for (const objects::CameraMasks& camera : masks_of_cameras) {
    masks.push_back(camera.images);
    unknown.push_back(camera.unknown);
  }
  views.images = Lazy<cv::Mat3b>::through(views.size(), [=](std::size_t i) { return images[of(i).first][of(i).second]; });
  views.masks = Lazy<cv::Mat1b>::through(views.size(), [=](std::size_t i) { return masks[of(i).first][of(i).second]; });
  if (std::all_of(unknown.begin(), unknown.end(), [](const Lazy<cv::Mat1b>& camera) { return camera.empty(); })) return;
  views.unknown = Lazy<cv::Mat1b>::through(views.size(), [=](std::size_t i) {
    const auto [sequence, frame] = of(i);
    return unknown[sequence].empty() ? std::make_shared<const cv::Mat1b>() : unknown[sequence][frame];
  });
}

/// Returns the drive as its scans need it, without names, files, and labels, which take most of the memory of a long drive.
Drive copy_for_scans(const Drive& drive) {
  Drive out = drive;
  for (Frame& frame : out.frames) frame = {frame.number, {}, frame.time_ns, {}, {}};
  for (ScanHeader& scan : out.scan_headers) scan = {{}, scan.time_ns, scan.start_ns, scan.end_ns, {}};
  out.mask_files = {};
  return out;
}

void attach_returns(Views& views, const Inputs& inputs) {
  std::vector<Lazy<std::vector<ImageReturn>>> returns;
  for (const Recording& open : inputs.drives) {
    const auto drive = std::make_shared<const Drive>(copy_for_scans(open.drive));
    returns.emplace_back(drive->frames.size(), [drive, poses = inputs.poses[returns.size()].world_from_lidar](std::size_t i) {
      return project_returns(*drive, i, poses);
    });
  }
  const auto of = [places = find_places(views)](std::size_t i) { return (*places)[i]; };
  views.returns =
      Lazy<std::vector<ImageReturn>>::through(views.size(), [=](std::size_t i) { return returns[of(i).first][of(i).second]; });
}

/// Counts the cleaned cameras, which are the first recordings; the first recording is always one.
int count_cleaned(const Recordings& drives) {
  const auto count = std::count_if(drives.begin(), drives.end(), [](const Recording& open) { return open.is_cleaned; });
  return std::max(1, static_cast<int>(count));
}

View assign_sequence(View view, const Recordings& drives, std::size_t sequence) {
  view.sequence = static_cast<int>(sequence);
  view.gray = drives[sequence].gray;
  view.drive = static_cast<int>(drives[sequence].rig_of.value_or(sequence));
  return view;
}

}  // namespace

Views make_views(const Inputs& inputs, Progress& progress) {
  const auto& [drives, poses, masks] = inputs;
  Views out;
  out.cleaned_sequences = count_cleaned(drives);
  for (std::size_t d = 0; d < drives.size(); ++d) {
    const Drive& drive = drives[d].drive;
    for (std::size_t i = 0; i < drive.frames.size(); ++i) {
      if (const auto view = posed_view(drive, i, poses[d].world_from_lidar))
        out.views.push_back(assign_sequence(*view, drives, d));
      else
        progress.warn(fmt::format("{}: frame {} has no pose and is left out", name_of(drives[d]), drive.frames[i].name));
    }
  }
  attach_images(out, drives, masks);
  attach_returns(out, inputs);
  return out;
}

Views make_unposed_views(const Recordings& drives, const objects::Masks& masks) {
  Views out;
  out.cleaned_sequences = count_cleaned(drives);
  for (std::size_t d = 0; d < drives.size(); ++d) {
    const Drive& drive = drives[d].drive;
    for (std::size_t i = 0; i < drive.frames.size(); ++i)
      out.views.push_back(assign_sequence({0, i, drive.frames[i].time_ns, drive.camera, SE3()}, drives, d));
  }
  attach_images(out, drives, masks);
  return out;
}

Views refine_views(const Views& views, const exposure::Gains& gains, const align::Cameras& cameras) {
  Views out = views;
  for (std::size_t i = 0; i < out.size(); ++i) {
    out.views[i].gain = gains.of_view[i];
    out.views[i].vignetting = gains.vignetting[i];
    out.views[i].camera_from_world = cameras.camera_from_world[i];
  }
  return out;
}

}  // namespace dvi::inputs
