#include "dvi/objects/residue.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace dvi::objects {
namespace {

// Returns the sum of the products a(p) b(p + shift) over all pixels and channels. Integers make it independent of the order.
template <typename T>
std::int64_t correlate(const cv::Mat& a, const cv::Mat& b, const cv::Point& shift) {
  const cv::Rect overlap = cv::Rect({}, a.size()) & cv::Rect(-shift, a.size());
  const int length = overlap.width * a.channels();
  std::int64_t sum = 0;
  for (int y = overlap.y; y < overlap.y + overlap.height; ++y) {
    const T* in_a = a.ptr<T>(y) + overlap.x * a.channels();
    const T* in_b = b.ptr<T>(y + shift.y) + (overlap.x + shift.x) * a.channels();
    int row = 0;
    for (int i = 0; i < length; ++i) row += in_a[i] * in_b[i];
    sum += row;
  }
  return sum;
}

// The color gradients of an image at some of its pixels, 0 at others.
struct Gradients {
  cv::Mat values;  // 16-bit, six channels: of blue, green, and red along x, then along y
  cv::Mat1i energy;

  Gradients(const cv::Mat3b& image, const cv::Mat1b& pixels) : energy(image.size(), 0) {
    std::array<cv::Mat, 2> parts;
    cv::Sobel(image, parts[0], CV_16S, 1, 0);
    cv::Sobel(image, parts[1], CV_16S, 0, 1);
    for (cv::Mat& part : parts) part.setTo(cv::Scalar::all(0), pixels == 0);
    cv::merge(parts.data(), parts.size(), values);
    for (int y = 0; y < values.rows; ++y)
      for (int i = 0; i < 6 * values.cols; ++i) energy(y, i / 6) += values.ptr<short>(y)[i] * values.ptr<short>(y)[i];
  }

  // Returns the number of pixels of equal energy that are as informative.
  double effective_pixels() const {
    double sum = 0, squares = 0;
    for (const int e : energy) sum += e, squares += static_cast<double>(e) * e;
    return squares > 0 ? sum * sum / squares : 0;
  }
};

// Returns the highest correlation of the gradients of two images at any displacement, -1 to 1.
double find_highest_correlation(const Gradients& input, const Gradients& result, const cv::Mat1b& pixels) {
  const int max_x = std::max(1, static_cast<int>(kResidue.max_shift_x * pixels.cols));
  const int max_y = std::max(1, static_cast<int>(kResidue.max_shift_y * pixels.rows));
  cv::Mat1i compared;
  cv::Mat(pixels / 255).convertTo(compared, CV_32S);
  const auto min_overlap = static_cast<std::int64_t>(kResidue.min_overlap * cv::countNonZero(pixels));
  double highest = -1;
  for (int y = -max_y; y <= max_y; ++y)
    for (int x = -max_x; x <= max_x; ++x) {
      const cv::Point shift(x, y);
      if (correlate<int>(compared, compared, shift) < min_overlap) continue;
      const std::int64_t energy =
          correlate<int>(input.energy, compared, shift) + correlate<int>(compared, result.energy, shift);
      if (energy == 0) continue;
      const auto product = static_cast<double>(correlate<short>(input.values, result.values, shift));
      highest = std::max(highest, 2 * product / static_cast<double>(energy));
    }
  return highest;
}

// The part of a frame around an object, scaled down to a limited size.
struct ObjectCrop {
  cv::Rect box;
  double scale = 1;

  explicit ObjectCrop(const cv::Mat1b& silhouette) : box(cv::boundingRect(silhouette)) {
    scale = std::min(1.0, static_cast<double>(kResidue.max_side_px) / std::max({box.width, box.height, 1}));
  }

  cv::Mat cut(const cv::Mat& image) const {
    if (scale >= 1) return image(box);
    cv::Mat out;
    cv::resize(image(box), out, {std::max(1, cvRound(scale * box.width)), std::max(1, cvRound(scale * box.height))}, 0, 0,
               cv::INTER_AREA);
    return out;
  }

  // Returns the pixels that lie completely in a silhouette, away from its border.
  cv::Mat1b cut_core(const cv::Mat1b& silhouette) const {
    const cv::Mat1b whole(cv::Mat1b(cut(silhouette)) > 250);
    const int border_px = std::min(whole.rows, whole.cols) < kResidue.max_thin_px ? 1 : 2;
    cv::Mat1b core;
    cv::erode(whole, core, cv::Mat1b(2 * border_px + 1, 2 * border_px + 1, uchar{1}), {-1, -1}, 1, cv::BORDER_CONSTANT,
              cv::Scalar(0));
    return core;
  }
};

double share_of(const cv::Mat1b& pixels, const cv::Mat1b& all) {
  return static_cast<double>(cv::countNonZero(cv::Mat1b(pixels & all))) / cv::countNonZero(all);
}

double measure_similarity(const ResultImages& images, const ObjectCrop& crop, const cv::Mat1b& core) {
  cv::Mat1b compared(core & (cv::Mat1b(crop.cut(images.removed)) > 127));
  if (!images.things.empty()) compared &= cv::Mat1b(crop.cut(images.things)) > 127;
  if (cv::countNonZero(compared) < kResidue.min_pixels) return 0;
  if (share_of(cv::Mat1b(cv::Mat1b(crop.cut(images.copied)) > 127), compared) < kResidue.min_copied) return 0;
  const Gradients input(crop.cut(images.input), compared), result(crop.cut(images.result), compared);
  const double pixels = input.effective_pixels();
  if (pixels == 0) return 0;
  return std::clamp(find_highest_correlation(input, result, compared) - 1 / std::sqrt(pixels), 0.0, 1.0);
}

}  // namespace

std::optional<FrameResidue> measure_residue(const ResultImages& images, const cv::Mat1b& silhouette) {
  const ObjectCrop crop(silhouette);
  if (crop.box.empty()) return std::nullopt;
  const cv::Mat1b core = crop.cut_core(silhouette);
  if (cv::countNonZero(core) < kResidue.min_pixels) return std::nullopt;
  return FrameResidue{measure_similarity(images, crop, core),
                      1 - share_of(cv::Mat1b(cv::Mat1b(crop.cut(images.removed)) > 127), core)};
}

}  // namespace dvi::objects
