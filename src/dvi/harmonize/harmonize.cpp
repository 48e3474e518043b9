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
#include "dvi/depth/depth_map.h"
#include "dvi/drive/view.h"
#include "dvi/harmonize/confidence.h"
#include "dvi/harmonize/copies.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/harmonize/fuse.h"
#include "dvi/harmonize/hold.h"
#include "dvi/harmonize/known_copies.h"
#include "dvi/harmonize/limit_colors.h"
#include "dvi/harmonize/surface_class.h"
#include "dvi/image/interpolate.h"
#include "dvi/image/poisson.h"
#include "dvi/image/region.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {
namespace {

/// How a pixel of the frame enters the solution.
enum class Role : std::uint8_t { fixed, solved, absent };

std::array<cv::Point, 4> around(cv::Point p) {
  return {p + cv::Point(-1, 0), p + cv::Point(0, -1), p + cv::Point(1, 0), p + cv::Point(0, 1)};
}

bool inside(const cv::Mat& image, cv::Point p) { return cv::Rect({}, image.size()).contains(p); }

template <class Value>
cv::Mat1b where(const cv::Mat1b& image, Value value) {
  cv::Mat1b out;
  cv::compare(image, static_cast<uchar>(value), out, cv::CMP_EQ);
  return out;
}

/// The hole with what lies round it, all that filling it looks at. Pixels are those of the box.
struct Window {
  Window(const Fused& fused, const cv::Mat1f& depths, const cv::Mat1b& surface_classes) : copies(fused.candidates) {
    const Region& hole = copies.hole;
    if (hole.pixels.empty()) return;
    const cv::Rect within = cv::boundingRect(hole.pixels);
    box = cv::Rect(within.x - 1, within.y - 1, within.width + 2, within.height + 2) & cv::Rect({}, hole.index.size());
    index = hole.index(box);
    depth = depths(box);
    classes = surface_classes.empty() ? cv::Mat1b(box.size(), static_cast<uchar>(SurfaceClass::unknown)) : surface_classes(box);
  }

  const sample::Candidates& copies;
  cv::Rect box;
  cv::Mat1i index;    ///< of hole.pixels, or -1
  cv::Mat1f depth;    ///< as FilledFrame::depth
  cv::Mat1b classes;  ///< SurfaceClass

  std::size_t size() const { return copies.leading.size(); }
  cv::Point pixel(std::size_t i) const { return copies.hole.pixels[i] - box.tl(); }
  bool unobserved(cv::Point p) const { return index(p) >= 0 && !copies.leading[index(p)].found(); }
  bool unobserved_sky(cv::Point p) const { return depth(p) == depth::DepthMap::kInfinity && unobserved(p); }
  SurfaceClass class_of(cv::Point p) const { return static_cast<SurfaceClass>(classes(p)); }
};

cv::Mat1b roles_of(const Window& window, Role copied, Role unseen) {
  cv::Mat1b roles(window.box.size(), static_cast<uchar>(Role::fixed));
  for (std::size_t i = 0; i < window.size(); ++i)
    roles(window.pixel(i)) = static_cast<uchar>(window.copies.leading[i].found() ? copied : unseen);
  return roles;
}

/// The colors of what is fixed beside unobserved sky and may be sky: within three sigmas of their median. Depth alone does not
/// tell it from a roof above the LiDAR's uppermost beam. Where that is no sky but as far, such as woods, they vary, and all
/// are.
ColorRange sky_colors(const Window& window, const cv::Mat1b& roles, const cv::Mat3f& color) {
  constexpr float kSigmas = 3, kPixelNoise = 2.5F;  // gray levels
  std::array<std::vector<float>, 3> beside;
  for (std::size_t i = 0; i < window.size(); ++i) {
    if (!window.unobserved_sky(window.pixel(i))) continue;
    for (const cv::Point q : around(window.pixel(i))) {
      if (!inside(roles, q) || roles(q) != static_cast<uchar>(Role::fixed) || depth::DepthMap::is_solid(window.depth(q)))
        continue;
      for (int c = 0; c < 3; ++c) beside[c].push_back(color(q)[c]);
    }
  }
  ColorRange out;
  if (beside[0].empty()) return out;
  for (int c = 0; c < 3; ++c) {
    const float middle = median(beside[c]);
    for (float& value : beside[c]) value = std::abs(value - middle);
    const float reach = kSigmas * (1.4826F * median(std::move(beside[c])) + kPixelNoise);
    out.low[c] = middle - reach;
    out.high[c] = middle + reach;
  }
  return out;
}

/// A connected part of what is to be solved.
struct Part {
  bool bounded = false;  ///< something fixed lies beside it
  bool copied = false;   ///< some of it has a source
};

std::vector<Part> parts_of(const Window& window, const cv::Mat1b& roles, cv::Mat1i& labels) {
  const int count = label_connected_parts(where(roles, Role::solved), labels);
  std::vector<Part> parts(count + 1);
  for (std::size_t i = 0; i < window.size(); ++i) {
    const cv::Point p = window.pixel(i);
    Part& part = parts[labels(p)];
    part.copied |= window.copies.leading[i].found();
    for (const cv::Point q : around(p)) part.bounded |= inside(roles, q) && roles(q) == static_cast<uchar>(Role::fixed);
  }
  return parts;
}

struct Guidance {
  bool seams = true;   ///< between pixels of different sources: the gradient these show
  float vertical = 1;  ///< weight of vertical neighbors against horizontal ones
  cv::Mat1f below{};   ///< the same by pixel, of the neighbor below; empty: everywhere `vertical`

  float weight(cv::Point p, cv::Point q) const {
    if (p.y == q.y) return 1;
    return below.empty() ? vertical : below(p.y < q.y ? p : q);
  }
};

/// Eq. 5 for the pixels to be solved. `color` holds the fixed ones.
class Equation {
 public:
  Equation(const Window& window, const Copies& copies, const cv::Mat1b& roles, const cv::Mat3f& color, const Guidance& guidance)
      : window_(window),
        copies_(copies),
        roles_(roles),
        color_(color),
        guidance_(guidance),
        sky_(sky_colors(window, roles, color)) {}

  PoissonSystem system(const cv::Mat1i& labels, const std::vector<Part>& parts) const {
    // A part that nothing bounds is held near its copies, too weakly to be seen in its gradients.
    constexpr float kAnchor = 1e-4F;
    // Sky, ground and what stands upright do not go on in each other. Not 0: one may have no other neighbor.
    constexpr float kSilhouette = 1e-3F;
    PoissonSystem out{Region(where(roles_, Role::solved)), {}, {}, guidance_.vertical};
    if (guidance_.seams || !guidance_.below.empty()) weigh(out);
    out.diagonal.reserve(out.region.size());
    out.right.reserve(out.region.size());
    for (const cv::Point p : out.region.pixels) {
      const int i = window_.index(p);
      const bool copied = window_.copies.leading[i].found();
      float diagonal = 0;
      cv::Vec3f right = copied ? copies_.outward[i] : cv::Vec3f();
      for (const cv::Point q : around(p)) {
        if (!inside(roles_, q) || roles_(q) == static_cast<uchar>(Role::absent)) continue;
        const float weight = coupling(p, q) * (silhouette(p, q) ? kSilhouette : 1);
        diagonal += weight;
        right += weight * pull(i, q);
      }
      if (const float held = std::max(copies_.hold.weight[i], parts[labels(p)].bounded ? 0 : kAnchor); copied && held > 0) {
        diagonal += held;
        right += held * copies_.hold.color[i];
      }
      out.diagonal.push_back(diagonal);
      out.right.push_back(right);
    }
    return out;
  }

 private:
  /// Whether p, without a source, and its neighbor, which is fixed, are of different classes or only one of them is sky.
  bool silhouette(cv::Point p, cv::Point q) const {
    if (roles_(q) != static_cast<uchar>(Role::fixed) || !window_.unobserved(p)) return false;
    if (!window_.unobserved_sky(p)) return window_.unobserved_sky(q) || differ(window_.class_of(p), window_.class_of(q));
    return depth::DepthMap::is_solid(window_.depth(q)) || sky_.clamp(color_(q)) != color_(q);
  }

  /// What a neighbor adds to the right side: its color where it is fixed, the gradient of the copies within one source.
  cv::Vec3f pull(int i, cv::Point q) const {
    cv::Vec3f out;
    if (roles_(q) == static_cast<uchar>(Role::fixed)) out += color_(q);
    const int j = window_.index(q);
    const std::vector<sample::Candidate>& of = window_.copies.leading;
    if (j < 0 || !of[i].found() || !of[j].found()) return out;
    if (of[j].view == of[i].view) return out + copies_.color[i] - copies_.color[j];
    if (!guidance_.seams) return out;
    const cv::Point p = window_.pixel(i);
    return is_first(p, q) ? out + seam(p, q).step : out - seam(q, p).step;
  }

  static bool is_first(cv::Point p, cv::Point q) { return p.x < q.x || p.y < q.y; }
  const Seam& seam(cv::Point first, cv::Point second) const {
    return copies_.seams[window_.index(first)][first.y == second.y ? 0 : 1];
  }

  /// Of the equation between two neighbors.
  float coupling(cv::Point p, cv::Point q) const {
    const float smooth = guidance_.weight(p, q);
    if (!guidance_.seams || window_.index(p) < 0 || window_.index(q) < 0) return smooth;
    return smooth * (is_first(p, q) ? seam(p, q) : seam(q, p)).weight();
  }

  void weigh(PoissonSystem& system) const {
    for (const cv::Point p : system.region.pixels)
      for (const cv::Point q : {p + cv::Point(1, 0), p + cv::Point(0, 1)})
        (p.y == q.y ? system.beside : system.below).push_back(inside(roles_, q) ? coupling(p, q) : 0);
  }

  const Window& window_;
  const Copies& copies_;
  const cv::Mat1b& roles_;
  const cv::Mat3f& color_;
  Guidance guidance_;
  ColorRange sky_;
};

/// Fills the solved pixels of the window's `color`. Those of which nothing could be told become absent.
void fill(const Window& window, const Copies& copies, cv::Mat1b& roles, const Guidance& guidance, cv::Mat3f& color) {
  if (window.size() == 0) return;
  cv::Mat1i labels;
  const std::vector<Part> parts = parts_of(window, roles, labels);
  for (std::size_t i = 0; i < window.size(); ++i) {
    const cv::Point p = window.pixel(i);
    if (labels(p) > 0 && !parts[labels(p)].bounded && !parts[labels(p)].copied) roles(p) = static_cast<uchar>(Role::absent);
  }
  const PoissonSystem system = Equation(window, copies, roles, color, guidance).system(labels, parts);
  std::vector<cv::Vec3f> x;
  x.reserve(system.region.size());
  for (const cv::Point p : system.region.pixels) x.push_back(copies.color[window.index(p)]);
  solve_poisson(system, x);
  for (std::size_t k = 0; k < x.size(); ++k)
    for (int c = 0; c < 3; ++c) color(system.region.pixels[k])[c] = std::clamp(x[k][c], 0.0F, 255.0F);
}

/// How smooth the ground is along columns, against rows: a membrane that lies on it. A pixel is (distance / height of the
/// camera) times as long as it is wide, and a membrane's weights go with the square of that.
cv::Mat1f smoothness_of_ground(const Window& window, const View& view) {
  constexpr double kAlong = 4;     // along the road colors change half as fast as across it
  constexpr double kLeast = 0.01;  // near the horizon, where the ground may rise
  const Eigen::Matrix3d world_from_camera = view.camera_from_world.R.transpose();
  cv::Mat1f out(window.box.size(), 1.0F);
  for (std::size_t i = 0; i < window.size(); ++i) {
    const cv::Point p = window.pixel(i), in_image = p + window.box.tl();
    if (window.class_of(p) != SurfaceClass::ground) continue;
    const double descent = (world_from_camera * view.camera.ray(Eigen::Vector2d(in_image.x, in_image.y))).z();
    out(p) = static_cast<float>(std::clamp(kAlong * descent * descent, kLeast, 1.0));
  }
  return out;
}

/// Fills what has no source from what has: the sky, the ground, then what stands before them. Tells what was filled.
cv::Mat1b interpolate(const Window& window, const Copies& copies, const View& view, const HarmonizeOptions& options,
                      cv::Mat3f& color) {
  if (window.size() == 0) return {};
  const Guidance plain{false, static_cast<float>(options.unobserved_vertical)};  // no source, no seam
  Guidance level = plain;
  level.below = smoothness_of_ground(window, view);
  cv::Mat1b filled(window.box.size(), uchar{0});
  const auto fill_where = [&](const auto& wanted, const Guidance& guidance) {
    cv::Mat1b roles = roles_of(window, Role::fixed, Role::absent);
    roles.setTo(static_cast<uchar>(Role::fixed), filled);
    for (std::size_t i = 0; i < window.size(); ++i)
      if (const cv::Point p = window.pixel(i); window.unobserved(p) && filled(p) == 0 && wanted(p))
        roles(p) = static_cast<uchar>(Role::solved);
    fill(window, copies, roles, guidance, color);
    filled |= where(roles, Role::solved);
  };
  fill_where([&](cv::Point p) { return window.unobserved_sky(p); }, plain);
  fill_where([&](cv::Point p) { return window.class_of(p) == SurfaceClass::ground; }, level);
  fill_where([](cv::Point) { return true; }, plain);
  cv::Mat1b roles = roles_of(window, Role::fixed, Role::absent);
  roles.setTo(static_cast<uchar>(Role::solved), filled);
  return roles;
}

std::uint16_t sixteenths(float position) { return static_cast<std::uint16_t>(std::lround(position * kSubpixel)); }

void write_provenance(const depth::Target& target, const Fused& fused, FilledFrame& out) {
  const sample::Candidates& candidates = fused.candidates;
  for (std::size_t i = 0; i < candidates.leading.size(); ++i) {
    const sample::Candidate& source = candidates.leading[i];
    if (!source.found()) continue;
    const bool here = target.views[source.view].sequence == target.view().sequence;
    out.kind(candidates.hole.pixels[i]) = static_cast<uchar>(here ? Kind::copied : Kind::copied_elsewhere);
    out.provenance(candidates.hole.pixels[i]) = {static_cast<std::uint16_t>(source.view + 1), sixteenths(source.position.x),
                                                 sixteenths(source.position.y)};
    out.used(candidates.hole.pixels[i]) = {source.footprint[1], source.footprint[0], fused.sources[i]};
  }
}

/// Of the window's pixels without a source to what is known. Nothing beyond the window is nearer than its border.
cv::Mat1f distance_to_known(const cv::Mat1b& kind) {
  if (kind.empty()) return {};
  cv::Mat1b guessed = where(kind, Kind::interpolated);
  guessed.setTo(255, where(kind, Kind::empty));
  cv::Mat1f distance;
  cv::distanceTransform(guessed, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  return distance;
}

void write_confidence(const depth::Target& target, const Fused& fused, const Window& window, const ErrorScale& scale,
                      FilledFrame& out) {
  const cv::Mat1f distance = distance_to_known(out.kind(window.box));
  for (std::size_t i = 0; i < fused.color.size(); ++i) {
    const cv::Point p = fused.candidates.hole.pixels[i];
    double sure = 0;
    if (fused.candidates.leading[i].found()) {
      const double change = mean_difference(out.color(p), fused.color[i]);
      const double expected = expected_error(evidence_of(target, fused, i, {out.color, change}));
      sure = copied_confidence(scale.at(expected) * expected);
    } else if (out.kind(p) == static_cast<uchar>(Kind::interpolated)) {
      sure = interpolated_confidence(distance(window.pixel(i)));
    }
    out.confidence(p) = static_cast<uchar>(std::lround(255 * sure));
  }
}

}  // namespace

FilledFrame harmonize(const depth::Target& target, const sample::Candidates& sampled, const HarmonizeInput& input,
                      const HarmonizeOptions& options) {
  const Fused fused = fuse(target, sampled, input.light);
  const sample::Candidates& candidates = fused.candidates;
  const Region& hole = candidates.hole;
  const cv::Size size = hole.index.size();
  FilledFrame out;
  target.image()->convertTo(out.color, CV_32FC3);
  out.mask = hole.index >= 0;
  out.kind = cv::Mat1b(size, static_cast<uchar>(Kind::original));
  out.provenance = cv::Mat_<cv::Vec3w>(size, cv::Vec3w());
  out.used = cv::Mat3b(size, cv::Vec3b());
  out.confidence = cv::Mat1b(size, uchar{255});
  out.depth = target.depth.z.clone();
  for (std::size_t i = 0; i < hole.size(); ++i)
    if (const cv::Point p = hole.pixels[i]; fused.sky(p) != 0 && !candidates.leading[i].found())
      out.depth(p) = depth::DepthMap::kInfinity;
  out.gain = target.view().gain;

  Copies copies = copy(target, fused, input.light);
  copies.hold = hold_of(copies, candidates, options.robust_rim);
  for (std::size_t i = 0; i < hole.size(); ++i) out.color(hole.pixels[i]) = copies.color[i];
  const Role copied = options.poisson ? Role::solved : Role::fixed;
  const Role unseen = options.unobserved == Unobserved::leave ? Role::absent : Role::solved;
  const Window window(fused, out.depth, input.classes);
  cv::Mat3f color = out.color(window.box);
  cv::Mat1b roles = roles_of(window, copied, options.unobserved_last ? Role::absent : unseen);
  fill(window, copies, roles, {options.seam_gradients, 1}, color);
  if (options.poisson && options.within_range)
    keep_within(range_round(*target.image(), out.mask), candidates, copies.color, out.color);
  if (options.unobserved_last && unseen == Role::solved) roles = interpolate(window, copies, target.view(), options, color);
  for (std::size_t i = 0; i < hole.size(); ++i) {
    const bool solved = roles(window.pixel(i)) == static_cast<uchar>(Role::solved);
    out.kind(hole.pixels[i]) = static_cast<uchar>(solved ? Kind::interpolated : Kind::empty);
  }
  write_provenance(target, fused, out);
  write_confidence(target, fused, window, ErrorScale(known_copies(target, input.known)), out);
  return out;
}

}  // namespace dvi::harmonize
