#include "dvi/pipeline/make_masks.h"

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/core/json_text.h"
#include "dvi/core/threads.h"
#include "dvi/io/contact_sheet.h"
#include "dvi/io/write_image.h"

namespace dvi::pipeline {
namespace {

constexpr std::size_t kSheetRows = 12, kSheetColumns = 2;

cv::Mat3b sheet(const Drive& drive, const Lazy<cv::Mat1b>& masks) {
  const std::size_t count = std::min(drive.frames.size(), kSheetRows * kSheetColumns);
  std::vector<io::SheetCell> cells(count);
  parallel_for(count, [&](std::size_t k) {
    const std::size_t i = count < 2 ? 0 : k * (drive.frames.size() - 1) / (count - 1);
    cells[k] = {io::thumbnail(io::mask_overlay(*drive.images[i], *masks[i]), 640), drive.frames[i].name};
  });
  std::vector<std::vector<io::SheetCell>> rows;
  for (std::size_t k = 0; k < count; k += kSheetColumns)
    rows.emplace_back(cells.begin() + static_cast<std::ptrdiff_t>(k),
                      cells.begin() + static_cast<std::ptrdiff_t>(std::min(count, k + kSheetColumns)));
  return io::contact_sheet(rows, 640);
}

}  // namespace

std::string make_masks(const Job& job, Progress& progress) {
  const Recordings drives{open_recording(job.target, job.read, MaskNeed::required, progress)};
  verify(drives, job, progress);
  const Poses poses = estimate_poses(drives, job, progress);
  const Masks masks = find_masks(drives, poses, job, progress);
  const Drive& drive = drives.front().drive;
  const fs::path out = job.out, folder = out / "masks" / drive.camera_name;
  fs::create_directories(folder);
  nlohmann::json frames = nlohmann::json::array();
  for (const Frame& frame : drive.frames) frames.push_back({{"number", frame.number}, {"name", frame.name}});
  progress.begin("write", drive.frames.size());
  parallel_for(drive.frames.size(), [&](std::size_t i) {
    io::write_png(folder / (drive.frames[i].name + ".png"), *masks.front().images[i]);
    progress.advance();
  });
  io::write_png(out / "contact.png", sheet(drive, masks.front().images));
  nlohmann::json report{{"schema", "dvi-masks/1"}, {"camera", drive.camera_name}, {"frames", frames}};
  const std::string text = json_text(report);
  write_file(out / "masks.json", text + "\n");
  progress.end();
  return text;
}

}  // namespace dvi::pipeline
