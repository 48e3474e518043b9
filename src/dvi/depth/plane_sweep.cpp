#include "dvi/depth/plane_sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/depth/semi_global.h"
#include "dvi/depth/source_frames.h"
#include "dvi/image/interpolate.h"
#include "dvi/image/region.h"

namespace dvi::depth {
namespace {

constexpr int kMargin = 12;  // px round a hole, where the target itself shows what is there
constexpr int kTile = 256;   // px; larger holes are swept piece by piece, which bounds the memory
constexpr int kMaxLabels = 64;
constexpr double kStep = 0.5;       // px of parallax from one label to the next, if there are labels enough
constexpr double kMostStep = 2;     // otherwise; what is nearer is not looked for
constexpr double kNearest = 10;     // meters of a surface in a column without any return
constexpr int kWindow = 5;          // px, over which costs are averaged
constexpr int kMostValues = 20;     // sources and the target
constexpr std::size_t kRays = 200;  // of a piece, by which its sources are chosen

// Costs are in units of the camera's noise.
constexpr float kNoise = 2;          // gray levels of contrast(), in daylight
constexpr float kCostMost = 8;       // views differ; by how much does not matter
constexpr float kAgree = 2;          // they may still show the same
constexpr float kTold = 0.5F;        // a depth that costs so much more than another is told from it
constexpr float kSignal = 3;         // texture, against noise and against what views differ by
constexpr float kSmallStep = 0.15F;  // of semi-global matching
constexpr float kLargeStep = 1.5F;
constexpr float kFar = 0.01F;  // a label: of equals the farthest is taken

/// A view that is compared, with what its image shows.
struct Source {
  const Camera* camera;
  SE3 source_from_target;
  std::shared_ptr<const cv::Mat1f> contrast;
  std::shared_ptr<const depth::VisibilityMap> visibility;

  /// What it shows of the point at `x` (its axes; depth z in it), if it does.
  bool shows(const Eigen::Vector3d& x, double z, float& value) const {
    if (!camera->in_front(x)) return false;
    const Eigen::Vector2d pixel = camera->project(x);
    if (!camera->contains(pixel)) return false;
    const cv::Point2f at(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
    if (visibility->masked(at) || visibility->hides(at, z, 0.05)) return false;
    value = bilinear(*contrast, at);
    return true;
  }
};

/// A box of the target's image, its hypotheses (label k: inverse depth k * step) and the views that tell between them.
struct Piece {
  cv::Rect box;
  cv::Mat1b member;  ///< of the box: pixels to find a depth for
  cv::Mat1f below;   ///< of the box: inverse depth of the surface below them; 0: none
  int labels = 0;
  double step = 0;
  std::vector<Source> sources;

  double inverse_depth(int label) const { return label == 0 ? 1 / depth::DepthMap::kInfinity : label * step; }
};

// An image without its light: the difference to the mean of the surroundings, over that mean.
cv::Mat1f contrast(const cv::Mat3b& image, const cv::Mat1b& mask) {
  constexpr int kSurroundings = 17;
  constexpr float kScale = 64, kDark = 16;
  cv::Mat1b gray;
  cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  cv::Mat1f known(image.size(), 1.0F), masked_gray, mean, weight;
  known.setTo(0, mask);
  gray.convertTo(masked_gray, CV_32F);
  masked_gray = masked_gray.mul(known);
  cv::boxFilter(masked_gray, mean, CV_32F, {kSurroundings, kSurroundings}, {-1, -1}, false);
  cv::boxFilter(known, weight, CV_32F, {kSurroundings, kSurroundings}, {-1, -1}, false);
  cv::Mat1f out(image.size(), 0.0F);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x)
      if (known(y, x) > 0) {
        const float m = mean(y, x) / weight(y, x);
        out(y, x) = kScale * (masked_gray(y, x) - m) / (m + kDark);
      }
  return out;
}

/// What the views that show a point say of it, in units of the noise.
struct Sight {
  int views = 0;
  float cost = 0;    ///< mean distance from the median, of four values without the farthest (a fifth of more): it may be hidden
  float signal = 0;  ///< length of the median
};

Sight look(const Piece& piece, const std::vector<Eigen::Vector3d>& directions, double w) {
  std::array<float, kMostValues> values{};
  Sight out;
  for (std::size_t s = 0; s < piece.sources.size(); ++s) {
    const Eigen::Vector3d at = directions[s] + w * piece.sources[s].source_from_target.t;
    if (piece.sources[s].shows(at, at.z() / w, values[out.views])) ++out.views;
  }
  const int n = out.views;
  if (n < 2) return out;
  std::sort(values.begin(), values.begin() + n);
  const float median = 0.5F * (values[(n - 1) / 2] + values[n / 2]);
  for (int i = 0; i < n; ++i) values[i] = std::min(std::abs(values[i] - median) / kNoise, kCostMost);
  std::sort(values.begin(), values.begin() + n);
  const int kept = n < 4 ? n : n - (n + 1) / 5;
  for (int i = 0; i < kept; ++i) out.cost += values[i] / static_cast<float>(kept - 1);
  out.signal = std::abs(median) / kNoise;
  return out;
}

std::vector<Eigen::Vector3d> directions(const Piece& piece, const Camera& target, cv::Point p) {
  const Eigen::Vector3d ray = target.ray({p.x, p.y});
  std::vector<Eigen::Vector3d> out;
  for (const Source& source : piece.sources) out.emplace_back(source.source_from_target.R * ray);
  return out;
}

/// Cost of each label at each pixel, and whether two views show it there (1; 0).
void compare(const Piece& piece, const Camera& target, cv::Mat& cost, cv::Mat& seen) {
  for (int y = 0; y < piece.box.height; ++y)
    for (int x = 0; x < piece.box.width; ++x) {
      if (piece.member(y, x) == 0) continue;
      const auto to = directions(piece, target, cv::Point(x, y) + piece.box.tl());
      for (int k = 0; k < piece.labels; ++k) {
        const Sight sight = look(piece, to, piece.inverse_depth(k));
        if (sight.views < 2) continue;
        cost.ptr<float>(y, x)[k] = sight.cost;
        seen.ptr<float>(y, x)[k] = 1;
      }
    }
}

/// Whether views show the pixel itself at this inverse depth, they agree on its surroundings, and these have, unless it is at
/// infinity, enough texture to tell that it is the same: what is plain agrees at any depth.
bool believable(const Piece& piece, const Camera& target, cv::Point p, double w) {
  if (look(piece, directions(piece, target, p), w).views < 2) return false;
  float signal = 0, cost = 0, count = 0;
  for (int y = -kWindow / 2; y <= kWindow / 2; ++y)
    for (int x = -kWindow / 2; x <= kWindow / 2; ++x) {
      const Sight sight = look(piece, directions(piece, target, p + cv::Point(x, y)), w);
      if (sight.views < 2) continue;
      signal += sight.signal;
      cost += sight.cost;
      ++count;
    }
  return cost <= kAgree * count && (w == piece.inverse_depth(0) || signal > kSignal * std::max(cost, count));
}

// Means over the window's seen pixels. What is not seen may well be true: it costs what the other labels do on average, so
// that it loses to one that fits better than they do, and only to that.
void aggregate(const Piece& piece, cv::Mat& cost, cv::Mat& seen) {
  for (cv::Mat* m : {&cost, &seen}) cv::boxFilter(*m, *m, CV_32F, {kWindow, kWindow}, {-1, -1}, false, cv::BORDER_CONSTANT);
  for (int y = 0; y < cost.rows; ++y)
    for (int x = 0; x < cost.cols; ++x) {
      float *c = cost.ptr<float>(y, x), *s = seen.ptr<float>(y, x);
      float sum = 0;
      int count = 0;
      for (int k = 0; k < piece.labels; ++k) {
        s[k] = s[k] > kWindow * kWindow / 3.0F ? 1 / s[k] : 0;
        c[k] *= s[k];
        sum += c[k];
        count += s[k] > 0 ? 1 : 0;
      }
      const float average = sum / static_cast<float>(std::max(count, 1));
      for (int k = 0; k < piece.labels; ++k) {
        if (s[k] == 0) c[k] = average;
        c[k] += kFar * static_cast<float>(k);
      }
    }
}

// Where the surface below goes on upwards, as facades do beyond the LiDAR's uppermost beam: the views agree there on its depth,
// and on no other one better. What is plain agrees at any depth: it belongs to the surface if some texture above it does, which
// is seen not to be at infinity.
cv::Mat1b upright(const Piece& piece, const Camera& target, const cv::Mat& costs) {
  cv::Mat1f cost(piece.box.size(), 0.0F), signal = cost.clone(), shown = cost.clone();
  for (int y = 0; y < piece.box.height; ++y)
    for (int x = 0; x < piece.box.width; ++x) {
      if (piece.below(y, x) == 0) continue;
      const Sight sight = look(piece, directions(piece, target, cv::Point(x, y) + piece.box.tl()), piece.below(y, x));
      if (sight.views < 2) continue;
      cost(y, x) = sight.cost;
      signal(y, x) = sight.signal;
      shown(y, x) = 1;
    }
  const cv::Mat1f itself = shown.clone();
  for (cv::Mat1f* m : {&cost, &signal, &shown})
    cv::boxFilter(*m, *m, CV_32F, {kWindow, kWindow}, {-1, -1}, false, cv::BORDER_CONSTANT);
  cv::Mat1b out(piece.box.size(), uchar{0});
  for (int x = 0; x < piece.box.width; ++x) {
    bool textured = false;
    for (int y = 0; y < piece.box.height; ++y) {
      if (y > 0 && piece.below(y, x) != piece.below(y - 1, x)) textured = false;
      if (itself(y, x) == 0 || cost(y, x) > kAgree * shown(y, x)) continue;
      const float here = cost(y, x) / shown(y, x), *others = costs.ptr<float>(y, x);
      if (here > *std::min_element(others, others + piece.labels) + kTold) continue;
      textured |= signal(y, x) > kSignal * std::max(cost(y, x), shown(y, x)) && others[0] > here + kTold;
      out(y, x) = textured ? 255 : 0;
    }
  }
  return out;
}

// The labels that win, where they may be believed, as depth. Another may fit as well: it would copy what looks the same.
void decide(const Piece& piece, const Camera& target, const cv::Mat& cost, const cv::Mat& seen, depth::DepthMap& out) {
  const cv::Mat1b goes_on = upright(piece, target, cost);
  const cv::Mat sum = semi_global(cost, piece.member, kSmallStep, kLargeStep);
  for (int y = 0; y < piece.box.height; ++y)
    for (int x = 0; x < piece.box.width; ++x) {
      const cv::Point p = cv::Point(x, y) + piece.box.tl();
      if (piece.member(y, x) == 0) continue;
      const float* s = sum.ptr<float>(y, x);
      const auto k = static_cast<int>(std::min_element(s, s + piece.labels) - s);
      if (goes_on(y, x) != 0 && seen.ptr<float>(y, x)[0] != 0) {
        const float w = piece.below(y, x);
        out.z(p) = 1 / w;
        out.sigma(p) = static_cast<float>(0.5 * piece.step) / (w * w);
        continue;
      }
      // Unless seen at infinity, it may as well be too far to be seen at all.
      if (seen.ptr<float>(y, x)[0] == 0 || seen.ptr<float>(y, x)[k] == 0) continue;
      double w = piece.inverse_depth(k);
      if (k > 0 && k + 1 < piece.labels) {
        const double bend = s[k - 1] - 2.0 * s[k] + s[k + 1];
        if (bend > 0) w += 0.5 * piece.step * (s[k - 1] - s[k + 1]) / bend;
      }
      if (!believable(piece, target, p, w)) continue;
      out.z(p) = k == 0 ? depth::DepthMap::kInfinity : static_cast<float>(1 / w);
      out.sigma(p) = k == 0 ? 0 : static_cast<float>(0.5 * piece.step / (w * w));
    }
}

// The pixels without depth that lie above a surface, or are sky; the inverse depth of the nearest surface below them.
double find_members(const depth::DepthMap& depth, Piece& piece) {
  piece.member = cv::Mat1b(piece.box.size(), uchar{0});
  piece.below = cv::Mat1f(piece.box.size(), 0.0F);
  double nearest = 0;
  for (int x = piece.box.x; x < piece.box.br().x; ++x) {
    double w = 0;
    for (int y = depth.z.rows - 1; y >= piece.box.y; --y) {
      const float z = depth.z(y, x);
      if (depth::DepthMap::is_surface(z)) {
        w = 1 / z;
      } else if (y < piece.box.br().y && (w > 0 || z == depth::DepthMap::kSky)) {
        piece.member(cv::Point(x, y) - piece.box.tl()) = 255;
        piece.below(cv::Point(x, y) - piece.box.tl()) = static_cast<float>(w);
        nearest = std::max(nearest, w > 0 ? w : 1 / kNearest);
      }
    }
  }
  return nearest;
}

// px by which a pixel's picture moves in a source for each 1/m of inverse depth, from infinity on.
double parallax(const Source& source, const Eigen::Vector3d& ray) {
  const Eigen::Vector3d x = source.source_from_target.R * ray;
  const Eigen::Vector3d& t = source.source_from_target.t;
  if (x.z() <= 0) return 0;
  return std::hypot(source.camera->fx * (t.x() * x.z() - x.x() * t.z()), source.camera->fy * (t.y() * x.z() - x.y() * t.z())) /
         (x.z() * x.z());
}

// The boxes of the hole's parts, with a margin, large ones cut.
std::vector<cv::Rect> boxes(const cv::Mat1b& hole) {
  std::vector<cv::Rect> out;
  for (const cv::Rect& part : find_part_boxes(hole)) {
    const cv::Point end = part.br();
    for (int y = part.y; y < end.y; y += kTile)
      for (int x = part.x; x < end.x; x += kTile)
        out.push_back(cv::Rect(cv::Point(x - kMargin, y - kMargin),
                               cv::Point(std::min(x + kTile, end.x) + kMargin, std::min(y + kTile, end.y) + kMargin)) &
                      cv::Rect({}, hole.size()));
  }
  return out;
}

}  // namespace

DepthMap plane_sweep(const Target& target, const PlaneSweepOptions& options) {
  if (!options.enabled) return target.depth;
  const Views& views = target.views;
  DepthMap out{target.depth.z.clone(), target.depth.sigma.clone()};
  const cv::Mat1b hole = *target.mask();
  const Camera& camera = target.view().camera;
  std::map<std::size_t, std::shared_ptr<const cv::Mat1f>> contrasts;
  const auto source_of = [&](std::size_t view) {
    auto& image = contrasts[view];
    if (!image) image = std::make_shared<cv::Mat1f>(contrast(*views.images[view], *views.masks[view]));
    return Source{&views[view].camera, views[view].camera_from_world * target.view().camera_from_world.inverse(), image,
                  target.visibility[view]};
  };
  for (const cv::Rect& box : boxes(hole)) {
    Piece piece{box, {}, {}, 0, 0, {}};
    double nearest = find_members(target.depth, piece);
    std::vector<cv::Point> wanted;
    cv::findNonZero(hole(box) & piece.member, wanted);
    if (wanted.empty()) continue;
    std::vector<Eigen::Vector3d> rays;
    for (std::size_t i = 0; i < wanted.size(); i += wanted.size() / kRays + 1)
      rays.push_back(camera.ray({wanted[i].x + box.x, wanted[i].y + box.y}));
    for (const std::size_t view : choose_source_frames(target, {rays, nearest}, options.sources, options.max_frame_gap))
      piece.sources.push_back(source_of(view));
    if (piece.sources.empty()) continue;
    double most = 0;
    for (const Source& source : piece.sources)
      for (const Eigen::Vector3d& ray : rays) most = std::max(most, parallax(source, ray));
    if (most > 0) nearest = std::min(nearest, kMostStep * (kMaxLabels - 1) / most);
    piece.labels = std::clamp(cvCeil(most * nearest / kStep) + 1, 1, kMaxLabels);
    piece.step = nearest / std::max(1, piece.labels - 1);
    piece.sources.push_back(source_of(target.index));  // shows what is round the hole
    cv::Mat cost(box.size(), CV_32FC(piece.labels)), seen(box.size(), CV_32FC(piece.labels));
    for (cv::Mat* m : {&cost, &seen}) m->reshape(1).setTo(0);
    compare(piece, camera, cost, seen);
    aggregate(piece, cost, seen);
    decide(piece, camera, cost, seen, out);
  }
  return out;
}

}  // namespace dvi::depth
