#pragma once

#include <opencv2/core/mat.hpp>

#include "dvi/objects/background_model.h"

namespace dvi::objects {

/// Returns the distance, in pixels of half size, up to which edges of an object are searched beyond its mask. Masks lack tires,
/// wheels, and parts between two rays of 64 beams, which is half a degree; a view is assumed to have about 80 degrees.
int compute_edge_search_radius_px(const cv::Size& half_size);

/// Adds the missing edges of objects to their mask (half size). A pixel is added if it is connected to the mask and differs
/// from the background, also one pixel beside, by more than almost all pixels farther from the mask do. Thin lines that lead
/// away from the mask are not added: they are displaced edges of static surfaces. `image` is the same view at half size.
cv::Mat1b add_missing_edges(const cv::Mat1b& mask, const BackgroundModel& background, const cv::Mat3b& image, int radius_px);

}  // namespace dvi::objects
