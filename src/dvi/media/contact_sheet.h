#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace dvi::media {

/// One image of a contact sheet and the text below it.
struct SheetCell {
  cv::Mat3b image;
  std::string caption;
};

/// Scales an image to a width and keeps its proportions. For a long sheet, pass thumbnails instead of full images.
cv::Mat3b make_thumbnail(const cv::Mat3b& image, int width);

/// Returns the image with the mask tinted red and outlined.
cv::Mat3b draw_mask_overlay(const cv::Mat3b& image, const cv::Mat1b& mask);

/// Sets the boundary of the mask, `width` pixels wide, to red.
void draw_outline(cv::Mat3b& image, const cv::Mat1b& mask, int width = 1);

/// Blends each pixel of the image with the color (BGR) of its label; pixels of label 0 are unchanged.
cv::Mat3b draw_label_overlay(const cv::Mat3b& image, const cv::Mat1b& labels, const std::vector<cv::Vec3b>& colors);

/// Finds the part of an image, at most of `size`, that contains most of the mask's pixels.
cv::Rect find_densest_part(const cv::Mat1b& mask, cv::Size size);

/// Writes white text on a dark background into the lower left corner of an image, as large as its width allows.
void write_caption(cv::Mat3b& image, const std::string& text);

/// Arranges images of width `cell_width` in rows, for example input | mask overlay | result of a frame. Rows may differ in
/// length.
cv::Mat3b make_contact_sheet(const std::vector<std::vector<SheetCell>>& rows, int cell_width = 480);

}  // namespace dvi::media
