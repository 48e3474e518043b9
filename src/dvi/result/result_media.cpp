#include "dvi/result/result_media.h"

#include <algorithm>
#include <array>
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

/// Makes a row of the contact sheet: the whole frame, then the part with most removed pixels in full size.
std::vector<media::SheetCell> make_sheet_row(const cv::Mat3b& input, const cv::Mat3b& result, const cv::Mat1b& kind,
                                             const std::string& name) {
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

}  // namespace

void write_media(const fs::path& out, const FinishedFrames& frames, const media::VideoOptions& options, const Tick& tick) {
  const std::vector<std::string>& names = frames.names;
  const cv::Size size = frames.size;
  const std::string camera = camera_of_frame(names.front());
  const fs::path folder = out / camera;
  media::VideoWriter video(folder / "video.mp4", size, options);
  media::VideoWriter compare(folder / "compare.mp4", {size.width, 2 * (size.height + size.height % 2)}, options);
  std::vector<std::vector<media::SheetCell>> sheet(std::min(kSheetRows, names.size()));
  // Rows evenly spread over the drive, the first and the last frame among them.
  const auto frame_of_row = [&](std::size_t row) {
    return sheet.size() > 1 ? row * (names.size() - 1) / (sheet.size() - 1) : 0;
  };
  const auto encode = [&](std::size_t first, std::size_t last) {
    media::SegmentEncoder result_part = video.new_segment(), compare_part = compare.new_segment();
    for (std::size_t i = first; i < last; ++i) {
      const cv::Mat3b input = frames.read_input(i), result = media::read_image(out / picture_file("frames", names[i]), size);
      const cv::Mat1b kind = media::read_png_gray(out / picture_file("kind", names[i]), size);
      result_part.push(result);
      compare_part.push_stacked({mark_input(input, kind, names[i]), result});
      for (std::size_t row = 0; row < sheet.size(); ++row)
        if (frame_of_row(row) == i) sheet[row] = make_sheet_row(input, result, kind, names[i]);
      tick();
    }
    return std::pair(result_part.finish(), compare_part.finish());
  };
  const auto append = [&](std::pair<media::VideoSegment, media::VideoSegment> parts) {
    video.append(std::move(parts.first));
    compare.append(std::move(parts.second));
  };
  media::encode_segments(names.size(), encode, append, kVideoBytesPerPixel * static_cast<std::size_t>(size.area()));
  video.finish();
  compare.finish();
  media::write_png(folder / "contact.png", media::make_contact_sheet(sheet, kCellWidthPx));
}

}  // namespace dvi::result
