#include "dvi/depth/plane_sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/depth/semi_global.h"
#include "dvi/depth/source_frames.h"
#include "dvi/image/enlarge.h"
#include "dvi/image/interpolate.h"
#include "dvi/image/region.h"

namespace dvi::depth {
namespace {

/// Parameters of the plane sweep that are not options. Costs are in units of the noise of the camera.
struct PlaneSweepParams {
  int margin_px = 12;                 ///< Width of the area around a hole where the target's image itself is compared.
  int tile_px = 256;                  ///< Larger holes are processed in tiles, which bounds the memory.
  int max_labels = 64;                ///< Inverse depths that are compared, at most.
  double step_px = 0.5;               ///< Parallax between adjacent labels, if max_labels suffice.
  double max_step_px = 2;             ///< Parallax between adjacent labels otherwise; nearer surfaces are not searched.
  double min_depth_m = 10;            ///< Smallest depth of surfaces in image columns without any return.
  int window_px = 5;                  ///< Side of the window over which costs are averaged.
  std::size_t max_rays = 200;         ///< Rays of a tile by which its source frames are selected.
  double occlusion_tolerance = 0.05;  ///< The tolerance of VisibilityMap::occludes().

  int contrast_window_px = 17;  ///< Side of the window whose mean contrast is relative to.
  float contrast_scale = 64;    ///< Unit of contrast.
  float dark_levels = 16;       ///< Added to the mean, so that noise in dark areas is not amplified.

  float noise = 2;               ///< Standard deviation of contrast, in its unit, in normal illumination.
  float max_cost = 8;            ///< Cost at which views differ; larger differences cost the same.
  float max_agreement_cost = 2;  ///< Mean cost up to which views agree.
  float min_cost_gap = 0.5F;     ///< Difference of costs from which on one depth is distinguished from another.
  float min_signal = 3;  ///< Ratio of contrast to noise, and to the difference of views, from which on texture suffices.
  StepCosts steps{.one_label = 0.15F, .more = 1.5F};  ///< The costs of semi-global matching.
  float cost_per_label = 0.01F;                       ///< Selects the farthest of labels with equal costs.
};
constexpr PlaneSweepParams kPlaneSweep;
constexpr int kMaxViews = 20;  // source frames and the target

/// Computes the contrast of an image, which does not depend on its illumination: the difference to the mean of the surrounding
/// window, relative to that mean. Masked pixels do not count and have contrast 0.
cv::Mat1f compute_contrast(const cv::Mat3b& image, const cv::Mat1b& mask) {
  const cv::Size window(kPlaneSweep.contrast_window_px, kPlaneSweep.contrast_window_px);
  cv::Mat1b gray;
  cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  cv::Mat1f known(image.size(), 1.0F), masked_gray, mean, weight;
  known.setTo(0, mask);
  gray.convertTo(masked_gray, CV_32F);
  masked_gray = masked_gray.mul(known);
  cv::boxFilter(masked_gray, mean, CV_32F, window, {-1, -1}, false);
  cv::boxFilter(known, weight, CV_32F, window, {-1, -1}, false);
  cv::Mat1f out(image.size(), 0.0F);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x)
      if (known(y, x) > 0) {
        const float m = mean(y, x) / weight(y, x);
        out(y, x) = kPlaneSweep.contrast_scale * (masked_gray(y, x) - m) / (m + kPlaneSweep.dark_levels);
      }
  return out;
}

/// The contrast of a view, computed for the blocks of its image that are read.
class ContrastImage {
 public:
  ContrastImage(std::shared_ptr<const cv::Mat3b> image, std::shared_ptr<const cv::Mat1b> mask)
      : image_(std::move(image)),
        mask_(std::move(mask)),
        values_(image_->size()),
        is_known_((image_->rows - 1) / kBlockPx + 1, (image_->cols - 1) / kBlockPx + 1, uchar{0}) {}

  /// Interpolates the contrast at a position.
  float at(cv::Point2f position) {
    const int x = static_cast<int>(position.x) / kBlockPx, y = static_cast<int>(position.y) / kBlockPx;
    const int x1 = (static_cast<int>(position.x) + 1) / kBlockPx, y1 = (static_cast<int>(position.y) + 1) / kBlockPx;
    for (const cv::Point block : {cv::Point(x, y), cv::Point(x1, y), cv::Point(x, y1), cv::Point(x1, y1)})
      if (block.x < is_known_.cols && block.y < is_known_.rows && is_known_(block) == 0) compute(block);
    return bilinear(values_, position);
  }

 private:
  static constexpr int kBlockPx = 64;

  void compute(cv::Point block) {
    const cv::Rect box = cv::Rect(block * kBlockPx, cv::Size(kBlockPx, kBlockPx)) & cv::Rect({}, values_.size());
    const cv::Rect near = enlarge(box, kPlaneSweep.contrast_window_px, values_.size());
    compute_contrast((*image_)(near), (*mask_)(near))(box - near.tl()).copyTo(values_(box));
    is_known_(block) = 1;
  }

  std::shared_ptr<const cv::Mat3b> image_;
  std::shared_ptr<const cv::Mat1b> mask_;
  cv::Mat1f values_;
  cv::Mat1b is_known_;  ///< Per block, whether its values are computed.
};

/// A view that is compared.
struct Source {
  const Camera* camera;
  SE3 source_from_target;
  std::shared_ptr<ContrastImage> contrast;
  std::shared_ptr<const depth::VisibilityMap> visibility;

  /// Reads the contrast of the point at `x` (in its camera axes, up to scale; its depth is `z`). Returns whether it is visible.
  bool read_contrast(const Eigen::Vector3d& x, double z, float& value) const {
    if (!camera->in_front(x)) return false;
    const Eigen::Vector2d pixel = camera->project(x);
    if (!camera->contains(pixel)) return false;
    const cv::Point2f at(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
    if (visibility->is_masked(at) || visibility->occludes(at, z, kPlaneSweep.occlusion_tolerance)) return false;
    value = contrast->at(at);
    return true;
  }
};

/// A box of the target's image, its labels (label k is the inverse depth k * step), and the views that are compared.
struct Tile {
  cv::Rect box;
  cv::Mat1b searched;  ///< Pixels of the box whose depth is searched: 255.
  cv::Mat1f below;     ///< Inverse depth of the nearest surface below each searched pixel; 0: none.
  int labels = 0;
  double step = 0;  ///< The step between labels, in 1/m.
  std::vector<Source> sources;

  double inverse_depth(int label) const { return label == 0 ? 1 / depth::DepthMap::kInfinity : label * step; }
};

/// How well views agree on a point, in units of the noise.
struct Agreement {
  int views = 0;     ///< Views that show the point.
  float cost = 0;    ///< Mean distance of contrasts from their median. A fifth of them, if at least four, may be outliers.
  float signal = 0;  ///< Absolute value of the median contrast.
};

/// Compares the views at the point with inverse depth `w`; `directions` are those of its ray in each source.
Agreement compare_views(const Tile& tile, const std::vector<Eigen::Vector3d>& directions, double w) {
  std::array<float, kMaxViews> values{};
  Agreement out;
  for (std::size_t s = 0; s < tile.sources.size(); ++s) {
    const Eigen::Vector3d at = directions[s] + w * tile.sources[s].source_from_target.t;
    if (tile.sources[s].read_contrast(at, tile.sources[s].camera->depth(at) / w, values[out.views])) ++out.views;
  }
  const int n = out.views;
  if (n < 2) return out;
  std::sort(values.begin(), values.begin() + n);
  const float median = 0.5F * (values[(n - 1) / 2] + values[n / 2]);
  for (int i = 0; i < n; ++i) values[i] = std::min(std::abs(values[i] - median) / kPlaneSweep.noise, kPlaneSweep.max_cost);
  std::sort(values.begin(), values.begin() + n);
  const int kept = n < 4 ? n : n - (n + 1) / 5;
  for (int i = 0; i < kept; ++i) out.cost += values[i] / static_cast<float>(kept - 1);
  out.signal = std::abs(median) / kPlaneSweep.noise;
  return out;
}

/// Rotates the ray of a pixel of the target into the camera axes of each source.
std::vector<Eigen::Vector3d> rotate_ray(const Tile& tile, const Camera& target, cv::Point p) {
  const Eigen::Vector3d ray = target.ray({p.x, p.y});
  std::vector<Eigen::Vector3d> out;
  for (const Source& source : tile.sources) out.emplace_back(source.source_from_target.R * ray);
  return out;
}

/// Values per pixel of a tile and label: CV_32F matrices with one channel per label.
struct CostVolume {
  cv::Mat cost;
  cv::Mat observed;  ///< After compute_costs(), 1 where two views show the point, else 0; after average_costs(), positive or 0.
};

CostVolume compute_costs(const Tile& tile, const Camera& target) {
  CostVolume out{cv::Mat(tile.box.size(), CV_32FC(tile.labels)), cv::Mat(tile.box.size(), CV_32FC(tile.labels))};
  for (cv::Mat* m : {&out.cost, &out.observed}) m->reshape(1).setTo(0);
  for (int y = 0; y < tile.box.height; ++y)
    for (int x = 0; x < tile.box.width; ++x) {
      if (tile.searched(y, x) == 0) continue;
      const auto directions = rotate_ray(tile, target, cv::Point(x, y) + tile.box.tl());
      for (int k = 0; k < tile.labels; ++k) {
        const Agreement found = compare_views(tile, directions, tile.inverse_depth(k));
        if (found.views < 2) continue;
        out.cost.ptr<float>(y, x)[k] = found.cost;
        out.observed.ptr<float>(y, x)[k] = 1;
      }
    }
  return out;
}

/// Whether views show the pixel at this inverse depth and agree on its window. The window must have texture, unless the depth
/// is infinity: a uniform surface agrees at any depth.
bool is_reliable(const Tile& tile, const Camera& target, cv::Point p, double w) {
  if (compare_views(tile, rotate_ray(tile, target, p), w).views < 2) return false;
  float signal = 0, cost = 0, count = 0;
  constexpr int kHalf = kPlaneSweep.window_px / 2;
  for (int y = -kHalf; y <= kHalf; ++y)
    for (int x = -kHalf; x <= kHalf; ++x) {
      const Agreement found = compare_views(tile, rotate_ray(tile, target, p + cv::Point(x, y)), w);
      if (found.views < 2) continue;
      signal += found.signal;
      cost += found.cost;
      ++count;
    }
  return cost <= kPlaneSweep.max_agreement_cost * count &&
         (w == tile.inverse_depth(0) || signal > kPlaneSweep.min_signal * std::max(cost, count));
}

/// Averages costs over the observed pixels of the window. A label that is not observed may be correct, so it costs as much as
/// the others do on average: labels that fit better than average are preferred to it, and no others.
void average_costs(const Tile& tile, CostVolume& volume) {
  auto& [cost, observed] = volume;
  constexpr int kSide = kPlaneSweep.window_px;
  for (cv::Mat* m : {&cost, &observed}) cv::boxFilter(*m, *m, CV_32F, {kSide, kSide}, {-1, -1}, false, cv::BORDER_CONSTANT);
  for (int y = 0; y < cost.rows; ++y)
    for (int x = 0; x < cost.cols; ++x) {
      float *c = cost.ptr<float>(y, x), *s = observed.ptr<float>(y, x);
      float sum = 0;
      int count = 0;
      for (int k = 0; k < tile.labels; ++k) {
        s[k] = s[k] > kSide * kSide / 3.0F ? 1 / s[k] : 0;
        c[k] *= s[k];
        sum += c[k];
        count += s[k] > 0 ? 1 : 0;
      }
      const float average = sum / static_cast<float>(std::max(count, 1));
      for (int k = 0; k < tile.labels; ++k) {
        if (s[k] == 0) c[k] = average;
        c[k] += kPlaneSweep.cost_per_label * static_cast<float>(k);
      }
    }
}

/// Finds pixels where the surface below continues upward, as facades do above the uppermost beam of the LiDAR: the views agree
/// on its depth, and on no other depth better. Uniform areas agree at any depth; they belong to the surface if there is texture
/// above them that does and is not at infinity.
cv::Mat1b find_continued_surfaces(const Tile& tile, const Camera& target, const cv::Mat& costs) {
  cv::Mat1f cost(tile.box.size(), 0.0F), signal = cost.clone(), observed = cost.clone();
  for (int y = 0; y < tile.box.height; ++y)
    for (int x = 0; x < tile.box.width; ++x) {
      if (tile.below(y, x) == 0) continue;
      const auto directions = rotate_ray(tile, target, cv::Point(x, y) + tile.box.tl());
      const Agreement found = compare_views(tile, directions, tile.below(y, x));
      if (found.views < 2) continue;
      cost(y, x) = found.cost;
      signal(y, x) = found.signal;
      observed(y, x) = 1;
    }
  const cv::Mat1f pixel_observed = observed.clone();
  for (cv::Mat1f* m : {&cost, &signal, &observed})
    cv::boxFilter(*m, *m, CV_32F, {kPlaneSweep.window_px, kPlaneSweep.window_px}, {-1, -1}, false, cv::BORDER_CONSTANT);
  cv::Mat1b out(tile.box.size(), uchar{0});
  for (int x = 0; x < tile.box.width; ++x) {
    bool textured = false;
    for (int y = 0; y < tile.box.height; ++y) {
      if (y > 0 && tile.below(y, x) != tile.below(y - 1, x)) textured = false;
      if (pixel_observed(y, x) == 0 || cost(y, x) > kPlaneSweep.max_agreement_cost * observed(y, x)) continue;
      const float here = cost(y, x) / observed(y, x), *others = costs.ptr<float>(y, x);
      if (here > *std::min_element(others, others + tile.labels) + kPlaneSweep.min_cost_gap) continue;
      textured |= signal(y, x) > kPlaneSweep.min_signal * std::max(cost(y, x), observed(y, x)) &&
                  others[0] > here + kPlaneSweep.min_cost_gap;
      out(y, x) = textured ? 255 : 0;
    }
  }
  return out;
}

/// Writes the depth of the label with the lowest path costs where it is reliable. If another label fits as well, the copied
/// colors are similar.
void select_depths(const Tile& tile, const Camera& target, const CostVolume& volume, depth::DepthMap& out) {
  const auto& [cost, observed] = volume;
  const cv::Mat1b continued = find_continued_surfaces(tile, target, cost);
  const cv::Mat sum = sum_path_costs(cost, tile.searched, kPlaneSweep.steps);
  for (int y = 0; y < tile.box.height; ++y)
    for (int x = 0; x < tile.box.width; ++x) {
      const cv::Point p = cv::Point(x, y) + tile.box.tl();
      if (tile.searched(y, x) == 0) continue;
      const float* s = sum.ptr<float>(y, x);
      const auto k = static_cast<int>(std::min_element(s, s + tile.labels) - s);
      if (continued(y, x) != 0 && observed.ptr<float>(y, x)[0] != 0) {
        const float w = tile.below(y, x);
        out.z(p) = 1 / w;
        out.sigma(p) = static_cast<float>(0.5 * tile.step) / (w * w);
        continue;
      }
      // A pixel that is not observed at infinity may be at a distance where no view observes it.
      if (observed.ptr<float>(y, x)[0] == 0 || observed.ptr<float>(y, x)[k] == 0) continue;
      double w = tile.inverse_depth(k);
      if (k > 0 && k + 1 < tile.labels) {
        const double curvature = s[k - 1] - 2.0 * s[k] + s[k + 1];
        if (curvature > 0) w += 0.5 * tile.step * (s[k - 1] - s[k + 1]) / curvature;
      }
      if (!is_reliable(tile, target, p, w)) continue;
      out.z(p) = k == 0 ? depth::DepthMap::kInfinity : static_cast<float>(1 / w);
      out.sigma(p) = k == 0 ? 0 : static_cast<float>(0.5 * tile.step / (w * w));
    }
}

/// Finds the pixels of a tile without depth that are above a surface, or are sky. Returns the largest inverse depth of the
/// surfaces below them.
double find_searched_pixels(const depth::DepthMap& depth, Tile& tile) {
  tile.searched = cv::Mat1b(tile.box.size(), uchar{0});
  tile.below = cv::Mat1f(tile.box.size(), 0.0F);
  double nearest = 0;
  for (int x = tile.box.x; x < tile.box.br().x; ++x) {
    double w = 0;
    for (int y = depth.z.rows - 1; y >= tile.box.y; --y) {
      const float z = depth.z(y, x);
      if (depth::DepthMap::is_surface(z)) {
        w = 1 / z;
      } else if (y < tile.box.br().y && (w > 0 || z == depth::DepthMap::kSky)) {
        tile.searched(cv::Point(x, y) - tile.box.tl()) = 255;
        tile.below(cv::Point(x, y) - tile.box.tl()) = static_cast<float>(w);
        nearest = std::max(nearest, w > 0 ? w : 1 / kPlaneSweep.min_depth_m);
      }
    }
  }
  return nearest;
}

/// Computes the displacement of a point in a source, in pixels per 1/m of inverse depth, at infinity.
double compute_parallax(const Source& source, const Eigen::Vector3d& ray) {
  const Eigen::Vector3d x = source.source_from_target.R * ray;
  return source.camera->in_front(x) ? (source.camera->differentiate(x) * source.source_from_target.t).norm() : 0;
}

/// Divides the bounding boxes of the hole's parts into tiles with a margin.
std::vector<cv::Rect> list_tiles(const cv::Mat1b& hole) {
  constexpr int kSize = kPlaneSweep.tile_px, kMargin = kPlaneSweep.margin_px;
  std::vector<cv::Rect> out;
  for (const cv::Rect& part : find_part_boxes(hole)) {
    const cv::Point end = part.br();
    for (int y = part.y; y < end.y; y += kSize)
      for (int x = part.x; x < end.x; x += kSize)
        out.push_back(cv::Rect(cv::Point(x - kMargin, y - kMargin),
                               cv::Point(std::min(x + kSize, end.x) + kMargin, std::min(y + kSize, end.y) + kMargin)) &
                      cv::Rect({}, hole.size()));
  }
  return out;
}

}  // namespace

DepthMap sweep_planes(const Target& target, const PlaneSweepOptions& options) {
  if (!options.enabled) return target.depth;
  const Views& views = target.views;
  DepthMap out{target.depth.z.clone(), target.depth.sigma.clone()};
  const cv::Mat1b hole = *target.mask();
  const Camera& camera = target.view().camera;
  std::map<std::size_t, std::shared_ptr<ContrastImage>> contrasts;
  const auto source_of = [&](std::size_t view) {
    auto& image = contrasts[view];
    if (!image) image = std::make_shared<ContrastImage>(views.images[view], views.masks[view]);
    return Source{&views[view].camera, views[view].camera_from_world * target.view().camera_from_world.inverse(), image,
                  target.visibility[view]};
  };
  for (const cv::Rect& box : list_tiles(hole)) {
    Tile tile{box, {}, {}, 0, 0, {}};
    double max_inverse_depth = find_searched_pixels(target.depth, tile);
    std::vector<cv::Point> unknown_pixels;
    cv::findNonZero(hole(box) & tile.searched, unknown_pixels);
    if (unknown_pixels.empty()) continue;
    std::vector<Eigen::Vector3d> rays;
    for (std::size_t i = 0; i < unknown_pixels.size(); i += unknown_pixels.size() / kPlaneSweep.max_rays + 1)
      rays.push_back(camera.ray({unknown_pixels[i].x + box.x, unknown_pixels[i].y + box.y}));
    for (const std::size_t view :
         choose_source_frames(target, {rays, max_inverse_depth}, options.sources, options.max_frame_gap))
      tile.sources.push_back(source_of(view));
    if (tile.sources.empty()) continue;
    std::erase_if(contrasts, [](const auto& item) { return item.second.use_count() == 1; });  // each is as large as four images
    double parallax = 0;
    for (const Source& source : tile.sources)
      for (const Eigen::Vector3d& ray : rays) parallax = std::max(parallax, compute_parallax(source, ray));
    if (parallax > 0)
      max_inverse_depth = std::min(max_inverse_depth, kPlaneSweep.max_step_px * (kPlaneSweep.max_labels - 1) / parallax);
    tile.labels = std::clamp(cvCeil(parallax * max_inverse_depth / kPlaneSweep.step_px) + 1, 1, kPlaneSweep.max_labels);
    tile.step = max_inverse_depth / std::max(1, tile.labels - 1);
    tile.sources.push_back(source_of(target.index));  // it shows the surroundings of the hole
    CostVolume volume = compute_costs(tile, camera);
    average_costs(tile, volume);
    select_depths(tile, camera, volume, out);
  }
  return out;
}

}  // namespace dvi::depth
