#include "dvi/synthesize/sheet.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/image/poisson.h"
#include "dvi/image/region.h"

namespace dvi::synthesize {
namespace {

constexpr int kCoarse = 4;  // pixels of the sheet to one at which offsets are compared

// The sheet as it is `offset` away; zeros, and not known, beyond it.
Sheet moved(const Sheet& sheet, cv::Point offset) {
  Sheet out(sheet.known.size());
  const cv::Rect all({}, sheet.known.size()), to = (all - offset) & all;
  if (to.empty()) return out;
  sheet.color(to + offset).copyTo(out.color(to));
  sheet.known(to + offset).copyTo(out.known(to));
  return out;
}

Sheet halved(const Sheet& sheet) {
  const cv::Size size((sheet.known.cols + kCoarse - 1) / kCoarse, (sheet.known.rows + kCoarse - 1) / kCoarse);
  Sheet out(size);
  cv::resize(sheet.color, out.color, size, 0, 0, cv::INTER_AREA);
  cv::Mat1f known, share;
  sheet.known.convertTo(known, CV_32F);
  cv::resize(known, share, size, 0, 0, cv::INTER_AREA);
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
      const cv::Vec3f d = sheet.color(y, x) - other.color(y, x);
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

// Light multiplies: so the contrast of what lies in the sun fades with it where it goes on in the shade.
constexpr float kBlack = 4;

cv::Mat3f logarithms(const cv::Mat3f& color) {
  cv::Mat3f out(color + cv::Scalar::all(kBlack));
  cv::log(out, out);
  return out;
}

// Joins what was copied along `offsets`, of which `taken` tells each pixel's or -1, without a step: the ratios of neighbors
// are those of the places that they were copied from, and at a seam the mean of what the two show (eq. 5 in logarithms).
class Seams {
 public:
  Seams(const Sheet& before, const cv::Mat1i& taken, const std::vector<cv::Point>& offsets)
      : known_(before.known.clone()), taken_(taken), offsets_(offsets), light_(logarithms(before.color)) {}

  void blend(Sheet& sheet) const {
    constexpr float kHold = 1e-4F;       // beyond 100 pixels, 1 / sqrt(kHold), the copies tell the light
    constexpr double kTolerance = 1e-3;  // of the logarithm: a quarter of a gray level at most
    PoissonSystem system{Region(cv::Mat1b(taken_ >= 0)), {}, {}, 1};
    if (system.region.size() == 0) return;
    std::vector<cv::Vec3f> x;
    for (const cv::Point p : system.region.pixels) {
      const cv::Vec3f own = light_(p + offsets_[taken_(p)]);
      float diagonal = kHold;
      cv::Vec3f right = kHold * own;
      for (const cv::Point q : {p + cv::Point(-1, 0), p + cv::Point(0, -1), p + cv::Point(1, 0), p + cv::Point(0, 1)}) {
        if (!inside(q) || (known_(q) == 0 && taken_(q) < 0)) continue;
        diagonal += 1;
        right += step(p, q);
        if (known_(q) != 0) right += light_(q);
      }
      system.diagonal.push_back(diagonal);
      system.right.push_back(right);
      x.push_back(own);
    }
    solve_poisson(system, x, kTolerance);
    for (std::size_t i = 0; i < x.size(); ++i)
      for (int c = 0; c < 3; ++c) sheet.color(system.region.pixels[i])[c] = std::max(std::exp(x[i][c]) - kBlack, 0.0F);
  }

 private:
  bool inside(cv::Point p) const { return cv::Rect({}, known_.size()).contains(p); }

  // From q to p, as those of the two places show it that are known; 0 if none is.
  cv::Vec3f step(cv::Point p, cv::Point q) const {
    cv::Vec3f sum;
    int count = 0;
    for (const int taken : {taken_(p), taken_(q)}) {
      if (taken < 0) continue;
      const cv::Point offset = offsets_[taken];
      if (!inside(p + offset) || !inside(q + offset) || known_(p + offset) == 0 || known_(q + offset) == 0) continue;
      sum += light_(p + offset) - light_(q + offset);
      ++count;
    }
    return count == 0 ? sum : sum / count;
  }

  cv::Mat1b known_;
  cv::Mat1i taken_;
  const std::vector<cv::Point>& offsets_;
  cv::Mat3f light_;
};

void complete_by(Sheet& sheet, const std::vector<cv::Point>& offsets, double reach) {
  const cv::Mat1b missing(sheet.known == 0);
  if (cv::countNonZero(missing) == 0) return;
  const Sheet coarse = halved(sheet);
  cv::Mat1f least(sheet.known.size(), std::numeric_limits<float>::max());
  cv::Mat1i taken(sheet.known.size(), -1);
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const cv::Mat1b usable(moved(sheet, offsets[i]).known & missing);
    if (cv::countNonZero(usable) == 0) continue;
    cv::Mat1f cost;
    cv::resize(mismatch(coarse, moved(coarse, offsets[i] / kCoarse), reach / kCoarse), cost, sheet.known.size(), 0, 0,
               cv::INTER_LINEAR);
    const cv::Mat1b better(usable & cv::Mat1b(cost < least));
    cost.copyTo(least, better);
    taken.setTo(static_cast<int>(i), better);
  }
  Seams(sheet, taken, offsets).blend(sheet);
  sheet.known.setTo(255, taken >= 0);
}

}  // namespace

void complete(Sheet& sheet, const std::vector<std::vector<cv::Point>>& rounds, double reach) {
  for (const std::vector<cv::Point>& offsets : rounds) complete_by(sheet, offsets, reach);
}

}  // namespace dvi::synthesize
