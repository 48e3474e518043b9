#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/core/threads.h"
#include "dvi/datasets/reader.h"
#include "dvi/exports/exporter.h"
#include "dvi/media/image_file.h"

namespace dvi::exports {
namespace {

cv::Mat3b picture(const Result& result, std::size_t frame, bool beside) {
  const cv::Mat3b clean = result.image(frame);
  if (!beside) return clean;
  const fs::path& input = result.frames()[frame].input;
  if (datasets::holds_many_images(input))
    throw InputError(input, "has no image files to show beside the result", "use compare.mp4 of the result, which shows both");
  cv::Mat3b both;
  cv::hconcat(media::read_image(input, result.size(frame)), clean, both);
  return both;
}

ExportReport write_video(const Result& result, const fs::path& folder, const ExportOptions& options, Progress& progress) {
  const Camera& camera = result.only_camera().camera;
  media::VideoWriter video(folder / "video.mp4", {camera.width * (options.beside ? 2 : 1), camera.height}, options.video);
  make_and_use(
      result.frames().size(), [&](std::size_t i) { return picture(result, i, options.beside); },
      [&](std::size_t, const cv::Mat3b& frame) {
        video.push(frame);
        progress.advance();
      });
  video.finish();
  return {{"video.mp4"}, {{"frames", static_cast<double>(result.frames().size())}}};
}

}  // namespace

ExportFormat video_format() {
  return {"video", "an mp4 of the result with selectable rate and quality, optionally beside the input", write_video};
}

}  // namespace dvi::exports
