#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/core/draft.h"
#include "dvi/core/error.h"
#include "dvi/core/json_text.h"
#include "dvi/core/threads.h"
#include "dvi/core/version.h"
#include "dvi/datasets/write_folder.h"
#include "dvi/geometry/rigid.h"
#include "dvi/holdout/holdout.h"
#include "dvi/media/write_image.h"

namespace dvi::holdout {
namespace {

nlohmann::json to_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// Numbers of pixels of one frame.
struct PixelCounts {
  int held_out = 0, scored = 0;
  int masked = 0;  // scored pixels that the mask in the drive covers
};

PixelCounts count_pixels(const HoldoutFrame& frame) {
  const cv::Mat1b scored(frame.held_out & ~frame.ignore);
  return {cv::countNonZero(frame.held_out), cv::countNonZero(scored), cv::countNonZero(cv::Mat1b(scored & frame.mask))};
}

nlohmann::json describe(const Holdout& holdout, const std::string& recipe, const std::vector<PixelCounts>& pixels) {
  const Drive& drive = holdout.drive();
  nlohmann::json frames = nlohmann::json::array();
  for (std::size_t i = 0; i < drive.frames.size(); ++i) {
    nlohmann::json frame = {{"name", drive.frames[i].name},
                            {"visible", static_cast<bool>(holdout.visible()[i])},
                            {"held_out_pixels", pixels[i].held_out},
                            {"scored_pixels", pixels[i].scored},
                            {"masked_pixels", pixels[i].masked}};
    if (holdout.vehicle())
      frame["world_from_box"] = to_row_major(holdout.vehicle()->box_at(drive.frames[i].time_ns).frame_from_box);
    frames.push_back(std::move(frame));
  }
  nlohmann::json json = {{"schema", "dvi-holdout/1"},
                         {"version", kVersion},
                         {"scenario", name(holdout.options().scenario)},
                         {"seed", holdout.options().seed},
                         {"mask_errors", to_string(holdout.options().mask_errors)},
                         {"margin_px", holdout.options().margin_px},
                         {"ignore_margin_px", holdout.options().ignore_margin_px},
                         {"source", {{"drive", drive.path.string()}, {"camera", drive.camera_name}}},
                         {"recipe", recipe},
                         {"frames", frames}};
  if (holdout.vehicle())
    json["vehicle"] = {{"class", holdout.vehicle()->type()},
                       {"size", to_json(holdout.vehicle()->size())},
                       {"sensor_height", holdout.sensor_height()}};
  if (holdout.is_labeled()) json["vehicle"]["track"] = holdout.track();
  if (holdout.vehicle() && holdout.vehicle()->avoidance())
    json["vehicle"]["stand"] = {{"moved", holdout.vehicle()->avoidance()->moved_m},
                                {"returns", holdout.vehicle()->avoidance()->returns}};
  return json;
}

void make_camera_folders(const fs::path& folder, const Drive& camera) {
  for (const char* kind : {"images", "masks"}) make_folder(folder / kind / camera.camera_name);
}

void write_pictures(const fs::path& folder, const Drive& camera, std::size_t i, const HoldoutFrame& frame) {
  const std::string png = camera.frames[i].name + ".png";
  media::write_png(folder / "images" / camera.camera_name / png, frame.image);
  media::write_png(folder / "masks" / camera.camera_name / png, frame.mask);
}

}  // namespace

std::string read_holdout_recipe(const fs::path& folder) {
  if (!fs::exists(folder / "holdout.json")) return {};
  try {
    return nlohmann::json::parse(read_file(folder / "holdout.json")).at("recipe").get<std::string>();
  } catch (const nlohmann::json::exception&) {
    throw InputError(folder / "holdout.json", "was not written by dvi holdout", "remove the folder or give another one");
  }
}

void write_holdout(const Holdout& holdout, const fs::path& case_folder, const std::string& recipe, const Tick& tick) {
  require_empty(case_folder, "case");
  Draft draft = draft_folder(case_folder);
  const fs::path& out = draft.path();
  const fs::path folder = out / "drive";
  const Drive& drive = holdout.drive();
  for (const fs::path& part : {folder / "lidar", folder / "times", out / "truth", out / "truth_masks", out / "ignore"})
    make_folder(part);
  std::vector<PixelCounts> pixels(drive.frames.size());
  make_camera_folders(folder, drive);
  parallel_for(drive.frames.size(), [&](std::size_t i) {
    const HoldoutFrame frame = holdout.frame(i);
    const std::string png = drive.frames[i].name + ".png";
    write_pictures(folder, drive, i, frame);
    media::write_png(out / "truth" / png, holdout.truth(i));
    media::write_png(out / "truth_masks" / png, frame.held_out);
    media::write_png(out / "ignore" / png, frame.ignore);
    pixels[i] = count_pixels(frame);
    if (tick) tick();
  });
  for (std::size_t k = 0; k < holdout.more_cameras().size(); ++k) {
    const Drive& other = holdout.more_cameras()[k];
    make_camera_folders(folder, other);
    parallel_for(other.frames.size(), [&](std::size_t i) {
      write_pictures(folder, other, i, holdout.camera_frame(k, i));
      if (tick) tick();
    });
  }
  parallel_for(drive.scan_headers.size(), [&](std::size_t i) {
    datasets::write_folder_scan(folder, drive.scan_headers[i], holdout.scan(i));
    if (tick) tick();
  });
  datasets::write_folder_tables(folder, drive, holdout.more_cameras());
  write_file(out / "holdout.json", json_text(describe(holdout, recipe, pixels)) + "\n");
  draft.finish();
}

}  // namespace dvi::holdout
