#include "dvi/commands/convert.h"

#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/datasets/write_folder.h"

namespace dvi::commands {
namespace {

constexpr std::int64_t kMaxCameraGapNs = 20'000'000;  // between images of two cameras that belong together

void report_warnings(const Drive& drive, Progress& progress) {
  for (const std::string& warning : drive.warnings) progress.warn(drive.camera_name + ": " + warning);
}

std::vector<Drive> read_other_cameras(const Drive& drive, datasets::ReadOptions read, Progress& progress) {
  std::vector<Drive> out;
  read.frames.reset();
  read.span = TimeSpan{drive.frames.front().time_ns - kMaxCameraGapNs, drive.frames.back().time_ns + kMaxCameraGapNs};
  for (const std::string& camera : drive.camera_names) {
    if (camera == drive.camera_name) continue;
    read.camera = camera;
    try {
      out.push_back(datasets::read_drive(drive.path, read));
    } catch (const InputError& e) {
      progress.warn(fmt::format("camera {} is left out: {}", camera, e.what()));
    }
  }
  return out;
}

}  // namespace

ConvertReport convert(const ConvertSource& source, const fs::path& out, Progress& progress) {
  require_empty(out, "drive");
  const Drive drive = datasets::read_drive(source.recording, source.read);
  report_warnings(drive, progress);
  const std::vector<Drive> others =
      source.all_cameras ? read_other_cameras(drive, source.read, progress) : std::vector<Drive>();
  ConvertReport report{.format = drive.format,
                       .cameras = {drive.camera_name},
                       .images = drive.frames.size(),
                       .scans = drive.scan_headers.size(),
                       .first_frame = drive.frames.front().number,
                       .last_frame = drive.frames.back().number};
  for (const Drive& camera : others) report.cameras.push_back(camera.camera_name), report.images += camera.frames.size();
  progress.begin("convert", report.images + report.scans);
  datasets::write_folder(out, drive, others, progress.tick());
  progress.end();
  return report;
}

}  // namespace dvi::commands
