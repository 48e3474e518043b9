#include "dvi/objects/detect/input.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace dvi::objects {

namespace {

constexpr int kStride = 32;  // the largest stride of common networks, of which an input of any size is a multiple

int round_up_to_stride(int side) { return (side + kStride - 1) / kStride * kStride; }

}  // namespace

InputFit fit_image(cv::Size image, const Description& description) {
  cv::Size input = description.input;
  if (input.empty()) input = {round_up_to_stride(image.width), round_up_to_stride(image.height)};
  cv::Rect content({0, 0}, input);
  if (description.fit == Fit::letterbox) {
    const double scale =
        std::min(static_cast<double>(input.width) / image.width, static_cast<double>(input.height) / image.height);
    content.width = std::clamp(static_cast<int>(std::lround(scale * image.width)), 1, input.width);
    content.height = std::clamp(static_cast<int>(std::lround(scale * image.height)), 1, input.height);
    content.x = (input.width - content.width) / 2;
    content.y = (input.height - content.height) / 2;
  }
  return {image,
          input,
          content,
          {static_cast<double>(content.width) / image.width, static_cast<double>(content.height) / image.height},
          cv::Point2d(content.x, content.y)};
}

cv::Mat make_input_blob(const cv::Mat3b& image, const InputFit& fit, const Description& description) {
  cv::Mat3b input(fit.input, cv::Vec3b::all(cv::saturate_cast<uchar>(description.pad)));
  cv::Mat3b content = input(fit.content);
  if (image.size() == content.size())
    image.copyTo(content);
  else
    cv::resize(image, content, content.size(), 0, 0, cv::INTER_LINEAR);
  const int sizes[] = {1, 3, fit.input.height, fit.input.width};
  cv::Mat blob(4, sizes, CV_32F);
  for (int c = 0; c < 3; ++c) {
    cv::Mat1b plane;
    cv::extractChannel(input, plane, description.channels == Channels::rgb ? 2 - c : c);
    cv::Mat out(fit.input, CV_32F, blob.ptr(0, c));
    const double scale = 1 / description.sigma[static_cast<std::size_t>(c)];
    plane.convertTo(out, CV_32F, scale, -scale * description.mean[static_cast<std::size_t>(c)]);
  }
  return blob;
}

cv::Mat1f resample_to_image(const cv::Mat1f& map, const InputFit& fit, cv::Rect part) {
  const cv::Point2d cells(static_cast<double>(map.cols) / fit.input.width, static_cast<double>(map.rows) / fit.input.height);
  const cv::Point2d scale(cells.x * fit.scale.x, cells.y * fit.scale.y);
  const cv::Matx23d map_from_part(scale.x, 0, scale.x * (part.x + 0.5) + cells.x * fit.offset.x - 0.5,  //
                                  0, scale.y, scale.y * (part.y + 0.5) + cells.y * fit.offset.y - 0.5);
  cv::Mat1f out;
  cv::warpAffine(map, out, map_from_part, part.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  return out;
}

}  // namespace dvi::objects
