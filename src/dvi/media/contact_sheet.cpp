#include "dvi/media/contact_sheet.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace dvi::media {
namespace {

constexpr int kGapPx = 4, kCaptionPx = 20;
const cv::Vec3b kRed(40, 40, 255);
const cv::Scalar kBackground(32, 32, 32), kTextColor(230, 230, 230);

int find_row_height(const std::vector<SheetCell>& row) {
  int height = 0;
  for (const SheetCell& cell : row) height = std::max(height, cell.image.rows);
  return height + kCaptionPx + kGapPx;
}

void draw(cv::Mat3b& sheet, const SheetCell& cell, cv::Point corner, int width) {
  cell.image.copyTo(sheet(cv::Rect(corner, cell.image.size())));
  const int y = corner.y + cell.image.rows;
  cv::putText(sheet(cv::Rect(corner.x, y, width, kCaptionPx)), cell.caption, {3, kCaptionPx - 6}, cv::FONT_HERSHEY_SIMPLEX,
              0.42, kTextColor, 1, cv::LINE_AA);
}

}  // namespace

cv::Mat3b make_thumbnail(const cv::Mat3b& image, int width) {
  if (image.cols == width) return image;
  const int height = std::max(1, cvRound(static_cast<double>(image.rows) * width / image.cols));
  cv::Mat3b small;
  cv::resize(image, small, {width, height}, 0, 0, width < image.cols ? cv::INTER_AREA : cv::INTER_LINEAR);
  return small;
}

cv::Mat3b draw_mask_overlay(const cv::Mat3b& image, const cv::Mat1b& mask) {
  cv::Mat3b tinted = image.clone();
  cv::Mat3b mixed;
  cv::addWeighted(image, 0.5, cv::Mat3b(image.size(), kRed), 0.5, 0, mixed);
  mixed.copyTo(tinted, mask);
  draw_outline(tinted, mask);
  return tinted;
}

void draw_outline(cv::Mat3b& image, const cv::Mat1b& mask, int width) {
  cv::Mat1b outline;
  const int edge = 2 * width + 1;
  cv::morphologyEx(mask, outline, cv::MORPH_GRADIENT, cv::getStructuringElement(cv::MORPH_RECT, {edge, edge}));
  image.setTo(kRed, outline);
}

cv::Mat3b draw_label_overlay(const cv::Mat3b& image, const cv::Mat1b& labels, const std::vector<cv::Vec3b>& colors) {
  cv::Mat3b out = image.clone();
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) {
      const std::size_t label = labels(y, x);
      if (label == 0 || label >= colors.size()) continue;
      for (int c = 0; c < 3; ++c) out(y, x)[c] = static_cast<uchar>((out(y, x)[c] + 2 * colors[label][c]) / 3);
    }
  return out;
}

cv::Rect find_densest_part(const cv::Mat1b& mask, cv::Size size) {
  const cv::Rect whole({}, mask.size());
  cv::Rect best({}, cv::Size(std::min(size.width, mask.cols), std::min(size.height, mask.rows)));
  cv::Mat1i sums;
  cv::integral(mask / 255, sums, CV_32S);
  int most = -1;
  const int step_x = std::max(1, best.width / 8), step_y = std::max(1, best.height / 8);
  for (int y = 0; y + best.height <= whole.height; y += step_y)
    for (int x = 0; x + best.width <= whole.width; x += step_x) {
      const int count = sums(y + best.height, x + best.width) - sums(y, x + best.width) - sums(y + best.height, x) + sums(y, x);
      if (count <= most) continue;
      most = count;
      best.x = x;
      best.y = y;
    }
  return best;
}

void write_caption(cv::Mat3b& image, const std::string& text) {
  constexpr double kMaxFontScale = 0.6;
  const cv::Size at_one = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, 1, 1, nullptr);
  const double scale = std::min(kMaxFontScale, (image.cols - 12.0) / std::max(1, at_one.width));
  const int height = std::max(6, cvRound(scale * at_one.height)), pad = std::max(2, height / 2);
  const cv::Rect ground =
      cv::Rect(0, image.rows - height - 2 * pad, cvRound(scale * at_one.width) + 3 * pad, height + 2 * pad) &
      cv::Rect({}, image.size());
  cv::Mat3b part = image(ground);
  part *= 0.3;
  cv::putText(image, text, {pad, image.rows - pad}, cv::FONT_HERSHEY_SIMPLEX, scale, cv::Scalar::all(255), 1, cv::LINE_AA);
}

cv::Mat3b make_contact_sheet(const std::vector<std::vector<SheetCell>>& rows, int cell_width) {
  std::vector<std::vector<SheetCell>> small = rows;
  std::size_t columns = 0;
  int height = kGapPx;
  for (std::vector<SheetCell>& row : small) {
    for (SheetCell& cell : row) cell.image = make_thumbnail(cell.image, cell_width);
    columns = std::max(columns, row.size());
    height += find_row_height(row);
  }
  cv::Mat3b sheet(height, kGapPx + static_cast<int>(columns) * (cell_width + kGapPx));
  sheet.setTo(kBackground);
  int y = kGapPx;
  for (const std::vector<SheetCell>& row : small) {
    int x = kGapPx;
    for (const SheetCell& cell : row) {
      draw(sheet, cell, {x, y}, cell_width);
      x += cell_width + kGapPx;
    }
    y += find_row_height(row);
  }
  return sheet;
}

}  // namespace dvi::media
