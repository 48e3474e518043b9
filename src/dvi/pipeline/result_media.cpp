#include "dvi/pipeline/result_media.h"

#include <algorithm>

#include <opencv2/core.hpp>

#include "dvi/io/contact_sheet.h"
#include "dvi/io/image_file.h"
#include "dvi/io/write_image.h"

namespace dvi::pipeline {
namespace {

constexpr std::size_t kSheetRows = 8;
constexpr int kCellWidth = 480;

}  // namespace

void write_media(const fs::path& out, const Drive& target, const std::vector<std::string>& names,
                 const io::VideoOptions& options, Progress& progress) {
  progress.begin("video", names.size());
  const cv::Size size(target.camera.width, target.camera.height);
  io::VideoWriter video(out / "video.mp4", size, options);
  io::VideoWriter compare(out / "compare.mp4", {size.width, 2 * size.height}, options);
  const std::size_t rows = std::min(kSheetRows, names.size());
  std::vector<std::vector<io::SheetCell>> sheet;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto frame =
        std::find_if(target.frames.begin(), target.frames.end(), [&](const Frame& f) { return f.name == names[i]; });
    const auto input = target.images[static_cast<std::size_t>(frame - target.frames.begin())];
    const cv::Mat3b result = io::read_image(out / "frames" / (names[i] + ".png"), size);
    video.push(result);
    cv::Mat3b both;
    cv::vconcat(*input, result, both);
    compare.push(both);
    // Rows evenly spread over the drive, the first and the last frame among them.
    if (sheet.size() < rows && i == (rows > 1 ? sheet.size() * (names.size() - 1) / (rows - 1) : 0)) {
      const cv::Mat1b mask = io::read_mask(out / "masks" / (names[i] + ".png"), size);
      sheet.push_back({{io::thumbnail(*input, kCellWidth), names[i]},
                       {io::thumbnail(io::mask_overlay(*input, mask), kCellWidth), "mask"},
                       {io::thumbnail(result, kCellWidth), "result"}});
    }
    progress.advance();
  }
  video.finish();
  compare.finish();
  io::write_png(out / "contact.png", io::contact_sheet(sheet, kCellWidth));
}

}  // namespace dvi::pipeline
