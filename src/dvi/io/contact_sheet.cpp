#include "dvi/io/contact_sheet.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace dvi::io {
namespace {

constexpr int kGap = 4, kCaption = 20;
const cv::Scalar kPaper(32, 32, 32), kInk(230, 230, 230);

int row_height(const std::vector<SheetCell>& row) {
  int height = 0;
  for (const SheetCell& cell : row) height = std::max(height, cell.image.rows);
  return height + kCaption + kGap;
}

void draw(cv::Mat3b& sheet, const SheetCell& cell, cv::Point corner, int width) {
  cell.image.copyTo(sheet(cv::Rect(corner, cell.image.size())));
  const int y = corner.y + cell.image.rows;
  cv::putText(sheet(cv::Rect(corner.x, y, width, kCaption)), cell.caption, {3, kCaption - 6}, cv::FONT_HERSHEY_SIMPLEX, 0.42,
              kInk, 1, cv::LINE_AA);
}

}  // namespace

cv::Mat3b thumbnail(const cv::Mat3b& image, int width) {
  if (image.cols == width) return image;
  const int height = std::max(1, cvRound(static_cast<double>(image.rows) * width / image.cols));
  cv::Mat3b small;
  cv::resize(image, small, {width, height}, 0, 0, width < image.cols ? cv::INTER_AREA : cv::INTER_LINEAR);
  return small;
}

cv::Mat3b mask_overlay(const cv::Mat3b& image, const cv::Mat1b& mask) {
  const cv::Vec3b red(40, 40, 255);
  cv::Mat3b tinted = image.clone();
  cv::Mat3b mixed;
  cv::addWeighted(image, 0.5, cv::Mat3b(image.size(), red), 0.5, 0, mixed);
  mixed.copyTo(tinted, mask);
  cv::Mat1b outline;
  cv::morphologyEx(mask, outline, cv::MORPH_GRADIENT, cv::getStructuringElement(cv::MORPH_RECT, {3, 3}));
  tinted.setTo(red, outline);
  return tinted;
}

cv::Mat3b contact_sheet(const std::vector<std::vector<SheetCell>>& rows, int cell_width) {
  std::vector<std::vector<SheetCell>> small = rows;
  std::size_t columns = 0;
  int height = kGap;
  for (std::vector<SheetCell>& row : small) {
    for (SheetCell& cell : row) cell.image = thumbnail(cell.image, cell_width);
    columns = std::max(columns, row.size());
    height += row_height(row);
  }
  cv::Mat3b sheet(height, kGap + static_cast<int>(columns) * (cell_width + kGap));
  sheet.setTo(kPaper);
  int y = kGap;
  for (const std::vector<SheetCell>& row : small) {
    int x = kGap;
    for (const SheetCell& cell : row) {
      draw(sheet, cell, {x, y}, cell_width);
      x += cell_width + kGap;
    }
    y += row_height(row);
  }
  return sheet;
}

}  // namespace dvi::io
