#include <utility>

#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/core/threads.h"
#include "dvi/datasets/reader.h"
#include "dvi/exports/exporter.h"
#include "dvi/media/image_file.h"

namespace dvi::exports {
namespace {

constexpr std::size_t kPictureBytesPerPixel = 6;  // the frame and its parts

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

// The video of a camera: `count` frames of the result from `first` on.
struct CameraVideo {
  std::size_t first = 0, count = 0;
  fs::path file;
};

void write_video(const Result& result, const CameraVideo& of, const ExportOptions& options, Progress& progress) {
  const cv::Size size = result.size(of.first);
  const cv::Size video_size(size.width * (options.beside ? 2 : 1), size.height);
  const media::VideoTarget target{of.file, video_size, options.video};
  media::VideoWriter video(target);
  const std::vector<media::FrameSpan> segments = media::divide_into_segments(of.count);
  make_and_use(
      segments.size(),
      [&](std::size_t k) {
        media::SegmentEncoder segment(target);
        for (std::size_t i = segments[k].first; i < segments[k].last; ++i) {
          segment.push(picture(result, of.first + i, options.beside));
          progress.advance();
        }
        return segment.finish();
      },
      [&](std::size_t, const media::VideoSegment& segment) { video.append(segment); },
      static_cast<std::size_t>(video_size.area()) * (media::kEncoderBytesPerPixel + kPictureBytesPerPixel));
  video.finish();
}

ExportReport write_videos(const Result& result, const fs::path& folder, const ExportOptions& options, Progress& progress) {
  ExportReport report;
  std::size_t first = 0;
  for (std::size_t k = 0; k < result.cameras().size(); ++k) {
    const std::size_t count = result.count_frames(k);
    const fs::path file = join_frame_name(result.cameras().size() > 1 ? result.cameras()[k].name : "", "video.mp4");
    make_folder((folder / file).parent_path());
    write_video(result, {first, count, folder / file}, options, progress);
    report.files.push_back(file);
    first += count;
  }
  report.counts = {{"frames", static_cast<double>(first)}};
  return report;
}

}  // namespace

ExportFormat video_format() {
  return {"video",
          "an mp4 of the result with selectable rate and quality, optionally beside the input",
          write_videos,
          {},
          {"export.beside", "video.fps", "video.crf", "video.encoder"}};
}

}  // namespace dvi::exports
