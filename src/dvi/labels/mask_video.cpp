#include "dvi/labels/mask_video.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/core/error.h"
#include "dvi/core/median.h"
#include "dvi/labels/image_labels.h"
#include "dvi/media/video_reader.h"

namespace dvi::labels {
namespace {

// Videos of odd sizes have another column or row, because many encoders require even sizes.
bool fits(cv::Size video, cv::Size image) {
  const auto side_fits = [](int of_video, int of_image) { return of_video == of_image || of_video == of_image + of_image % 2; };
  return side_fits(video.width, image.width) && side_fits(video.height, image.height);
}

cv::Mat1b read_frame(const media::VideoReader& video, std::size_t i, cv::Size size) {
  constexpr int kHalfBrightness = 128;
  cv::Mat1b gray;
  cv::cvtColor(video[i](cv::Rect({0, 0}, size)), gray, cv::COLOR_BGR2GRAY);
  cv::compare(gray, kHalfBrightness, gray, cv::CMP_GE);
  return gray;
}

// Returns the frames of a video with `count` frames per frame of the drive; nothing if their numbers do not match.
std::optional<std::vector<std::size_t>> match_video_frames(const Drive& drive, std::size_t count) {
  const std::vector<std::string> order = list_names_in_order(drive);
  std::vector<std::size_t> indices(drive.frames.size());
  if (count == drive.frames.size()) {
    for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = i;
    return indices;
  }
  if (count != order.size()) return std::nullopt;
  std::map<std::string, std::size_t> index_of;
  for (std::size_t i = 0; i < order.size(); ++i) index_of[order[i]] = i;
  for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = index_of.at(drive.frames[i].name);
  return indices;
}

std::string describe_counts(const Drive& drive) {
  const std::size_t recorded = list_names_in_order(drive).size(), selected = drive.frames.size();
  if (recorded == selected) return fmt::format("{} images", recorded);
  return fmt::format("{} images, {} of them selected", recorded, selected);
}

// Returns the median share of white pixels in a sample of the frames.
double measure_white_share(const media::VideoReader& video, cv::Size size) {
  constexpr std::size_t kMaxSampledFrames = 25;
  const std::size_t frames = video.times_ns().size(), count = std::min(frames, kMaxSampledFrames);
  std::vector<double> shares;
  for (std::size_t i = 0; i < count; ++i)
    shares.push_back(cv::countNonZero(read_frame(video, i * frames / count, size)) / static_cast<double>(size.area()));
  return median(shares);
}

using Video = std::shared_ptr<const media::VideoReader>;

void set_masks(Drive& drive, const Video& video, const std::vector<std::size_t>& indices, Polarity polarity) {
  const cv::Size size(drive.camera.width, drive.camera.height);
  drive.masks = Lazy<cv::Mat1b>(drive.frames.size(), [=](std::size_t i) {
    const cv::Mat1b white = read_frame(*video, indices[i], size);
    return polarity == Polarity::black ? cv::Mat1b(~white) : white;
  });
}

}  // namespace

void attach_mask_video(Drive& drive, const fs::path& file) {
  const Video video = std::make_shared<const media::VideoReader>(file);
  const cv::Size size(drive.camera.width, drive.camera.height);
  if (!fits(video->size(), size))
    throw InputError(
        file,
        fmt::format("is {}x{} pixels instead of {}x{}", video->size().width, video->size().height, size.width, size.height),
        "write the masks at the size of the images, without scaling or rotation");
  const auto indices = match_video_frames(drive, video->times_ns().size());
  if (!indices)
    throw InputError(file, fmt::format("has {} frames, but the drive has {}", video->times_ns().size(), describe_counts(drive)),
                     "frame n of the video must be the mask of the drive's n-th image");
  drive.mask_files.clear();
  drive.mask_video = file;
  drive.other_files.push_back(file);
  set_masks(drive, video, *indices, Polarity::white);
}

void read_mask_video(Drive& drive, const MaskReading& reading) {
  if (!reading.classes.empty())
    throw UsageError("--classes " + reading.classes + ": " + drive.mask_video.string() +
                     " is a video, whose masks are white and black only");
  const Video video = std::make_shared<const media::VideoReader>(drive.mask_video);
  Polarity polarity = reading.polarity;
  if (polarity == Polarity::automatic) {
    const double white = measure_white_share(*video, {drive.camera.width, drive.camera.height});
    polarity = decide_polarity(
        drive, PaintedShare{.share = white, .masks = video->times_ns().size(), .where = drive.mask_video.string()});
  }
  set_masks(drive, video, match_video_frames(drive, video->times_ns().size()).value(), polarity);
}

}  // namespace dvi::labels
