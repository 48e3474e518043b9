#include "dvi/harmonize/harmonize.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/core/median.h"
#include "dvi/core/statistics.h"
#include "dvi/depth/depth_map.h"
#include "dvi/drive/view.h"
#include "dvi/harmonize/confidence.h"
#include "dvi/harmonize/copies.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/harmonize/fuse.h"
#include "dvi/harmonize/known_copies.h"
#include "dvi/harmonize/limit_colors.h"
#include "dvi/harmonize/provenance.h"
#include "dvi/harmonize/road_colors.h"
#include "dvi/harmonize/screening.h"
#include "dvi/harmonize/surface_class.h"
#include "dvi/image/interpolate.h"
#include "dvi/image/neighbors.h"
#include "dvi/image/poisson.h"
#include "dvi/image/region.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {
namespace {

/// Parameters of the Poisson equation that are not options.
struct PoissonParams {
  float anchor_weight = 1e-4F;  ///< Data term of parts without a boundary; too weak to be visible in gradients.
  /// Weight between surfaces of different classes. It is not 0, because a pixel may have no other neighbor.
  float silhouette_weight = 1e-3F;
  float sky_sigmas = 3;             ///< Deviation from the median up to which a color may be sky.
  float pixel_noise_levels = 2.5F;  ///< Standard deviation of a camera's pixel.
  double along_road_weight = 4;     ///< Weight along the road, where colors change half as fast as across it.
  double min_ground_weight = 0.01;  ///< Smallest weight, used near the horizon, where the ground may rise.
};
constexpr PoissonParams kPoisson;

/// The role of a pixel in an equation.
enum class Role : std::uint8_t { fixed, solved, absent };

bool is_inside(const cv::Mat& image, cv::Point p) { return cv::Rect({}, image.size()).contains(p); }

/// Returns a mask of the pixels that have a value.
template <class Value>
cv::Mat1b mask_equal(const cv::Mat1b& image, Value value) {
  cv::Mat1b out;
  cv::compare(image, static_cast<uchar>(value), out, cv::CMP_EQ);
  return out;
}

/// The bounding box of the target's hole and of its surroundings. Pixels are relative to the box.
struct Window {
  Window(const depth::Target& frame, const Fused& sources, const cv::Mat1f& depths, const cv::Mat1b& surface_classes)
      : target(frame), fused(sources), candidates(sources.candidates) {
    const Region& hole = candidates.hole;
    if (hole.pixels.empty()) return;
    const cv::Rect bounds = cv::boundingRect(hole.pixels);
    box = cv::Rect(bounds.x - 1, bounds.y - 1, bounds.width + 2, bounds.height + 2) & cv::Rect({}, hole.index.size());
    index = hole.index(box);
    depth = depths(box);
    classes = surface_classes.empty() ? cv::Mat1b(box.size(), static_cast<uchar>(SurfaceClass::unknown)) : surface_classes(box);
  }

  const depth::Target& target;
  const Fused& fused;
  const sample::Candidates& candidates;
  cv::Rect box;
  cv::Mat1i index;    ///< Index of the hole pixel, or -1.
  cv::Mat1f depth;    ///< The values of FilledFrame::depth.
  cv::Mat1b classes;  ///< Values of SurfaceClass.

  std::size_t size() const { return candidates.leading.size(); }
  cv::Point pixel(std::size_t i) const { return candidates.hole.pixels[i] - box.tl(); }
  bool is_unobserved(cv::Point p) const { return index(p) >= 0 && !candidates.leading[index(p)].found(); }
  bool is_unobserved_sky(cv::Point p) const { return depth(p) == depth::DepthMap::kInfinity && is_unobserved(p); }
  SurfaceClass class_of(cv::Point p) const { return static_cast<SurfaceClass>(classes(p)); }
};

/// Assigns roles to copied and to unobserved pixels; all others are fixed.
cv::Mat1b assign_roles(const Window& window, Role copied, Role unobserved) {
  cv::Mat1b roles(window.box.size(), static_cast<uchar>(Role::fixed));
  for (std::size_t i = 0; i < window.size(); ++i)
    roles(window.pixel(i)) = static_cast<uchar>(window.candidates.leading[i].found() ? copied : unobserved);
  return roles;
}

/// Estimates the range of sky colors from the fixed pixels next to unobserved sky: within three sigmas of their median. Depth
/// does not distinguish sky from a roof above the uppermost beam of the LiDAR. Distant surfaces such as woods have a large
/// deviation, so that all their colors are in the range.
ColorRange estimate_sky_colors(const Window& window, const cv::Mat1b& roles, const cv::Mat3f& color) {
  std::array<std::vector<float>, 3> levels;
  for (std::size_t i = 0; i < window.size(); ++i) {
    if (!window.is_unobserved_sky(window.pixel(i))) continue;
    for (const cv::Point q : four_neighbors(window.pixel(i))) {
      if (!is_inside(roles, q) || roles(q) != static_cast<uchar>(Role::fixed) || depth::DepthMap::is_solid(window.depth(q)))
        continue;
      for (int c = 0; c < 3; ++c) levels[c].push_back(color(q)[c]);
    }
  }
  ColorRange out;
  if (levels[0].empty()) return out;
  for (int c = 0; c < 3; ++c) {
    const float middle = median(levels[c]);
    for (float& value : levels[c]) value = std::abs(value - middle);
    const float sigma = static_cast<float>(kSigmaPerMad) * median(std::move(levels[c])) + kPoisson.pixel_noise_levels;
    out.low[c] = middle - kPoisson.sky_sigmas * sigma;
    out.high[c] = middle + kPoisson.sky_sigmas * sigma;
  }
  return out;
}

/// A connected part of the solved pixels.
struct Part {
  bool is_bounded = false;  ///< Whether it has a fixed neighbor.
  bool has_copies = false;  ///< Whether some of its pixels are copied.
};

/// Labels the connected parts; label 0 is for pixels that are not solved.
std::vector<Part> label_parts(const Window& window, const cv::Mat1b& roles, cv::Mat1i& labels) {
  const int count = label_connected_parts(mask_equal(roles, Role::solved), labels);
  std::vector<Part> parts(count + 1);
  for (std::size_t i = 0; i < window.size(); ++i) {
    const cv::Point p = window.pixel(i);
    Part& part = parts[labels(p)];
    part.has_copies |= window.candidates.leading[i].found();
    for (const cv::Point q : four_neighbors(p))
      part.is_bounded |= is_inside(roles, q) && roles(q) == static_cast<uchar>(Role::fixed);
  }
  return parts;
}

/// Gradients and weights of pairs of neighbors.
struct Guidance {
  bool seams = true;   ///< Whether gradients between pixels with different sources are read from the sources; else they are 0.
  float vertical = 1;  ///< Weight of vertical pairs relative to horizontal ones.
  cv::Mat1f below{};   ///< The same per pixel, for the pair with its lower neighbor; empty: `vertical` everywhere.
  std::vector<ColorPull> pulls{};  ///< Per pixel of the hole; empty: none.

  float weight(cv::Point p, cv::Point q) const {
    if (p.y == q.y) return 1;
    return below.empty() ? vertical : below(p.y < q.y ? p : q);
  }
};

/// The pixels of the window: their roles in an equation, and their colors.
struct Canvas {
  cv::Mat1b roles;  ///< Values of Role.
  cv::Mat3f color;
};

/// Builds the system of eq. 5 for the solved pixels of a canvas.
class Equation {
 public:
  Equation(const Window& window, const Copies& copies, const Guidance& guidance, const Canvas& canvas)
      : window_(window),
        copies_(copies),
        guidance_(guidance),
        roles_(canvas.roles),
        color_(canvas.color),
        sky_(estimate_sky_colors(window, roles_, color_)) {}

  PoissonSystem build(const cv::Mat1i& labels, const std::vector<Part>& parts) const {
    PoissonSystem out{Region(mask_equal(roles_, Role::solved)), {}, {}, guidance_.vertical};
    if (guidance_.seams || !guidance_.below.empty()) set_pair_weights(out);
    out.diagonal.reserve(out.region.size());
    out.right.reserve(out.region.size());
    for (const cv::Point p : out.region.pixels) {
      const int i = window_.index(p);
      const bool copied = window_.candidates.leading[i].found();
      float diagonal = 0;
      cv::Vec3f right = copied ? copies_.outward[i] : cv::Vec3f();
      for (const cv::Point q : four_neighbors(p)) {
        if (!is_inside(roles_, q) || roles_(q) == static_cast<uchar>(Role::absent)) continue;
        const float weight = pair_weight(p, q) * (is_silhouette(p, q) ? kPoisson.silhouette_weight : 1);
        diagonal += weight;
        right += weight * right_side(i, q);
      }
      const float anchor = parts[labels(p)].is_bounded ? 0 : kPoisson.anchor_weight;
      if (const float screening = std::max(copies_.screening.weight[i], anchor); copied && screening > 0) {
        diagonal += screening;
        right += screening * copies_.screening.color[i];
      }
      if (!guidance_.pulls.empty()) {
        diagonal += guidance_.pulls[i].weight;
        right += guidance_.pulls[i].weight * guidance_.pulls[i].color;
      }
      out.diagonal.push_back(diagonal);
      out.right.push_back(right);
    }
    return out;
  }

 private:
  /// Whether p is unobserved and its neighbor q, which is fixed, is of another class, or only one of them is sky.
  bool is_silhouette(cv::Point p, cv::Point q) const {
    if (roles_(q) != static_cast<uchar>(Role::fixed) || !window_.is_unobserved(p)) return false;
    if (!window_.is_unobserved_sky(p))
      return window_.is_unobserved_sky(q) || are_different(window_.class_of(p), window_.class_of(q));
    return depth::DepthMap::is_solid(window_.depth(q)) || sky_.clamp(color_(q)) != color_(q);
  }

  /// The contribution of a neighbor to the right side: its color if it is fixed, plus the gradient of the copies.
  cv::Vec3f right_side(int i, cv::Point q) const {
    cv::Vec3f out;
    if (roles_(q) == static_cast<uchar>(Role::fixed)) out += color_(q);
    const int j = window_.index(q);
    const std::vector<sample::Candidate>& candidates = window_.candidates.leading;
    if (j < 0 || !candidates[i].found() || !candidates[j].found()) return out;
    if (candidates[j].view == candidates[i].view) return out + copies_.color[i] - copies_.color[j];
    if (!guidance_.seams) return out;
    const cv::Point p = window_.pixel(i);
    return is_first(p, q) ? out + seam_of(p, q).step : out - seam_of(q, p).step;
  }

  static bool is_first(cv::Point p, cv::Point q) { return p.x < q.x || p.y < q.y; }
  const Seam& seam_of(cv::Point first, cv::Point second) const {
    return copies_.seams[window_.index(first)][first.y == second.y ? 0 : 1];
  }

  /// The weight of the equation of two neighbors.
  float pair_weight(cv::Point p, cv::Point q) const {
    const float smooth = guidance_.weight(p, q);
    if (!guidance_.seams || window_.index(p) < 0 || window_.index(q) < 0) return smooth;
    return smooth * (is_first(p, q) ? seam_of(p, q) : seam_of(q, p)).weight();
  }

  void set_pair_weights(PoissonSystem& system) const {
    for (const cv::Point p : system.region.pixels)
      for (const cv::Point q : {p + cv::Point(1, 0), p + cv::Point(0, 1)})
        (p.y == q.y ? system.beside : system.below).push_back(is_inside(roles_, q) ? pair_weight(p, q) : 0);
  }

  const Window& window_;
  const Copies& copies_;
  Guidance guidance_;
  const cv::Mat1b& roles_;
  const cv::Mat3f& color_;
  ColorRange sky_;
};

/// Solves for the colors of the solved pixels. Parts without copies and without a boundary become absent.
void solve(const Window& window, const Copies& copies, const Guidance& guidance, Canvas& canvas) {
  if (window.size() == 0) return;
  auto& [roles, color] = canvas;
  cv::Mat1i labels;
  const std::vector<Part> parts = label_parts(window, roles, labels);
  for (std::size_t i = 0; i < window.size(); ++i) {
    const cv::Point p = window.pixel(i);
    if (labels(p) > 0 && !parts[labels(p)].is_bounded && !parts[labels(p)].has_copies)
      roles(p) = static_cast<uchar>(Role::absent);
  }
  const PoissonSystem system = Equation(window, copies, guidance, canvas).build(labels, parts);
  std::vector<cv::Vec3f> x;
  x.reserve(system.region.size());
  for (const cv::Point p : system.region.pixels) x.push_back(copies.color[window.index(p)]);
  solve_poisson(system, x);
  for (std::size_t k = 0; k < x.size(); ++k)
    for (int c = 0; c < 3; ++c) color(system.region.pixels[k])[c] = std::clamp(x[k][c], 0.0F, 255.0F);
}

/// Computes the weight of vertical pairs on the ground, relative to horizontal ones, for a membrane in the plane of the ground.
/// A pixel there is (distance / height of the camera) times as long as wide, and weights are proportional to the inverse
/// square.
cv::Mat1f weigh_ground_pairs(const Window& window) {
  const View& view = window.target.view();
  const Eigen::Matrix3d world_from_camera = view.camera_from_world.R.transpose();
  cv::Mat1f out(window.box.size(), 1.0F);
  for (std::size_t i = 0; i < window.size(); ++i) {
    const cv::Point p = window.pixel(i), in_image = p + window.box.tl();
    if (window.class_of(p) != SurfaceClass::ground) continue;
    const double descent = (world_from_camera * view.camera.ray(Eigen::Vector2d(in_image.x, in_image.y))).z();
    out(p) = static_cast<float>(std::clamp(kPoisson.along_road_weight * descent * descent, kPoisson.min_ground_weight, 1.0));
  }
  return out;
}

/// The guidance of unobserved pixels.
struct UnobservedGuidance {
  Guidance plain, ground;
};

/// Interpolates unobserved pixels from all others: the sky, the ground, then the rest. On return, the interpolated pixels have
/// the role `solved`.
void interpolate_unobserved(const Window& window, const Copies& copies, const UnobservedGuidance& guidance, Canvas& canvas) {
  if (window.size() == 0) return;
  cv::Mat1b filled(window.box.size(), uchar{0});
  const auto fill_where = [&](const auto& is_wanted, const Guidance& chosen) {
    canvas.roles = assign_roles(window, Role::fixed, Role::absent);
    canvas.roles.setTo(static_cast<uchar>(Role::fixed), filled);
    for (std::size_t i = 0; i < window.size(); ++i)
      if (const cv::Point p = window.pixel(i); window.is_unobserved(p) && filled(p) == 0 && is_wanted(p))
        canvas.roles(p) = static_cast<uchar>(Role::solved);
    solve(window, copies, chosen, canvas);
    filled |= mask_equal(canvas.roles, Role::solved);
  };
  fill_where([&](cv::Point p) { return window.is_unobserved_sky(p); }, guidance.plain);
  fill_where([&](cv::Point p) { return window.class_of(p) == SurfaceClass::ground; }, guidance.ground);
  fill_where([](cv::Point) { return true; }, guidance.plain);
  canvas.roles = assign_roles(window, Role::fixed, Role::absent);
  canvas.roles.setTo(static_cast<uchar>(Role::solved), filled);
}

void write_provenance(const depth::Target& target, const Fused& fused, FilledFrame& out) {
  const sample::Candidates& candidates = fused.candidates;
  for (std::size_t i = 0; i < candidates.leading.size(); ++i) {
    const sample::Candidate& source = candidates.leading[i];
    if (!source.found()) continue;
    const bool is_same_sequence = target.views[source.view].sequence == target.view().sequence;
    out.kind(candidates.hole.pixels[i]) = static_cast<uchar>(is_same_sequence ? Kind::copied : Kind::copied_elsewhere);
    out.provenance(candidates.hole.pixels[i]) = Provenance::encode(source.view, source.position);
    out.used(candidates.hole.pixels[i]) = {source.footprint[1], source.footprint[0], fused.sources[i]};
  }
}

/// Computes the distance from each unobserved pixel of the window to the nearest known or copied one, which is never outside
/// the window.
cv::Mat1f measure_distance_to_known(const cv::Mat1b& kind) {
  if (kind.empty()) return {};
  cv::Mat1b unobserved = mask_equal(kind, Kind::interpolated);
  unobserved.setTo(255, mask_equal(kind, Kind::empty));
  cv::Mat1f distance;
  cv::distanceTransform(unobserved, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  return distance;
}

void write_confidence(const Window& window, const ErrorScale& scale, FilledFrame& out) {
  const Fused& fused = window.fused;
  const cv::Mat1f distance = measure_distance_to_known(out.kind(window.box));
  for (std::size_t i = 0; i < fused.color.size(); ++i) {
    const cv::Point p = fused.candidates.hole.pixels[i];
    double confidence = 0;
    if (fused.candidates.leading[i].found()) {
      const double change = mean_difference(out.color(p), fused.color[i]);
      const double expected =
          estimate_error_levels(gather_evidence(window.target, fused, i, {measure_texture(out.color, p), change}));
      confidence = confidence_of_copy(scale.at(expected) * expected);
    } else if (out.kind(p) == static_cast<uchar>(Kind::interpolated)) {
      confidence = confidence_of_interpolation(distance(window.pixel(i)));
    }
    out.confidence(p) = static_cast<uchar>(std::lround(255 * confidence));
  }
}

}  // namespace

FilledFrame harmonize(const depth::Target& target, const sample::Candidates& sampled, const HarmonizeInput& input,
                      const HarmonizeOptions& options) {
  const Fused fused = fuse(target, sampled, input.illumination);
  const sample::Candidates& candidates = fused.candidates;
  const Region& hole = candidates.hole;
  FilledFrame out =
      make_unfilled_frame(*target.image(), cv::Mat1b(hole.index >= 0), target.depth.z.clone(), target.view().gain);
  for (std::size_t i = 0; i < hole.size(); ++i)
    if (const cv::Point p = hole.pixels[i]; fused.sky(p) != 0 && !candidates.leading[i].found())
      out.depth(p) = depth::DepthMap::kInfinity;

  Copies copies = read_copies(target, fused, input.illumination);
  copies.screening =
      compute_screening(copies, candidates, options.robust_boundary ? BoundaryModel::robust : BoundaryModel::published);
  for (std::size_t i = 0; i < hole.size(); ++i) out.color(hole.pixels[i]) = copies.color[i];
  const Role copied = options.poisson ? Role::solved : Role::fixed;
  const Role unobserved = options.unobserved == Unobserved::leave ? Role::absent : Role::solved;
  const Window window(target, fused, out.depth, input.classes);
  Canvas canvas{assign_roles(window, copied, options.unobserved_last ? Role::absent : unobserved), out.color(window.box)};
  solve(window, copies, {.seams = options.seam_gradients}, canvas);
  if (options.poisson && options.within_range)
    limit_copies(find_range_around(*target.image(), out.mask), candidates, copies.color, out.color);
  if (options.unobserved_last && unobserved == Role::solved) {
    const Guidance plain{.seams = false, .vertical = static_cast<float>(options.unobserved_vertical)};
    const std::vector<ColorPull> road = pull_along_road(target, candidates, input, out.color);
    interpolate_unobserved(window, copies, {plain, {false, plain.vertical, weigh_ground_pairs(window), road}}, canvas);
  }
  for (std::size_t i = 0; i < hole.size(); ++i) {
    const bool solved = canvas.roles(window.pixel(i)) == static_cast<uchar>(Role::solved);
    out.kind(hole.pixels[i]) = static_cast<uchar>(solved ? Kind::interpolated : Kind::empty);
  }
  write_provenance(target, fused, out);
  write_confidence(window, ErrorScale(measure_known_copies(target, input.known)), out);
  return out;
}

}  // namespace dvi::harmonize
