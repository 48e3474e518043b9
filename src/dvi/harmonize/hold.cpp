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

constexpr float kHeld = 1e-2F;               // fades over 10 px: beyond, gains are right to a few gray levels
constexpr int kCoarsest = 128, kFinest = 8;  // px of a cell
constexpr float kCoarser = 4;                // pixels that the coarser cell counts as

/// Something in gray levels, by cells: where a cell has little of it, it follows the coarser one.
template <class Value>
class Field {
 public:
  explicit Field(cv::Size image)
      : value_((image.height + kCoarsest - 1) / kCoarsest, (image.width + kCoarsest - 1) / kCoarsest, Value()) {
    begin();
  }
  const Value& at(cv::Point cell) const { return value_(cell); }
  void add(cv::Point cell, const Value& value, float weight = 1) {
    sum_(cell) += weight * value;
    weight_(cell) += weight;
  }
  /// From the cells, that all have been added to, to finer ones, or to pixels.
  void refine(int times) {
    for (int y = 0; y < sum_.rows; ++y)
      for (int x = 0; x < sum_.cols; ++x) value_(y, x) = sum_(y, x) / weight_(y, x);
    cv::resize(value_, value_, {}, times, times, cv::INTER_LINEAR);
    begin();
  }

 private:
  void begin() {
    sum_ = kCoarser * value_;
    weight_ = cv::Mat1f(value_.size(), kCoarser);
  }

  cv::Mat_<Value> value_, sum_;
  cv::Mat1f weight_;
};

int finer(int cell) { return cell > kFinest ? 2 : kFinest; }

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

/// By how much the target is brighter than its sources, and how far the rim is from that.
struct LightAlongRim {
  LightAlongRim(const std::vector<RimPixel>& rim, cv::Size image) : light(image), spread(image) {
    for (int cell = kCoarsest; cell >= kFinest; cell /= 2) {
      for (const RimPixel& pixel : rim) {
        const cv::Point at = pixel.at / cell;
        const float off = most_different(pixel.difference, light.at(at)) / kDoubtful;
        spread.add(at, mean_difference(pixel.difference, light.at(at)));
        light.add(at, pixel.difference, 1 / (1 + off * off));
      }
      light.refine(finer(cell));
      spread.refine(finer(cell));
    }
  }

  Field<cv::Vec3f> light;
  Field<float> spread;
};

Field<float> doubt_at_seams(const Copies& copies, const Region& hole) {
  Field<float> out(hole.index.size());
  for (int cell = kCoarsest; cell >= kFinest; cell /= 2) {
    for (std::size_t i = 0; i < hole.size(); ++i)
      for (const Seam& seam : copies.seams[i])
        if (seam.shown == 2) out.add(hole.pixels[i] / cell, seam.doubt);
    out.refine(finer(cell));
  }
  return out;
}

}  // namespace

Hold hold_of(const Copies& copies, const sample::Candidates& candidates, bool robust_rim) {
  const Region& hole = candidates.hole;
  Hold out{copies.color, std::vector<float>(hole.size(), copies.of_other_days ? kHeld : 0)};
  if (copies.of_other_days || !robust_rim || copies.rim.empty()) return out;
  const LightOfSources light(copies.rim);
  std::vector<RimPixel> rest = copies.rim;
  for (RimPixel& pixel : rest) pixel.difference -= light.of(pixel.view);
  const LightAlongRim along(rest, hole.index.size());
  const Field<float> at_seams = doubt_at_seams(copies, hole);
  for (std::size_t i = 0; i < hole.size(); ++i) {
    const cv::Point p = hole.pixels[i];
    const float doubt = std::pow(along.spread.at(p) / kDoubtful, 4.0F) + std::pow(at_seams.at(p) / kDoubtfulSeam, 4.0F);
    out.color[i] += light.of(candidates.leading[i].view) + along.light.at(p);
    out.weight[i] = kHeld * doubt / (1 + doubt);
  }
  return out;
}

}  // namespace dvi::harmonize
