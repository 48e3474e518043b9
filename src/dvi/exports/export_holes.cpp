#include <array>
#include <atomic>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/core/frame_name.h"
#include "dvi/core/json_text.h"
#include "dvi/core/threads.h"
#include "dvi/exports/exporter.h"
#include "dvi/exports/scene_files.h"
#include "dvi/geometry/camera_json.h"
#include "dvi/image/region.h"
#include "dvi/media/write_image.h"

namespace dvi::exports {
namespace {

// Returns the pose and the intrinsics of a frame. The pixel centers are at whole numbers, as in sources.json.
nlohmann::json make_camera(const Result& result, const ResultFrame& frame) {
  const auto& [name, c] = result.cameras()[frame.camera];
  const SE3& pose = frame.world_from_camera;
  nlohmann::json rows = nlohmann::json::array();
  for (int r = 0; r < 3; ++r) rows.push_back({pose.R(r, 0), pose.R(r, 1), pose.R(r, 2), pose.t[r]});
  rows.push_back({0, 0, 0, 1});
  nlohmann::json out = to_json(c);
  out["camera"] = name;
  out["time_s"] = static_cast<double>(frame.time_ns) / 1e9;
  out["world_from_camera"] = rows;
  return out;
}

ExportReport write_holes(const Result& result, const fs::path& folder, const ExportOptions& options, Progress& progress) {
  const bool has_one = result.cameras().size() == 1, in_pairs = options.layout == HoleLayout::pairs;
  const char* const frames_folder = in_pairs ? "pairs" : "frames";
  const char* const masks_folder = in_pairs ? "pairs" : "masks";
  const char* const mask_ending = in_pairs ? "_mask.png" : ".png";
  const auto find_file = [&](const ResultFrame& frame, const std::string& kind, const std::string& ending) {
    return (folder / picture_file(kind, frame.name)).replace_extension().concat(ending);  // kind/NAME, or CAMERA/kind/NAME
  };
  for (const ResultCamera& camera : result.cameras())
    for (const char* name : {frames_folder, masks_folder, "depth", "cameras"})
      make_folder(folder / join_frame_name(has_one ? "" : camera.name, name));
  std::atomic<std::size_t> frames = 0, pixels = 0;
  parallel_for(result.frames().size(), [&](std::size_t i) {
    const ResultFrame& frame = result.frames()[i];
    const cv::Mat1b unobserved(~result.evidence(i));
    const auto count = static_cast<std::size_t>(cv::countNonZero(unobserved));
    pixels += count;
    frames += count > 0 ? 1 : 0;
    const cv::Mat1b mask = grown(unobserved, options.grow_px);
    // Programs that fill pairs work on each image alone and need no frames without holes; programs for videos need all frames.
    if (!in_pairs || cv::countNonZero(mask) > 0) {
      copy_picture(result.picture("frames", i), find_file(frame, frames_folder, ".png"));
      media::write_png(find_file(frame, masks_folder, mask_ending), mask);
    }
    copy_picture(result.picture("depth", i), find_file(frame, "depth", ".png"));
    write_file(find_file(frame, "cameras", ".json"), json_text(make_camera(result, frame)) + "\n");
    progress.advance();
  });
  if (pixels == 0)
    throw InputError(result.folder(), "has no unobserved pixels", "there is nothing that another program could fill");
  const auto all = static_cast<double>(result.frames().size());
  std::vector<std::string> files{"frames", "masks"};
  if (in_pairs) files = {"pairs"};
  if (!has_one)
    for (std::string& file : files) file = "CAMERA/" + file;
  return {files,
          {{"frames", all}, {"frames with holes", static_cast<double>(frames)}, {"pixels", static_cast<double>(pixels)}}};
}

}  // namespace

ExportFormat holes_format() {
  return {"holes",
          "the result and masks of unobserved pixels, for an inpainting program (ProPainter, LaMa, IOPaint, ComfyUI); "
          "dvi import-fill reads its frames",
          write_holes,
          {},
          {"export.grow_px", "export.layout"}};
}

}  // namespace dvi::exports
