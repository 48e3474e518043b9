#include "dvi/pipeline/result_media.h"

#include <algorithm>
#include <unordered_map>

#include <opencv2/core.hpp>

#include "dvi/core/threads.h"
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
  io::VideoWriter compare(out / "compare.mp4", {size.width, 2 * (size.height + size.height % 2)}, options);
  const std::size_t rows = std::min(kSheetRows, names.size());
  std::vector<std::vector<io::SheetCell>> sheet;
  std::unordered_map<std::string, std::size_t> number;  // of a frame, by its name
  for (std::size_t i = 0; i < target.frames.size(); ++i) number[target.frames[i].name] = i;
  const auto add_to_sheet = [&](std::size_t i, const cv::Mat3b& input, const cv::Mat3b& result) {
    const cv::Mat1b mask = io::read_mask(out / "masks" / (names[i] + ".png"), size);
    sheet.push_back({{io::thumbnail(input, kCellWidth), names[i]},
                     {io::thumbnail(io::mask_overlay(input, mask), kCellWidth), "mask"},
                     {io::thumbnail(result, kCellWidth), "result"}});
  };
  for_blocks(names.size(), [&](std::size_t first, std::size_t last) {
    std::vector<cv::Mat3b> inputs(last - first), results(last - first);
    parallel_for(last - first, [&](std::size_t i) {
      inputs[i] = *target.images[number.at(names[first + i])];
      results[i] = io::read_image(out / "frames" / (names[first + i] + ".png"), size);
    });
    parallel_for(2, [&](std::size_t which) {
      for (std::size_t i = 0; i < results.size(); ++i)
        which == 0 ? compare.push_stacked({inputs[i], results[i]}) : video.push(results[i]);
    });
    for (std::size_t i = 0; i < results.size(); ++i) {
      // Rows evenly spread over the drive, the first and the last frame among them.
      if (sheet.size() < rows && first + i == (rows > 1 ? sheet.size() * (names.size() - 1) / (rows - 1) : 0))
        add_to_sheet(first + i, inputs[i], results[i]);
      progress.advance();
    }
  });
  video.finish();
  compare.finish();
  io::write_png(out / "contact.png", io::contact_sheet(sheet, kCellWidth));
}

}  // namespace dvi::pipeline
