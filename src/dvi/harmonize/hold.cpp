#include "dvi/harmonize/hold.h"

#include <cmath>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/core/median.h"
#include "dvi/harmonize/fuse.h"
#include "dvi/image/region.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {
namespace {

constexpr float kHeld = 1e-2F;               // fades over 10 px: beyond, gains are right to a few grey levels
constexpr int kCoarsest = 128, kFinest = 8;  // px of a cell
constexpr float kDoubtful = 30;              // grey levels, three times what a right copy may be off by
constexpr float kCoarser = 4;                // pixels of the rim that the coarser cell counts as

/// By cells: by how much the target is brighter than its sources, and how far the rim is from that, in grey levels.
struct Field {
  cv::Mat3f light;
  cv::Mat1f spread;

  void resize(double factor) {
    cv::resize(light, light, {}, factor, factor, cv::INTER_LINEAR);
    cv::resize(spread, spread, {}, factor, factor, cv::INTER_LINEAR);
  }
};

void refine(const std::vector<RimPixel>& rim, int cell, Field& field) {
  cv::Mat3f light(kCoarser * field.light);
  cv::Mat1f spread(kCoarser * field.spread), weights(light.size(), kCoarser), counts(light.size(), kCoarser);
  for (const RimPixel& pixel : rim) {
    const cv::Point at = pixel.at / cell;
    const float off = most_different(pixel.difference, field.light(at)) / kDoubtful, weight = 1 / (1 + off * off);
    light(at) += weight * pixel.difference;
    weights(at) += weight;
    spread(at) += mean_difference(pixel.difference, field.light(at));
    counts(at) += 1;
  }
  for (int y = 0; y < light.rows; ++y)
    for (int x = 0; x < light.cols; ++x) {
      field.light(y, x) = light(y, x) / weights(y, x);
      field.spread(y, x) = spread(y, x) / counts(y, x);
    }
}

cv::Vec3f median_difference(const std::vector<RimPixel>& rim) {
  cv::Vec3f out;
  for (int c = 0; c < 3; ++c) {
    std::vector<float> values;
    values.reserve(rim.size());
    for (const RimPixel& pixel : rim) values.push_back(pixel.difference[c]);
    out[c] = median(std::move(values));
  }
  return out;
}

/// By how much the target is brighter than each source with enough of the rim, than others on the whole.
class LightOfSources {
 public:
  explicit LightOfSources(const std::vector<RimPixel>& rim) : whole_(median_difference(rim)) {
    constexpr std::size_t kEnough = 20;
    std::map<int, std::vector<RimPixel>> of_view;
    for (const RimPixel& pixel : rim) of_view[pixel.view].push_back(pixel);
    for (const auto& [view, pixels] : of_view)
      if (pixels.size() >= kEnough) light_[view] = median_difference(pixels);
  }
  const cv::Vec3f& of(int view) const {
    const auto found = light_.find(view);
    return found == light_.end() ? whole_ : found->second;
  }

 private:
  cv::Vec3f whole_;
  std::map<int, cv::Vec3f> light_;
};

/// From coarse cells to fine ones: where a cell has little of the rim, it follows the coarser one.
Field field_of(const std::vector<RimPixel>& rim, cv::Size image) {
  const cv::Size cells((image.width + kCoarsest - 1) / kCoarsest, (image.height + kCoarsest - 1) / kCoarsest);
  Field field{{cells, cv::Vec3f()}, {cells, 0.0F}};
  for (int cell = kCoarsest; cell >= kFinest; cell /= 2) {
    if (cell < kCoarsest) field.resize(2);
    refine(rim, cell, field);
  }
  field.resize(kFinest);
  return field;
}

}  // namespace

Hold hold_of(const Copies& copies, const sample::Candidates& candidates, bool robust_rim) {
  const Region& hole = candidates.hole;
  Hold out{copies.colour, std::vector<float>(hole.size(), copies.of_other_days ? kHeld : 0)};
  if (copies.of_other_days || !robust_rim || copies.rim.empty()) return out;
  const LightOfSources light(copies.rim);
  std::vector<RimPixel> rest = copies.rim;
  for (RimPixel& pixel : rest) pixel.difference -= light.of(pixel.view);
  const Field field = field_of(rest, hole.index.size());
  for (std::size_t i = 0; i < hole.size(); ++i) {
    const cv::Point p = hole.pixels[i];
    const float doubt = std::pow(field.spread(p) / kDoubtful, 4.0F);
    out.colour[i] += light.of(candidates.leading[i].view) + field.light(p);
    out.weight[i] = kHeld * doubt / (1 + doubt);
  }
  return out;
}

}  // namespace dvi::harmonize
