#include "dvi/result/result_media.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "dvi/core/frame_name.h"
#include "dvi/core/threads.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/media/contact_sheet.h"
#include "dvi/media/image_file.h"
#include "dvi/media/write_image.h"
#include "dvi/report/kind_colors.h"
#include "dvi/result/segment_store.h"

namespace dvi::result {
namespace {

constexpr std::size_t kSheetRows = 8;
constexpr int kCellWidthPx = 480;
constexpr std::size_t kVideoBytesPerPixel = 3 * media::kEncoderBytesPerPixel + 20;  // both videos and a frame

/// Returns "NAME  copied 22 %  interpolated 78 %".
std::string caption_of(const cv::Mat1b& kind, const std::string& name) {
  std::array<std::size_t, report::kKindColors.size()> count{};
  for (const uchar k : kind) ++count[std::min<std::size_t>(k, count.size() - 1)];
  const std::size_t hole = kind.total() - count[0];
  std::string text = name;
  for (std::size_t k = 1; k < count.size(); ++k)
    if (count[k] > 0)
      text += fmt::format("  {} {:.0f} %", report::kKindColors[k].name,
                          100 * static_cast<double>(count[k]) / static_cast<double>(hole));
  return hole > 0 ? text : text + "  nothing removed";
}

std::string explain_colors(const cv::Mat1b& kind) {
  const bool has_imported = cv::countNonZero(kind == static_cast<int>(harmonize::Kind::imported)) > 0;
  return std::string("blue: copied, orange: interpolated, pink: synthesized") + (has_imported ? ", green: imported" : "");
}

/// Draws the outline of the hole, the frame's name, and the shares on the input.
cv::Mat3b mark_input(const cv::Mat3b& input, const cv::Mat1b& kind, const std::string& name) {
  cv::Mat3b out = input.clone();
  media::draw_outline(out, cv::Mat1b(kind != 0));
  media::write_caption(out, caption_of(kind, name));
  return out;
}

/// The images of a finished frame.
struct FrameImages {
  cv::Mat3b input, result;
  cv::Mat1b kind;
};

/// Makes a row of the contact sheet: the whole frame, then the part with most removed pixels in full size.
std::vector<media::SheetCell> make_sheet_row(const FrameImages& images, const std::string& name) {
  const auto& [input, result, kind] = images;
  std::vector<cv::Vec3b> colors;
  for (const report::KindColor& k : report::kKindColors) colors.push_back(k.color);
  const cv::Mat1b mask(kind != 0);
  const cv::Mat3b whole = media::make_thumbnail(media::draw_mask_overlay(input, mask), kCellWidthPx);
  const double closer = std::min(1.0, 0.4 * input.cols / kCellWidthPx);  // one pixel of the image is at least one of the sheet
  const cv::Rect part =
      media::find_densest_part(mask, {std::max(1, cvRound(closer * whole.cols)), std::max(1, cvRound(closer * whole.rows))});
  return {{whole, caption_of(kind, name)},
          {media::make_thumbnail(result, kCellWidthPx), "result"},
          {input(part).clone(), "before, closer"},
          {result(part).clone(), "after"},
          {media::draw_label_overlay(result(part), kind(part), colors), explain_colors(kind(part))}};
}

fs::path folder_of(const FinishedFrames& frames) { return frames.out / camera_of_frame(frames.names.front()); }

media::VideoTarget video_of(const FinishedFrames& frames) {
  return {folder_of(frames) / "video.mp4", frames.size, frames.options};
}

media::VideoTarget compare_video_of(const FinishedFrames& frames) {
  const cv::Size size = frames.size;
  return {folder_of(frames) / "compare.mp4", {size.width, 2 * (size.height + size.height % 2)}, frames.options};
}

std::span<const std::string> names_of(const FinishedFrames& frames, const media::FrameSpan& segment) {
  return std::span(frames.names).subspan(segment.first, segment.last - segment.first);
}

FrameImages read_images(const FinishedFrames& frames, std::size_t i) {
  return {frames.read_input(i), media::read_image(frames.out / picture_file("frames", frames.names[i]), frames.size),
          media::read_png_gray(frames.out / picture_file("kind", frames.names[i]), frames.size)};
}

MediaSegment encode_segment(const FinishedFrames& frames, const media::FrameSpan& segment, const Tick& tick) {
  media::SegmentEncoder video(video_of(frames)), compare(compare_video_of(frames));
  for (std::size_t i = segment.first; i < segment.last; ++i) {
    const FrameImages images = read_images(frames, i);
    video.push(images.result);
    compare.push_stacked({mark_input(images.input, images.kind, frames.names[i]), images.result});
    tick();
  }
  return {video.finish(), compare.finish()};
}

std::size_t bytes_per_segment(const FinishedFrames& frames) {
  return kVideoBytesPerPixel * static_cast<std::size_t>(frames.size.area());
}

void write_videos(const FinishedFrames& frames, const Tick& tick) {
  const SegmentStore store(frames.out);
  const std::vector<media::FrameSpan> segments = media::divide_into_segments(frames.names.size());
  media::VideoWriter video(video_of(frames)), compare(compare_video_of(frames));
  const auto make = [&](std::size_t k) {
    std::optional<MediaSegment> stored = store.read(names_of(frames, segments[k]));
    if (!stored) return encode_segment(frames, segments[k], tick);
    for (std::size_t i = segments[k].first; i < segments[k].last; ++i) tick();
    return *std::move(stored);
  };
  const auto append = [&](std::size_t, const MediaSegment& segment) {
    video.append(segment.result);
    compare.append(segment.compare);
  };
  make_and_use(segments.size(), make, append, bytes_per_segment(frames));
  video.finish();
  compare.finish();
}

/// Writes rows of frames that are evenly spread over the drive, the first and the last among them.
void write_contact_sheet(const FinishedFrames& frames) {
  std::vector<std::vector<media::SheetCell>> rows(std::min(kSheetRows, frames.names.size()));
  parallel_for(rows.size(), [&](std::size_t row) {
    const std::size_t i = rows.size() > 1 ? row * (frames.names.size() - 1) / (rows.size() - 1) : 0;
    rows[row] = make_sheet_row(read_images(frames, i), frames.names[i]);
  });
  media::write_png(folder_of(frames) / "contact.png", media::make_contact_sheet(rows, kCellWidthPx));
}

}  // namespace

void write_media(const FinishedFrames& frames, const Tick& tick) {
  write_videos(frames, tick);
  write_contact_sheet(frames);
}

void store_segments(const FinishedFrames& frames, const std::set<std::string>& filled, const Tick& tick) {
  const SegmentStore store(frames.out);
  std::vector<media::FrameSpan> missing = media::divide_into_segments(frames.names.size());
  std::erase_if(missing, [&](const media::FrameSpan& segment) {
    const std::span<const std::string> names = names_of(frames, segment);
    return std::none_of(names.begin(), names.end(), [&](const std::string& name) { return filled.contains(name); }) ||
           !store.lacks(names);
  });
  make_and_use(
      missing.size(), [&](std::size_t k) { return encode_segment(frames, missing[k], tick); },
      [&](std::size_t k, const MediaSegment& segment) { store.write(names_of(frames, missing[k]), segment); },
      bytes_per_segment(frames));
}

}  // namespace dvi::result
