#include "dvi/objects/silhouettes.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/image/region.h"
#include "dvi/objects/comparison.h"
#include "dvi/objects/edges.h"
#include "dvi/objects/kept_masks.h"

namespace dvi::objects {
namespace {

constexpr double kRim = 0.25;   // of an outline's shorter side, each way: how far an object may go beyond it, or end within
constexpr int kLeastRim = 4;    // half pixels
constexpr int kFarther = 3;     // times the reach of edges, round an outline: what its background differs by, too
constexpr int kLeastPart = 20;  // half pixels: smaller ones are noise
constexpr int kLeastJudged = 10 * kLeastPart;  // half pixels of an outline that the images may refute
constexpr double kLeastTold = 0.75;            // of these, that others saw
constexpr double kLeastShown = 0.8;            // of these, that the view shows as they do: edges and leaves move
constexpr double kNotch = 0.125;  // of the shorter side: objects have no deeper ones, but look like their background by chance
constexpr std::size_t kColors = 64;  // of an object that are compared with its background
constexpr double kTelling = 0.75;    // of these, that the background must exclude
constexpr double kAlike = 25;        // levels between a pixel and one of these: it may be of the object
constexpr int kHalo = 2;             // half pixels that lens and motion smear an object over
constexpr int kThin = 3;             // likewise above the ground, with rails and mirrors too thin to tell

// As grown(), but at the same cost for any radius.
cv::Mat1b far_grown(const cv::Mat1b& mask, int radius) {
  cv::Mat1f distance;
  if (radius < 0) {
    cv::distanceTransform(mask, distance, cv::DIST_L2, cv::DIST_MASK_5);
    return cv::Mat1b(distance > -radius);
  }
  cv::distanceTransform(cv::Mat1b(mask == 0), distance, cv::DIST_L2, cv::DIST_MASK_5);
  return cv::Mat1b(distance <= radius);
}

class Silhouettes {
 public:
  Silhouettes(Comparison comparison, Lazy<cv::Mat1b> outlines)
      : comparison_(std::move(comparison)), outlines_(std::move(outlines)) {}

  cv::Mat1b operator()(std::size_t target) const {
    const cv::Mat1b outline = *outlines_[target];
    if (cv::countNonZero(outline) == 0) return outline;
    cv::Mat1b half;
    cv::resize(outline, half, {outline.cols / kScale, outline.rows / kScale}, 0, 0, cv::INTER_AREA);
    half = cv::Mat1b(half > 0);
    const ImageDifference evidence = compare(target, half);
    const cv::Mat1b object = joined(half, evidence);
    // What is only not told from the background ends with the outline; what differs has a margin everywhere.
    const cv::Mat1b end = ended(half, object, evidence);
    cv::Mat1b within, beyond;
    cv::resize(cv::Mat1b(grown(end, kHalo) | (grown(end, kThin) & ~evidence.ground)), within, outline.size(), 0, 0,
               cv::INTER_NEAREST);
    const cv::Mat1b different(opened(object) & evidence.differs & (end | ~half));
    cv::resize(grown(different, kHalo), beyond, outline.size(), 0, 0, cv::INTER_NEAREST);
    return with_missing_edges(target, cv::Mat1b((within & outline) | beyond), evidence);
  }

 private:
  static int rim_of(const cv::Rect& part, int least = kLeastRim) {
    return std::max(least, cvRound(kRim * std::min(part.width, part.height)));
  }

  // What is within the rim of an outline, or of the narrower one that it joins: a walker beside a car.
  static cv::Mat1b middle(const cv::Mat1b& outline, int least_rim = kLeastRim) {
    const int rim = rim_of(cv::boundingRect(outline), least_rim);
    cv::Mat1b out = far_grown(outline, -rim);
    if (cv::countNonZero(out) == 0) return out;
    cv::Mat1i parts;
    const int count = label_connected_parts(cv::Mat1b(outline & ~far_grown(out, rim)), parts);
    for (int i = 1; i <= count; ++i)
      if (const cv::Mat1b part(parts == i); cv::countNonZero(part) >= kLeastPart) out |= middle(part, kLeastRim / 2);
    return out;
  }

  // A mask of full size with the edges of objects that it lacks.
  cv::Mat1b with_missing_edges(std::size_t target, const cv::Mat1b& mask, const ImageDifference& evidence) const {
    cv::Mat1b half, full;
    cv::resize(mask, half, evidence.differs.size(), 0, 0, cv::INTER_AREA);
    half = cv::Mat1b(half == 255);
    cv::resize(cv::Mat1b(with_edges(half, evidence.usual, comparison_.half(target)->image, edge_reach(half.size())) & ~half),
               full, mask.size(), 0, 0, cv::INTER_NEAREST);
    return cv::Mat1b(mask | full);
  }

  ImageDifference compare(std::size_t target, const cv::Mat1b& outline) const {
    cv::Mat1b band(outline.size(), uchar{0});
    for (const cv::Rect& part : find_part_boxes(outline)) {
      const int reach = std::max(rim_of(part), kFarther * edge_reach(outline.size()));
      const cv::Rect box(part.x - reach, part.y - reach, part.width + 2 * reach, part.height + 2 * reach);
      band(box & cv::Rect({}, band.size())) = 255;
    }
    ImageDifference out = comparison_.compare(target, band);
    const auto half = comparison_.half(target);
    for (const cv::Rect& part : find_part_boxes(outline)) tell(part, outline, half->image, out);
    return out;
  }

  // Where an object would hardly differ from its background, nothing is told of pixels in the object's colors.
  static void tell(const cv::Rect& part, const cv::Mat1b& outline, const Patch& image, ImageDifference& evidence) {
    std::vector<cv::Vec3f> colors;
    for (int y = part.y; y < part.br().y; ++y)
      for (int x = part.x; x < part.br().x; ++x)
        if (outline(y, x) != 0 && evidence.differs(y, x) != 0) colors.push_back(image(y, x));
    const std::size_t every = colors.size() / kColors + 1;
    for (int y = part.y; y < part.br().y; ++y)
      for (int x = part.x; x < part.br().x; ++x) {
        if (outline(y, x) == 0 || evidence.differs(y, x) != 0 || evidence.untold(y, x) != 0) continue;
        std::size_t asked = 0, excluded = 0;
        bool alike = false;
        for (std::size_t i = 0; i < colors.size(); i += every, ++asked) {
          excluded += evidence.usual.excludes({x, y}, colors[i]);
          alike = alike || cv::norm(colors[i] - image(y, x), cv::NORM_INF) < kAlike;
        }
        if (alike && static_cast<double>(excluded) < kTelling * static_cast<double>(asked)) evidence.untold(y, x) = 255;
      }
  }

  static cv::Mat1b ended(const cv::Mat1b& outline, const cv::Mat1b& object, const ImageDifference& evidence) {
    cv::Mat1b out(outline.size(), uchar{0});
    cv::Mat1i parts;
    const int count = label_connected_parts(cv::Mat1b(outline | object), parts);
    for (int i = 1; i <= count; ++i) {
      const cv::Mat1b part(parts == i), whole(outline & part), own(object & part);
      if (cv::countNonZero(own & evidence.differs) < kLeastPart) {
        if (!refuted(whole, evidence)) out |= whole;
        continue;
      }
      const cv::Rect box = cv::boundingRect(part);
      cv::Mat1b seed = middle(whole);
      if (cv::countNonZero(seed) == 0) seed = whole;
      const int notch = std::max(kLeastRim - 1, cvRound(kNotch * std::min(box.width, box.height)));
      out |= touching(seed, cv::Mat1b(far_grown(far_grown(cv::Mat1b(own | seed), notch), -notch) & part));
    }
    return out;
  }

  // Whether others saw what an outline should hide, and the view shows the same: errors of a LiDAR move along with it, but show
  // in no image. In small outlines there is too little to tell.
  static bool refuted(const cv::Mat1b& outline, const ImageDifference& evidence) {
    const int pixels = cv::countNonZero(outline), told = cv::countNonZero(outline & ~evidence.untold);
    return pixels >= kLeastJudged && told > kLeastTold * pixels &&
           cv::countNonZero(outline & evidence.shown) > kLeastShown * told;
  }

  // The parts of a mask that overlap another one and are no specks.
  static cv::Mat1b touching(const cv::Mat1b& other, const cv::Mat1b& mask) {
    cv::Mat1i parts;
    const std::size_t count = static_cast<std::size_t>(label_connected_parts(mask, parts)) + 1;
    std::vector<int> pixels(count, 0);
    std::vector<bool> touches(count, false);
    for (int y = 0; y < parts.rows; ++y)
      for (int x = 0; x < parts.cols; ++x) {
        const auto part = static_cast<std::size_t>(parts(y, x));
        ++pixels[part];
        if (other(y, x) != 0) touches[part] = true;
      }
    cv::Mat1b out(mask.size(), uchar{0});
    for (int y = 0; y < parts.rows; ++y)
      for (int x = 0; x < parts.cols; ++x)
        if (const auto part = static_cast<std::size_t>(parts(y, x)); part != 0 && touches[part] && pixels[part] >= kLeastPart)
          out(y, x) = 255;
    return out;
  }

  // What differs, or nobody else saw, and hangs together with the outline; beyond it nothing thin.
  static cv::Mat1b joined(const cv::Mat1b& outline, const ImageDifference& evidence) {
    const cv::Mat1b within(outline & evidence.untold);
    const cv::Mat1b out = touching(outline, cv::Mat1b(evidence.differs | within));
    return cv::Mat1b((out & outline) | (opened(out) & ~outline));
  }

  // Without what is thin, as edges that are displaced; thin strips of what hangs together with something thick stay.
  static cv::Mat1b opened(const cv::Mat1b& mask) { return grown(grown(mask, -1), 1); }

  Comparison comparison_;
  Lazy<cv::Mat1b> outlines_;
};

}  // namespace

Lazy<cv::Mat1b> silhouettes(const Views& views, const Lazy<cv::Mat1f>& standing,
                            const std::shared_ptr<const ground::ScanGround>& ground) {
  const auto pass = [&](const Views& hidden) {
    const auto found = std::make_shared<const Silhouettes>(Comparison(hidden, standing, ground), views.masks);
    return kept_masks(views.size(), [found](std::size_t i) { return (*found)(i); });
  };
  // Generous outlines hide each other's background: once more with those that were found.
  Views narrower = views;
  narrower.masks = pass(views);
  return pass(narrower);
}

}  // namespace dvi::objects
