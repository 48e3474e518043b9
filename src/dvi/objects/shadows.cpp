#include "dvi/objects/shadows.h"

#include <algorithm>
#include <array>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/image/region.h"
#include "dvi/objects/kept_masks.h"
#include "dvi/objects/other_times.h"

namespace dvi::objects {
namespace {

constexpr std::array kApart{0.3, 0.5, 0.7, 1.0, 1.3,
                            1.6, 2.0, 2.5, 3.0, 4.0};  // seconds, both ways: what moves has left the place
constexpr int kSmooth = 3;                             // half pixels across: shadows are large, and poses wrong by as much
constexpr double kCoarsest = 2;                        // times as far: a manhole is lost in the road from afar
constexpr int kMisplaced = 5;  // half pixels across: what poses and the ground are wrong by, each way two
constexpr int kTouch = 3;      // half pixels between an object's mask and its shadow
constexpr int kSpeck = 20;     // half pixels, of a part: smaller ones are noise
constexpr int kLight = 12;     // half pixels between the places at which light is compared

class Finder {
 public:
  Finder(const Views& views, std::shared_ptr<const ground::ScanGround> ground)
      : others_(views, kSmooth, kCoarsest), ground_(std::move(ground)) {}

  cv::Mat1b operator()(std::size_t target) const {
    const cv::Mat1b mask = *others_.views().masks[target];
    if (cv::countNonZero(mask) == 0) return mask;
    const auto half = others_.half(target);
    const std::vector<HalfSizePixel> band = on_ground_of(target, band_round(half->mask), 1);
    const std::vector<HalfSizePixel> light = on_ground_of(target, cv::Mat1b(half->mask == 0), kLight);
    const std::vector<std::vector<cv::Vec3f>> seen = others_.colors(target, kApart, band, light);
    cv::Mat1b differs(half->mask.size(), uchar{0}), unseen = differs.clone();
    const Usual usual(band, seen, half->mask.size(), kMisplaced);
    for (std::size_t i = 0; i < band.size(); ++i)
      if (seen[i].size() < kFewestViews)
        unseen(band[i].at) = 255;
      else if (usual.excludes(band[i].at, half->image(band[i].at)))
        differs(band[i].at) = 255;
    cv::medianBlur(differs, differs, 3);
    return joined(mask, half->mask, differs, unseen);
  }

 private:
  // As far round each part as it is high: shadows of a sun above 45 degrees; lower ones are cut.
  static cv::Mat1b band_round(const cv::Mat1b& mask) {
    cv::Mat1b band(mask.size(), uchar{0});
    for (const cv::Rect& part : find_part_boxes(mask)) {
      const int reach = std::clamp(part.height, 8, mask.cols / 8);
      const cv::Rect box(part.x - reach, part.y, part.width + 2 * reach, part.height + reach);
      band(box & cv::Rect({}, mask.size())) = 255;
    }
    band.setTo(0, mask);
    return band;
  }

  std::vector<HalfSizePixel> on_ground_of(std::size_t target, const cv::Mat1b& where, int every) const {
    std::vector<HalfSizePixel> out;
    const View& view = others_.views()[target];
    const SE3 world_from_camera = view.camera_from_world.inverse();
    for (int y = 0; y < where.rows; y += every)
      for (int x = 0; x < where.cols; x += every)
        if (where(y, x) != 0)
          if (const auto world = on_ground(view, world_from_camera, *ground_, {x, y})) out.push_back({{x, y}, *world});
    return out;
  }

  // What differs and hangs together with the mask, if need be across ground that nobody else saw; at full size.
  static cv::Mat1b joined(const cv::Mat1b& mask, const cv::Mat1b& small_mask, const cv::Mat1b& differs,
                          const cv::Mat1b& unseen) {
    cv::Mat1i parts;
    const int count = label_connected_parts(cv::Mat1b(differs | unseen), parts);
    const cv::Mat1b near = grown(small_mask, kTouch);
    std::vector<int> pixels(static_cast<std::size_t>(count) + 1, 0);
    std::vector<bool> touches(pixels.size(), false);
    for (int y = 0; y < parts.rows; ++y)
      for (int x = 0; x < parts.cols; ++x) {
        const auto part = static_cast<std::size_t>(parts(y, x));
        if (differs(y, x) != 0) ++pixels[part];
        if (near(y, x) != 0) touches[part] = true;
      }
    cv::Mat1b shadow(differs.size(), uchar{0});
    for (int y = 0; y < parts.rows; ++y)
      for (int x = 0; x < parts.cols; ++x)
        if (const auto part = static_cast<std::size_t>(parts(y, x));
            differs(y, x) != 0 && touches[part] && pixels[part] >= kSpeck)
          shadow(y, x) = 255;
    cv::Mat1b full;
    cv::resize(grown(shadow, 2), full, mask.size(), 0, 0, cv::INTER_NEAREST);
    return cv::Mat1b(full | mask);
  }

  OtherTimes others_;
  std::shared_ptr<const ground::ScanGround> ground_;
};

}  // namespace

Lazy<cv::Mat1b> with_shadows(const Views& views, const std::shared_ptr<const ground::ScanGround>& ground) {
  const auto finder = std::make_shared<const Finder>(views, ground);
  return kept_masks(views.size(), [finder](std::size_t i) { return (*finder)(i); });
}

}  // namespace dvi::objects
