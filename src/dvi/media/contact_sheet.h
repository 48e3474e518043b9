#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace dvi::media {

/// One picture of a contact sheet and the words below it.
struct SheetCell {
  cv::Mat3b image;
  std::string caption;
};

/// The picture at this width, its proportions kept. To build a long sheet hand in thumbnails instead of full images.
cv::Mat3b thumbnail(const cv::Mat3b& image, int width);

/// The image with the mask tinted red and outlined.
cv::Mat3b mask_overlay(const cv::Mat3b& image, const cv::Mat1b& mask);

/// Sets the mask's border, `width` pixels wide, to red.
void draw_outline(cv::Mat3b& image, const cv::Mat1b& mask, int width = 1);

/// The image mixed with a color (BGR) a pixel by its label; label 0 stays.
cv::Mat3b label_overlay(const cv::Mat3b& image, const cv::Mat1b& labels, const std::vector<cv::Vec3b>& colors);

/// The part of an image, `size` at most, with most of the mask's pixels in it.
cv::Rect densest_part(const cv::Mat1b& mask, cv::Size size);

/// White text on a dark ground in the lower left corner of a picture, as wide as that allows.
void write_caption(cv::Mat3b& image, const std::string& text);

/// One sheet, a row below the other, every picture `cell_width` wide: input | mask_overlay | result of a frame, say. Rows may
/// differ in length.
cv::Mat3b contact_sheet(const std::vector<std::vector<SheetCell>>& rows, int cell_width = 480);

}  // namespace dvi::media
