#include "dvi/traffic/silhouettes.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/image/region.h"
#include "dvi/traffic/kept_masks.h"
#include "dvi/traffic/other_times.h"

namespace dvi::traffic {
namespace {

// Seconds, both ways. The nearest show the background least displaced, the later ones after the object has left it.
constexpr std::array kTimes{0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0};
constexpr int kDisplaced = 3;     // half pixels across: what poses and depth are wrong by, each way one
constexpr double kRim = 0.25;     // of an outline's shorter side, each way: how far an object may go beyond it, or end within
constexpr int kLeastRim = 4;      // half pixels
constexpr int kLeastPart = 20;    // half pixels: smaller ones are noise
constexpr double kNotch = 0.125;  // of the shorter side: objects have no deeper ones, but look like their background by chance
constexpr int kHalo = 2;          // half pixels that lens and motion smear an object over
constexpr int kLightGrid = 12;    // half pixels between the places at which light is compared
constexpr double kEndless = 1e4;  // metres: of what no scan reached

// What a comparison says of the pixels of half a view.
struct Evidence {
  cv::Mat1b differs;  // from what others show there
  cv::Mat1b unseen;   // by others
};

class Silhouettes {
 public:
  /// The masks of `views` say where their backgrounds are hidden.
  Silhouettes(const Views& views, Lazy<cv::Mat1b> outlines, Lazy<cv::Mat1f> standing, std::shared_ptr<const Ground> ground)
      : others_(views), outlines_(std::move(outlines)), standing_(std::move(standing)), ground_(std::move(ground)) {}

  cv::Mat1b operator()(std::size_t target) const {
    const cv::Mat1b outline = *outlines_[target];
    if (cv::countNonZero(outline) == 0) return outline;
    cv::Mat1b half;
    cv::resize(outline, half, {outline.cols / kScale, outline.rows / kScale}, 0, 0, cv::INTER_AREA);
    half = cv::Mat1b(half > 0);
    const cv::Mat1b found = ended(half, compare(target, half));
    // What lies within the outline ends with it: its rim has been widened enough.
    cv::Mat1b full, beyond;
    cv::resize(found, full, outline.size(), 0, 0, cv::INTER_NEAREST);
    cv::resize(cv::Mat1b(grown(cv::Mat1b(found & ~grown(half, 1)), 2)), beyond, outline.size(), 0, 0, cv::INTER_NEAREST);
    return cv::Mat1b(full & (outline | beyond));
  }

 private:
  static int rim_of(const cv::Rect& part) { return std::max(kLeastRim, cvRound(kRim * std::min(part.width, part.height))); }

  Evidence compare(std::size_t target, const cv::Mat1b& outline) const {
    cv::Mat1b band(outline.size(), uchar{0});
    for (const cv::Rect& part : part_boxes(outline)) {
      const int reach = rim_of(part);
      const cv::Rect box(part.x - reach, part.y - reach, part.width + 2 * reach, part.height + 2 * reach);
      band(box & cv::Rect({}, band.size())) = 255;
    }
    const auto half = others_.half(target);
    const std::vector<Place> places = places_of(target, band, 1);
    const auto seen = others_.colours(target, kTimes, places, places_of(target, cv::Mat1b(half->mask == 0), kLightGrid));
    const Usual usual(places, seen, band.size(), kDisplaced);
    Evidence out{cv::Mat1b(band.size(), uchar{0}), cv::Mat1b(band.size(), uchar{0})};
    for (std::size_t i = 0; i < places.size(); ++i)
      if (seen[i].size() < kFewestViews)
        out.unseen(places[i].at) = 255;
      else if (usual.excludes(places[i].at, half->image(places[i].at)))
        out.differs(places[i].at) = 255;
    cv::medianBlur(out.differs, out.differs, 3);
    return out;
  }

  // Pixels with what stands there: the nearer of the ground and what rises from it, or else something endlessly far.
  std::vector<Place> places_of(std::size_t target, const cv::Mat1b& where, int every) const {
    std::vector<Place> out;
    const View& view = others_.views()[target];
    const SE3 world_from_camera = view.camera_from_world.inverse();
    const auto standing = standing_[target];
    for (int y = 0; y < where.rows; y += every)
      for (int x = 0; x < where.cols; x += every) {
        if (where(y, x) == 0) continue;
        const auto ground = on_ground(view, world_from_camera, *ground_, {x, y});
        const double z = (*standing)(y, x) > 0 ? static_cast<double>((*standing)(y, x)) : kEndless;
        const bool on_it = ground && (view.camera_from_world * *ground).z() < z;
        out.push_back({{x, y}, on_it ? *ground : world_from_camera * Eigen::Vector3d(z * view.camera.ray(full_size({x, y})))});
      }
    return out;
  }

  static cv::Mat1b ended(const cv::Mat1b& outline, const Evidence& evidence) {
    const cv::Mat1b object = joined(outline, evidence);
    cv::Mat1b out(outline.size(), uchar{0});
    cv::Mat1i parts;
    const int count = connected_parts(cv::Mat1b(outline | object), parts);
    for (int i = 1; i <= count; ++i) {
      const cv::Mat1b part(parts == i), whole(outline & part), own(object & part);
      if (cv::countNonZero(own & evidence.differs) < kLeastPart) {  // nothing to go by
        out |= whole;
        continue;
      }
      const cv::Rect box = cv::boundingRect(part);
      cv::Mat1b seed(grown(whole, -rim_of(box)));
      if (cv::countNonZero(seed) == 0) seed = whole;
      const int notch = std::max(kLeastRim - 1, cvRound(kNotch * std::min(box.width, box.height)));
      out |= touching(seed, cv::Mat1b(grown(grown(cv::Mat1b(own | seed), notch), -notch) & part));
    }
    return grown(out, kHalo);
  }

  // The parts of a mask that overlap another one and are no specks.
  static cv::Mat1b touching(const cv::Mat1b& other, const cv::Mat1b& mask) {
    cv::Mat1i parts;
    const std::size_t count = static_cast<std::size_t>(connected_parts(mask, parts)) + 1;
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

  // What differs, or nobody else saw, and hangs together with the outline; beyond it nothing thin, as edges that are displaced.
  static cv::Mat1b joined(const cv::Mat1b& outline, const Evidence& evidence) {
    const cv::Mat1b within(outline & evidence.unseen);
    const cv::Mat1b out = touching(outline, cv::Mat1b(evidence.differs | within));
    const cv::Mat1b beyond(grown(grown(cv::Mat1b(out & ~outline), -1), 1));
    return cv::Mat1b((out & outline) | beyond);
  }

  OtherTimes others_;
  Lazy<cv::Mat1b> outlines_;
  Lazy<cv::Mat1f> standing_;
  std::shared_ptr<const Ground> ground_;
};

}  // namespace

Lazy<cv::Mat1b> silhouettes(const Views& views, const Lazy<cv::Mat1f>& standing, const std::shared_ptr<const Ground>& ground) {
  const auto pass = [&](const Views& hidden) {
    const auto found = std::make_shared<const Silhouettes>(hidden, views.masks, standing, ground);
    return kept_masks(views.size(), [found](std::size_t i) { return (*found)(i); });
  };
  // Generous outlines hide each other's background: once more with those that were found.
  Views narrower = views;
  narrower.masks = pass(views);
  return std::getenv("ONE") ? narrower.masks : pass(narrower);
}

}  // namespace dvi::traffic
