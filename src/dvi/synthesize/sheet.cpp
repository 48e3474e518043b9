#include "dvi/synthesize/sheet.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace dvi::synthesize {
namespace {

constexpr int kCoarse = 4;  // pixels of the sheet to one at which offsets are compared

// The sheet as it is `offset` away; zeros, and not known, beyond it.
Sheet moved(const Sheet& sheet, cv::Point offset) {
  Sheet out(sheet.known.size());
  const cv::Rect all({}, sheet.known.size()), to = (all - offset) & all;
  if (to.empty()) return out;
  sheet.colour(to + offset).copyTo(out.colour(to));
  sheet.known(to + offset).copyTo(out.known(to));
  return out;
}

Sheet halved(const Sheet& sheet) {
  const cv::Size size((sheet.known.cols + kCoarse - 1) / kCoarse, (sheet.known.rows + kCoarse - 1) / kCoarse);
  Sheet out(size);
  cv::resize(sheet.colour, out.colour, size, 0, 0, cv::INTER_AREA);
  cv::Mat1f share;
  cv::resize(cv::Mat1f(sheet.known), share, size, 0, 0, cv::INTER_AREA);
  out.known = cv::Mat1b(share > 254);
  return out;
}

// By how much the known surroundings of each pixel differ from those `offset` away.
cv::Mat1f mismatch(const Sheet& sheet, const Sheet& other, double sigma) {
  const cv::Mat1b both(sheet.known & other.known);
  cv::Mat1f off(sheet.known.size(), 0.0F), weight(sheet.known.size(), 0.0F);
  for (int y = 0; y < off.rows; ++y)
    for (int x = 0; x < off.cols; ++x) {
      if (both(y, x) == 0) continue;
      const cv::Vec3f d = sheet.colour(y, x) - other.colour(y, x);
      off(y, x) = std::min(std::abs(d[0]) + std::abs(d[1]) + std::abs(d[2]), 120.0F);
      weight(y, x) = 1;
    }
  cv::GaussianBlur(off, off, {}, sigma);
  cv::GaussianBlur(weight, weight, {}, sigma);
  constexpr float kPrior = 1e-3F, kUsual = 60;  // where there is nothing to compare
  for (int y = 0; y < off.rows; ++y)
    for (int x = 0; x < off.cols; ++x) off(y, x) = (off(y, x) + kPrior * kUsual) / (weight(y, x) + kPrior);
  return off;
}

void complete_by(Sheet& sheet, const std::vector<cv::Point>& offsets, double reach) {
  const cv::Mat1b missing(sheet.known == 0);
  if (cv::countNonZero(missing) == 0) return;
  const Sheet coarse = halved(sheet);
  cv::Mat1f least(sheet.known.size(), std::numeric_limits<float>::max());
  Sheet best(sheet.known.size());
  for (const cv::Point offset : offsets) {
    const Sheet other = moved(sheet, offset);
    const cv::Mat1b usable(other.known & missing);
    if (cv::countNonZero(usable) == 0) continue;
    cv::Mat1f cost;
    cv::resize(mismatch(coarse, moved(coarse, offset / kCoarse), reach / kCoarse), cost, sheet.known.size(), 0, 0,
               cv::INTER_LINEAR);
    const cv::Mat1b better(usable & cv::Mat1b(cost < least));
    cost.copyTo(least, better);
    other.colour.copyTo(best.colour, better);
    best.known.setTo(255, better);
  }
  best.colour.copyTo(sheet.colour, best.known);
  sheet.known |= best.known;
}

}  // namespace

void complete(Sheet& sheet, const std::vector<std::vector<cv::Point>>& rounds, double reach) {
  for (const std::vector<cv::Point>& offsets : rounds) complete_by(sheet, offsets, reach);
}

}  // namespace dvi::synthesize
