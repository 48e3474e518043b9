#include "dvi/synthesize/exemplar_search.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <ranges>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/core/hal/intrin.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/core/threads.h"

namespace dvi::synthesize {
namespace {

/// Parameters of the exemplar search. Costs are differences in gray levels, whose squares are added.
struct ExemplarParams {
  int radius = 4;           ///< Patches have 2 * radius + 1 pixels per side, at each level of the pyramid.
  int tries = 8;            ///< Random positions of each kind that are tried for a patch without an exemplar.
  float fine_scale = 2;     ///< Up to this scale, exemplars are only improved, without searching all of the image.
  int fine_search_px = 8;   ///< Radius of that search.
  float known_weight = 3;   ///< Weight of known pixels of a patch relative to unknown ones.
  float group_levels = 40;  ///< Difference that two pixels of different groups have.
  float max_scale = 1.7F;   ///< Largest ratio of scales of a patch and its exemplar on the ground.
  float scale_levels = 40;  ///< Cost of a larger ratio, where the exemplar is used as it is.
  float row_levels = 3;     ///< Cost of an exemplar at another height in the image, per 10 px.
  float left_levels = 15;   ///< Cost of an exemplar on the ground farther to the side, per meter.
  float place_max = 45;     ///< Largest cost of these distances.
  float prior_weight = 1;   ///< Weight of the difference of the mean color of an exemplar to the interpolation ...
  float prior_max = 80;     ///< ... which counts up to this difference.
  float usage_levels = 6;   ///< Cost of an exemplar that is used twice as often as the mean.
  float usage_max = 20;     ///< Largest cost of usage.
};
constexpr ExemplarParams kExemplar;

constexpr int kTilePx = 16;  ///< side of the tiles that threads take when exemplars are improved
constexpr int kR = kExemplar.radius;
constexpr int kSide = 2 * kR + 1;
constexpr float kInfinite = std::numeric_limits<float>::infinity();

cv::Point2f position_of(cv::Point source, const PatchWarp& warp, cv::Point offset) {
  return cv::Point2f(source) + warp * cv::Point2f(offset);
}

cv::Mat1f box_sum(const cv::Mat1f& image) {
  cv::Mat1f out;
  cv::boxFilter(image, out, CV_32F, cv::Size(kSide, kSide), cv::Point(-1, -1), false, cv::BORDER_CONSTANT);
  return out;
}

/// Loads the color at a position bilinearly. The pixels to the right of and below it must be inside.
cv::v_float32x4 load(const cv::Mat4f& image, cv::Point2f at) {
  const int x = static_cast<int>(at.x), y = static_cast<int>(at.y);
  const cv::v_float32x4 u = cv::v_setall_f32(at.x - static_cast<float>(x)), v = cv::v_setall_f32(at.y - static_cast<float>(y));
  const cv::Vec4f *top = image[y] + x, *below = image[y + 1] + x;
  const cv::v_float32x4 a = cv::v_load(top[0].val), c = cv::v_load(below[0].val);
  const cv::v_float32x4 upper = cv::v_muladd(cv::v_load(top[1].val) - a, u, a);
  const cv::v_float32x4 lower = cv::v_muladd(cv::v_load(below[1].val) - c, u, c);
  return cv::v_muladd(lower - upper, v, upper);
}

/// Loads the color of the pixel of an exemplar that corresponds to an offset in the patch.
cv::v_float32x4 load_color(const cv::Mat4f& image, cv::Point source, const PatchWarp& warp, cv::Point offset) {
  return warp.is_identity() ? cv::v_load(image(source + offset).val) : load(image, position_of(source, warp, offset));
}

}  // namespace

ExemplarSearch::ExemplarSearch(ExemplarLevel& level, std::uint64_t seed)
    : level_(level),
      seed_(seed),
      targets_(find_targets(level)),
      matches_(targets_.size()),
      tile_grid_((level.size().width - 1) / kTilePx + 1, (level.size().height - 1) / kTilePx + 1),
      tiles_(static_cast<std::size_t>(tile_grid_.area())),
      usage_(level.size(), 0.0F) {
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    const cv::Point tile = targets_.pixels[i] / kTilePx;
    tiles_[tile_index(tile)].push_back(i);
  }
  prior_.reserve(targets_.size());
  for (const cv::Point p : targets_.pixels) prior_.push_back(level.prior(p));
  level.prior.release();
  cv::Mat1f weight(level.size(), kExemplar.known_weight);
  weight.setTo(1, level.unknown);
  weight_ = box_sum(weight);
  cv::merge(std::vector<cv::Mat>(4, weight), pixel_weight_);
  cv::boxFilter(level.color, mean_, CV_32F, cv::Size(kSide, kSide));
  for (int y = 0; y < level.size().height; ++y)
    for (int x = 0; x < level.size().width; ++x)
      if (level.clearance(y, x) >= kR) sources_[level.group(y, x)].emplace_back(x, y);
}

Region ExemplarSearch::find_targets(const ExemplarLevel& level) {
  cv::Mat1b targets;
  cv::dilate(level.unknown, targets, cv::Mat::ones(kSide, kSide, CV_8U));
  return Region(cv::Mat1b(targets & (level.group != 0)));
}

/// Returns the random numbers of a target in this round.
Random ExemplarSearch::random_of(std::size_t target) const {
  constexpr std::uint64_t kRound = 0xD1B54A32D192ED03ULL, kTarget = 0x2545F4914F6CDD1DULL;  // odd: all products differ
  return Random(seed_ + round_ * kRound + target * kTarget);
}

/// Calls a function for each target, in any order.
void ExemplarSearch::for_each_target(const std::function<void(std::size_t)>& call) const {
  parallel_for(tiles_.size(), [&](std::size_t tile) {
    for (const std::size_t i : tiles_[tile]) call(i);
  });
}

/// Calls a function for each target after its left and upper neighbors and before its right and lower ones, or the other way
/// round: as in raster order, but the tiles of a diagonal are processed at the same time.
void ExemplarSearch::for_each_in_order(bool forward, const std::function<void(std::size_t)>& call) const {
  const int diagonals = tile_grid_.width + tile_grid_.height - 1;
  for (int step = 0; step < diagonals; ++step) {
    const int diagonal = forward ? step : diagonals - 1 - step;
    const int first_row = std::max(0, diagonal - tile_grid_.width + 1), last_row = std::min(diagonal, tile_grid_.height - 1);
    const int rows = last_row - first_row + 1;
    parallel_for(static_cast<std::size_t>(rows), [&](std::size_t k) {
      const int row = first_row + static_cast<int>(k);
      const std::vector<std::size_t>& tile = tiles_[tile_index({diagonal - row, row})];
      if (forward)
        for (const std::size_t i : tile) call(i);
      else
        for (const std::size_t i : std::views::reverse(tile)) call(i);
    });
  }
}

void ExemplarSearch::start(const ExemplarSearch* coarser) {
  ++round_;
  for_each_target([&](std::size_t i) {
    Random random = random_of(i);
    const cv::Point p = targets_.pixels[i], half(p.x / 2, p.y / 2);
    const bool inherits = coarser && coarser->targets_.index(half) >= 0 && coarser->match(half).found();
    if (inherits) {
      const Exemplar& from = coarser->match(half);
      try_match(i, 2 * from.at + (p - 2 * half));
    }
    for (int k = 0; k < kExemplar.tries && !matches_[i].found(); ++k) try_row(i, random);
    for (int k = 0; k < kExemplar.tries && !matches_[i].found(); ++k) try_random(i, random);
  });
}

void ExemplarSearch::improve(bool forward) {
  ++round_;
  for (Exemplar& match : matches_) match.cost = kInfinite;
  for_each_in_order(forward, [&](std::size_t i) {
    Random random = random_of(i);
    if (matches_[i].found()) {
      const cv::Point at = matches_[i].at;
      matches_[i].at = {-1, -1};
      try_match(i, at);
    }
    propagate(i, forward);
    search(i, random);
  });
  if (level_.scale > kExemplar.fine_scale) count_usage();
}

void ExemplarSearch::vote() { vote(kR); }

void ExemplarSearch::vote(int radius_px) {
  std::vector<float> costs;
  for (const Exemplar& match : matches_)
    if (match.found()) costs.push_back(match.cost);
  if (costs.empty()) return;
  std::nth_element(costs.begin(), costs.begin() + static_cast<std::ptrdiff_t>(costs.size() * 3 / 4), costs.end());
  const float sigma2 = std::max(costs[costs.size() * 3 / 4], 1.0F);
  std::vector<PatchWarp> warps(targets_.size());
  std::vector<float> weights(targets_.size(), 0.0F);
  for_each_target([&](std::size_t i) {
    if (!matches_[i].found()) return;
    warps[i] = warp_of(targets_.pixels[i], matches_[i].at);
    weights[i] = std::exp(-matches_[i].cost / (2 * sigma2)) + 1e-4F;
  });
  std::vector<cv::Vec4f> colors(targets_.size());
  std::vector<char> voted(targets_.size(), 0);
  for_each_target([&](std::size_t i) {
    const cv::Point p = targets_.pixels[i];
    if (level_.unknown(p) == 0) return;
    cv::v_float32x4 sum = cv::v_setzero_f32();
    float weight = 0;
    for (int y = -radius_px; y <= radius_px; ++y)
      for (int x = -radius_px; x <= radius_px; ++x) {
        const cv::Point center = p + cv::Point(x, y);
        if (!is_inside(center) || targets_.index(center) < 0) continue;
        const auto k = static_cast<std::size_t>(targets_.index(center));
        if (!matches_[k].found()) continue;
        sum = sum + cv::v_setall_f32(weights[k]) * load_color(level_.color, matches_[k].at, warps[k], {-x, -y});
        weight += weights[k];
      }
    if (weight <= 0) return;
    cv::v_store(colors[i].val, sum);
    colors[i] /= weight;
    voted[i] = 1;
  });
  for (std::size_t i = 0; i < targets_.size(); ++i)
    if (voted[i] != 0) level_.color(targets_.pixels[i]) = colors[i];
}

/// Returns the perspective of the ground, if both pixels are on it and their scales are similar; else the identity.
PatchWarp ExemplarSearch::warp_of(cv::Point target, cv::Point source) const {
  if (!level_.is_ground(target) || !level_.is_ground(source)) return {};
  const cv::Vec4f &t = level_.slope(target), &s = level_.slope(source);
  const float det = s[0] * s[3] - s[2] * s[1], scale = std::abs((t[0] * t[3] - t[2] * t[1]) / det);
  constexpr float kMax = kExemplar.max_scale * kExemplar.max_scale;
  if (!(scale < kMax && scale > 1 / kMax)) return {};
  // Inverse of the source's derivative [s0 s2; s1 s3], times the target's.
  const PatchWarp out{(s[3] * t[0] - s[2] * t[1]) / det, (s[3] * t[2] - s[2] * t[3]) / det, (s[0] * t[1] - s[1] * t[0]) / det,
                      (s[0] * t[3] - s[1] * t[2]) / det};
  return out.extent() < 2 * kExemplar.max_scale ? out : PatchWarp{};
}

void ExemplarSearch::try_match(std::size_t i, cv::Point source) {
  Exemplar& match = matches_[i];
  if (source == match.at || !is_inside(source)) return;
  const float cost = cost_of(targets_.pixels[i], source, match.cost);
  if (cost < match.cost) match = {source, cost};
}

void ExemplarSearch::try_random(std::size_t i, Random& random) {
  const std::vector<cv::Point>& sources = sources_[level_.group(targets_.pixels[i])];
  if (!sources.empty()) try_match(i, sources[random.below(static_cast<int>(sources.size()))]);
}

/// Tries a position in the same row, where ground has the same scale.
void ExemplarSearch::try_row(std::size_t i, Random& random) {
  const int x = random.below(level_.size().width);
  try_match(i, {x, targets_.pixels[i].y + random.below(5) - 2});
}

/// Tries positions on the line along the road through the pixel.
void ExemplarSearch::try_along_road(std::size_t i, Random& random) {
  const cv::Point p = targets_.pixels[i];
  const cv::Vec4f& slope = level_.slope(p);
  const float det = slope[0] * slope[3] - slope[2] * slope[1];
  cv::Point2f along(slope[3] / det, -slope[1] / det);
  along /= std::max({std::abs(along.x), std::abs(along.y), 1e-6F});
  for (int k = 0; k < 2; ++k) {
    const float step = static_cast<float>(random.uniform(-0.5, 0.5)) * static_cast<float>(level_.size().width);
    try_match(i, p + cv::Point(cvRound(step * along.x), cvRound(step * along.y)));
  }
}

void ExemplarSearch::propagate(std::size_t i, bool forward) {
  const cv::Point p = targets_.pixels[i];
  const int step = forward ? -1 : 1;
  for (const cv::Point d : {cv::Point(step, 0), cv::Point(0, step), cv::Point(-step, 0), cv::Point(0, -step)}) {
    const cv::Point q = p + d;
    if (!is_inside(q) || targets_.index(q) < 0) continue;
    const Exemplar& neighbor = match(q);
    if (!neighbor.found()) continue;
    const cv::Point2f back = warp_of(q, neighbor.at) * cv::Point2f(static_cast<float>(-d.x), static_cast<float>(-d.y));
    try_match(i, neighbor.at + cv::Point(cvRound(back.x), cvRound(back.y)));
  }
}

void ExemplarSearch::search(std::size_t i, Random& random) {
  const cv::Point p = targets_.pixels[i];
  const bool coarse = level_.scale > kExemplar.fine_scale;
  for (int radius = coarse ? level_.size().width / 2 : kExemplar.fine_search_px; radius >= 1; radius /= 2) {
    const cv::Point from = matches_[i].found() ? matches_[i].at : p;
    const int high = std::min(radius, level_.size().height / 4);
    const int x = random.below(2 * radius + 1) - radius;
    try_match(i, from + cv::Point(x, random.below(2 * high + 1) - high));
  }
  if (coarse || !matches_[i].found()) try_row(i, random);
  if (!coarse) return;
  try_random(i, random);
  if (level_.is_ground(p)) try_along_road(i, random);
}

/// Computes the squared cost of the place of an exemplar, and of its usage.
float ExemplarSearch::cost_of_place(cv::Point target, cv::Point source, const PatchWarp& warp) const {
  const bool on_ground = level_.is_ground(target) && level_.is_ground(source);
  const float distance = on_ground
                             ? kExemplar.left_levels * std::abs(level_.ground(target)[1] - level_.ground(source)[1])
                             : kExemplar.row_levels * level_.scale * static_cast<float>(std::abs(target.y - source.y)) / 10;
  const float place = std::min(distance, kExemplar.place_max),
              used = std::min(kExemplar.usage_levels * usage_(source), kExemplar.usage_max),
              scaled = on_ground && warp.is_identity() && source != target ? kExemplar.scale_levels : 0;
  float cost = place * place + used * used + scaled * scaled;
  if (level_.unknown(target) != 0) {
    const cv::Vec4f difference = mean_(source) - prior_[targets_.index(target)];
    cost += kExemplar.prior_weight * std::min(difference.dot(difference) / 3, kExemplar.prior_max * kExemplar.prior_max);
  }
  return cost;
}

/// Computes the mean squared difference of a patch and an exemplar, with the cost of its place; infinite from `limit` on.
float ExemplarSearch::cost_of(cv::Point target, cv::Point source, float limit) const {
  if (level_.group(source) != level_.group(target)) return kInfinite;
  const PatchWarp warp = warp_of(target, source);
  // Bilinear interpolation needs one more pixel.
  if (level_.clearance(source) < (warp.is_identity() ? kR : std::floor(static_cast<float>(kR) * warp.extent()) + 1))
    return kInfinite;
  const float prior = cost_of_place(target, source, warp);
  if (prior >= limit) return kInfinite;
  const int y0 = std::max(-kR, -target.y), y1 = std::min(kR, level_.size().height - 1 - target.y),
            x0 = std::max(-kR, -target.x), x1 = std::min(kR, level_.size().width - 1 - target.x);
  const int columns = x1 - x0 + 1;
  const auto width = static_cast<std::size_t>(columns);
  const float most = weight_(target) * (limit - prior);
  const bool identity = warp.is_identity();
  constexpr float kOtherGroup = kExemplar.group_levels * kExemplar.group_levels;
  float sum = 0;
  for (int y = y0; y <= y1; ++y) {
    const cv::Vec4f *row = level_.color[target.y + y] + target.x, *weight = pixel_weight_[target.y + y] + target.x;
    const uchar* group = level_.group[target.y + y] + target.x;
    cv::v_float32x4 squares = cv::v_setzero_f32();
    float groups = 0;
    const auto compare = [&](int x, const cv::v_float32x4& other) {
      const cv::v_float32x4 difference = cv::v_load(row[x].val) - other;
      squares = cv::v_muladd(difference * difference, cv::v_load(weight[x].val), squares);
    };
    if (identity) {
      const cv::Vec4f* other = level_.color[source.y + y] + source.x;
      const uchar* other_group = level_.group[source.y + y] + source.x;
      for (int x = x0; x <= x1; ++x) compare(x, cv::v_load(other[x].val));
      if (std::memcmp(group + x0, other_group + x0, width) != 0)
        for (int x = x0; x <= x1; ++x)
          if (group[x] != other_group[x]) groups += weight[x][0] * kOtherGroup;
    } else {
      for (int x = x0; x <= x1; ++x) {
        const cv::Point2f q = position_of(source, warp, {x, y});
        compare(x, load(level_.color, q));
        if (group[x] != level_.group(static_cast<int>(q.y + 0.5F), static_cast<int>(q.x + 0.5F)))
          groups += weight[x][0] * kOtherGroup;
      }
    }
    sum += cv::v_reduce_sum(squares) / 3 + groups;
    if (sum > most) return kInfinite;
  }
  return sum / weight_(target) + prior;
}

void ExemplarSearch::count_usage() {
  usage_.setTo(0);
  std::array<int, 256> wanted{};
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    ++wanted[level_.group(targets_.pixels[i])];
    if (matches_[i].found()) usage_(matches_[i].at) += 1;
  }
  usage_ = box_sum(usage_) / (kSide * kSide);
  for (int y = 0; y < usage_.rows; ++y)
    for (int x = 0; x < usage_.cols; ++x) {
      const uchar group = level_.group(y, x);
      const float mean =
          static_cast<float>(wanted[group]) / static_cast<float>(std::max<std::size_t>(1, sources_[group].size()));
      usage_(y, x) = std::max(0.0F, usage_(y, x) / std::max(mean, 1.0F) - 1);
    }
}

}  // namespace dvi::synthesize
