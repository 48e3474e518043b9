#include "dvi/metrics/look.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "dvi/core/frame_name.h"
#include "dvi/core/threads.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/media/image_file.h"
#include "dvi/media/image_memory.h"
#include "dvi/media/write_image.h"
#include "dvi/metrics/ground_pixels.h"
#include "dvi/metrics/texture_cells.h"

namespace dvi::metrics {
namespace {

constexpr std::size_t kLookBytesPerPixel = 40;  // memory of a frame while it is measured

using harmonize::Kind;

cv::Mat1b find_filled(const cv::Mat1b& kind) {
  cv::Mat1b filled(kind.size(), uchar{0});
  for (int y = 0; y < kind.rows; ++y)
    for (int x = 0; x < kind.cols; ++x)
      if (harmonize::is_unobserved(kind(y, x)) && kind(y, x) != static_cast<uchar>(Kind::empty)) filled(y, x) = 255;
  return filled;
}

// The distance of a value from the range of the others, without the tails at both ends.
template <class Value>
double find_excess(double value, std::vector<const TextureCell*>& others, const Value& value_of) {
  const auto tail = static_cast<std::ptrdiff_t>(std::lround(kLook.tail_share * static_cast<double>(others.size() - 1)));
  const auto is_less = [&](const TextureCell* a, const TextureCell* b) { return value_of(*a) < value_of(*b); };
  std::nth_element(others.begin(), others.begin() + tail, others.end(), is_less);
  const double low = value_of(*others[static_cast<std::size_t>(tail)]);
  std::nth_element(others.begin(), others.end() - 1 - tail, others.end(), is_less);
  const double high = value_of(**(others.end() - 1 - tail));
  return value < low ? value - low : std::max(0.0, value - high);
}

// A cell of the fill, judged by the cells around it.
LookSums judge(const TextureCell& cell, std::vector<const TextureCell*> others) {
  const auto pixels = static_cast<double>(cell.pixels);
  LookSums sums;
  sums.judged = cell.pixels;
  for (std::size_t bin = 0; bin < kTextureBins; ++bin)
    sums.texture_sum += pixels / kTextureBins *
                        std::abs(find_excess(cell.texture[bin], others, [&](const TextureCell& c) { return c.texture[bin]; }));
  for (int channel = 0; channel < 3; ++channel)
    sums.color_sum +=
        pixels / 3 * std::abs(find_excess(cell.color[channel], others, [&](const TextureCell& c) { return c.color[channel]; }));
  const double texture = find_excess(cell.mean_texture(), others, [](const TextureCell& c) { return c.mean_texture(); });
  if (texture < -kLook.blank_octaves) sums.blank_pixels = cell.pixels;
  return sums;
}

std::vector<const TextureCell*> find_others(const TextureCell& cell, const std::vector<TextureCell>& known) {
  std::vector<const TextureCell*> near;
  for (const TextureCell& other : known)
    if (cv::norm(cell.corner - other.corner) <= kLook.radius_px) near.push_back(&other);
  if (near.size() >= kLook.min_cells) return near;
  near.clear();
  for (const TextureCell& other : known) near.push_back(&other);
  return near;
}

// Judges the unobserved pixels in a part of a frame that contains them all, and their surroundings.
class FrameJudge {
 public:
  explicit FrameJudge(const LookImages& images)
      : images_(images), filled_(find_filled(images.kind)), labels_(filled_.size(), 0), distance_(filled_.size(), 0.0F) {
    cv::distanceTransform(filled_ == 0, distance_, labels_, cv::DIST_L2, cv::DIST_MASK_5);
    double parts = 0;
    cv::minMaxLoc(labels_, nullptr, &parts);
    out_.parts.resize(static_cast<std::size_t>(parts));
  }

  LookFrame judge_all() {
    judge_cells();
    for (int y = 0; y < filled_.rows; ++y)
      for (int x = 0; x < filled_.cols; ++x) {
        const cv::Point p(x, y);
        if (distance_(p) > static_cast<float>(kLook.step_band_px)) continue;
        if (filled_(p) != 0) add_pixel(p);
        if (x + 1 < filled_.cols) add_step(p, p + cv::Point(1, 0));
        if (y + 1 < filled_.rows) add_step(p, p + cv::Point(0, 1));
      }
    for (const LookPart& part : out_.parts) out_.sums += part.sums;
    return std::move(out_);
  }

 private:
  enum Set : uchar { none, filled_ground, filled_other, known_ground, known_other, count };

  bool is_ground(cv::Point p) const { return images_.ground.empty() || images_.ground(p) != 0; }
  bool is_known(cv::Point p) const { return !harmonize::is_unobserved(images_.kind(p)); }
  LookPart& part(cv::Point p) { return out_.parts[static_cast<std::size_t>(labels_(p) - 1)]; }

  void add_pixel(cv::Point p) {
    ++part(p).sums.pixels;
    part(p).box |= cv::Rect(p, cv::Size(1, 1));
  }

  cv::Mat1b assign_sets() const {
    cv::Mat1b inner, sets(filled_.size(), uchar{none});
    cv::erode(filled_, inner, cv::Mat1b(2 * kLook.margin_px + 1, 2 * kLook.margin_px + 1, uchar{1}));
    for (int y = 0; y < sets.rows; ++y)
      for (int x = 0; x < sets.cols; ++x) {
        const cv::Point p(x, y);
        const float distance = distance_(p);
        if (inner(p) != 0)
          sets(p) = is_ground(p) ? filled_ground : filled_other;
        else if (is_known(p) && distance > static_cast<float>(kLook.margin_px) && distance <= static_cast<float>(kLook.band_px))
          sets(p) = is_ground(p) ? known_ground : known_other;
      }
    return sets;
  }

  void judge_cells() {
    const cv::Mat1b sets = assign_sets();
    const auto cells = collect_texture_cells(images_.frame, sets, count);
    for (const auto& [filled, known] : {std::pair(filled_ground, known_ground), std::pair(filled_other, known_other)})
      for (const TextureCell& cell : cells[filled])
        if (std::vector<const TextureCell*> others = find_others(cell, cells[known]); others.size() >= kLook.min_cells)
          part(find_first(sets, cell.corner, filled)).sums += judge(cell, std::move(others));
  }

  // Returns the first pixel of a set in a cell.
  static cv::Point find_first(const cv::Mat1b& sets, cv::Point corner, Set set) {
    for (int y = corner.y;; ++y)
      for (int x = corner.x; x < std::min(corner.x + kTextureCellPx, sets.cols); ++x)
        if (sets(y, x) == set) return {x, y};
  }

  // Adds the step between two adjacent pixels, across the boundary or beside it.
  void add_step(cv::Point a, cv::Point b) {
    if (filled_(a) != 0 && filled_(b) != 0) return;
    if (distance_(b) > static_cast<float>(kLook.step_band_px) || is_ground(a) != is_ground(b)) return;
    if (!(is_known(a) || filled_(a) != 0) || !(is_known(b) || filled_(b) != 0)) return;
    const cv::Vec3i step = cv::Vec3i(images_.frame(a)) - cv::Vec3i(images_.frame(b));
    const double size = (std::abs(step[0]) + std::abs(step[1]) + std::abs(step[2])) / 3.0;
    LookSums& sums = part(filled_(b) != 0 ? b : a).sums;
    if (filled_(a) != filled_(b))
      ++sums.steps, sums.step_sum += size;
    else
      ++sums.known_steps, sums.known_step_sum += size;
  }

  const LookImages& images_;
  cv::Mat1b filled_;
  cv::Mat1i labels_;    // number of the nearest part, from 1
  cv::Mat1f distance_;  // to the nearest unobserved pixel
  LookFrame out_;
};

cv::Rect find_region(const cv::Mat1b& kind) {
  const cv::Rect box = cv::boundingRect(find_filled(kind));
  if (box.empty()) return {};
  const cv::Point border(kLook.band_px, kLook.band_px);
  return cv::Rect(box.tl() - border, box.br() + border) & cv::Rect({}, kind.size());
}

LookFrame load_and_measure(const fs::path& out, const std::string& name,
                           const std::function<fs::path(const std::string& name)>& filled) {
  const cv::Size size = media::image_size(out / picture_file("frames", name));
  LookImages images;
  images.kind = media::read_png_gray(out / picture_file("kind", name), size);
  LookFrame frame;
  if (cv::countNonZero(find_filled(images.kind)) > 0) {
    images.frame = media::read_image(out / picture_file("frames", name), size);
    if (filled) media::read_image(filled(name), size).copyTo(images.frame, images.kind);
    if (const fs::path depth = out / picture_file("depth", name); fs::is_directory(depth.parent_path()))
      images.ground = find_ground_pixels(media::read_png_depth(depth, size));
    frame = measure_look(images);
  }
  frame.name = name;
  frame.sums.image_pixels = static_cast<std::size_t>(size.area());
  for (LookPart& part : frame.parts) part.frame = name, part.sums.image_pixels = frame.sums.image_pixels;
  return frame;
}

// Sorts frames or parts by their impact, the largest first, without those that have none.
template <class Item>
std::vector<Item> sort_by_impact(std::vector<Item> items) {
  std::erase_if(items, [](const Item& item) { return item.sums.impact().value_or(0) == 0; });
  std::stable_sort(items.begin(), items.end(),
                   [](const Item& a, const Item& b) { return *a.sums.impact() > *b.sums.impact(); });
  return items;
}

bool overlap(const cv::Rect& a, const cv::Rect& b) {
  const double common = (a & b).area();
  return common > kLook.max_overlap * (a.area() + b.area() - common);
}

std::optional<double> divide(double sum, std::size_t count) {
  return count > 0 ? std::optional(sum / static_cast<double>(count)) : std::nullopt;
}

}  // namespace

LookSums& LookSums::operator+=(const LookSums& other) {
  pixels += other.pixels, image_pixels += other.image_pixels, judged += other.judged;
  texture_sum += other.texture_sum, color_sum += other.color_sum, blank_pixels += other.blank_pixels;
  steps += other.steps, known_steps += other.known_steps;
  step_sum += other.step_sum, known_step_sum += other.known_step_sum;
  return *this;
}

std::optional<double> LookSums::texture() const { return divide(texture_sum, judged); }
std::optional<double> LookSums::color() const { return divide(color_sum, judged); }
std::optional<double> LookSums::blank() const { return divide(static_cast<double>(blank_pixels), judged); }

std::optional<double> LookSums::boundary() const {
  const auto across = divide(step_sum, steps), beside = divide(known_step_sum, known_steps);
  if (!across || !beside) return std::nullopt;
  return std::max(0.0, std::log2((*across + kLook.step_noise) / (*beside + kLook.step_noise)));
}

std::optional<double> LookSums::look() const {
  const auto inside = texture(), outside = boundary();
  if (!inside && !outside) return std::nullopt;
  return inside.value_or(0) + outside.value_or(0);
}

std::optional<double> LookSums::impact() const {
  const auto value = look(), share = divide(100.0 * static_cast<double>(pixels), image_pixels);
  return value && share ? std::optional(*value * *share) : std::nullopt;
}

std::vector<LookFrame> Look::find_worst_frames() const {
  std::vector<LookFrame> worst = sort_by_impact(frames);
  worst.resize(std::min(worst.size(), kLook.worst_frames));
  return worst;
}

std::vector<LookPart> Look::find_worst_parts() const {
  std::vector<LookPart> parts;
  for (const LookFrame& frame : frames) parts.insert(parts.end(), frame.parts.begin(), frame.parts.end());
  std::vector<LookPart> worst;
  for (LookPart& part : sort_by_impact(std::move(parts))) {
    if (worst.size() == kLook.worst_parts) break;
    const auto is_same = [&](const LookPart& listed) { return overlap(part.box, listed.box); };
    if (std::none_of(worst.begin(), worst.end(), is_same)) worst.push_back(std::move(part));
  }
  return worst;
}

LookFrame measure_look(const LookImages& images) {
  const cv::Rect region = find_region(images.kind);
  LookFrame frame;
  if (!region.empty()) {
    const LookImages cropped{images.frame(region), images.kind(region),
                             images.ground.empty() ? images.ground : images.ground(region)};
    frame = FrameJudge(cropped).judge_all();
  }
  frame.sums.image_pixels = images.kind.total();
  for (LookPart& part : frame.parts) {
    part.sums.image_pixels = images.kind.total();
    part.box += region.tl();
  }
  return frame;
}

std::optional<Look> measure_look(const fs::path& out, const std::vector<std::string>& names, const Tick& tick,
                                 const std::function<fs::path(const std::string& name)>& filled) {
  Look look;
  look.frames.resize(names.size());
  const auto measure = [&](std::size_t i) {
    look.frames[i] = load_and_measure(out, names[i], filled);
    tick();
  };
  parallel_in_order(names.size(), measure, media::estimate_image_bytes(out, "frames", names, kLookBytesPerPixel));
  for (const LookFrame& frame : look.frames) look.total += frame.sums;
  return look.total.pixels > 0 ? std::optional(std::move(look)) : std::nullopt;
}

}  // namespace dvi::metrics
