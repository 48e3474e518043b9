#include "dvi/metrics/ghosts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/core/frame_name.h"
#include "dvi/core/threads.h"
#include "dvi/drive/outline.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/harmonize/provenance.h"
#include "dvi/media/write_image.h"

namespace dvi::metrics {
namespace {

double share_of(std::size_t part, std::size_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

// The depths z between which a ray is inside a box.
struct Crossing {
  double entry_m, exit_m;
};

// A box in the axes of a camera, shrunk to the inner share of its object.
class VisibleBox {
 public:
  VisibleBox(std::size_t object, const Box& world, const GhostSource& camera)
      : object_(object),
        box_from_camera_((camera.camera_from_world * world.frame_from_box).inverse()),
        half_(0.5 * kGhost.inner_share * world.size),
        is_visible_(camera.camera.is_wide()) {
    const Box in_camera{camera.camera_from_world * world.frame_from_box, kGhost.inner_share * world.size};
    for (const Eigen::Vector3d& corner : in_camera.corners()) {
      is_visible_ |= corner.z() > 0;
      if (corner.z() > 0)
        silhouette_.extend(Eigen::Vector2d(corner.head<2>() / corner.z()));
      else
        is_in_front_ = false;
    }
  }

  std::size_t object() const { return object_; }
  // Whether a part of the box may be in the image.
  bool is_visible() const { return is_visible_; }

  // Returns the depths between which a ray (of depth 1) of the camera is inside the box; nothing if it passes the box, or if
  // the camera is inside.
  std::optional<Crossing> cross(const Eigen::Vector3d& ray) const {
    if (is_in_front_ && !(ray.z() > 0 && silhouette_.contains(Eigen::Vector2d(ray.head<2>() / ray.z())))) return std::nullopt;
    const Eigen::Vector3d direction = box_from_camera_.R * ray;
    Crossing out{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    for (int axis = 0; axis < 3; ++axis) {
      const double origin = box_from_camera_.t[axis];
      if (direction[axis] == 0) {
        if (std::abs(origin) > half_[axis]) return std::nullopt;
        continue;
      }
      const double a = (-half_[axis] - origin) / direction[axis], b = (half_[axis] - origin) / direction[axis];
      out.entry_m = std::max(out.entry_m, std::min(a, b));
      out.exit_m = std::min(out.exit_m, std::max(a, b));
    }
    if (out.entry_m <= 0 || out.entry_m > out.exit_m) return std::nullopt;
    return out;
  }

 private:
  std::size_t object_;
  SE3 box_from_camera_;
  Eigen::Vector3d half_;
  Eigen::AlignedBox2d silhouette_;  // bounds at z = 1, if all of the box is in front of the camera
  bool is_in_front_ = true;
  bool is_visible_;
};

// The boxes that a camera may show.
class VisibleBoxes {
 public:
  VisibleBoxes(const std::vector<StationaryObject>& objects, const GhostSource& camera) {
    for (std::size_t i = 0; i < objects.size(); ++i)
      if (VisibleBox box(i, objects[i].world, camera); box.is_visible()) {
        boxes_.push_back(box);
        const auto outline = camera.outlines.find(objects[i].track);
        outlines_.emplace_back();
        if (outline == camera.outlines.end()) continue;
        outlines_.back() = cv::Mat1b(outline->second.size, uchar{0});
        draw(outline->second, outlines_.back());
      }
  }

  // Returns the object that a ray crosses first.
  std::optional<std::size_t> find_nearest(const Eigen::Vector3d& ray) const {
    std::optional<std::size_t> nearest;
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const VisibleBox& box : boxes_)
      if (const auto crossing = box.cross(ray); crossing && crossing->entry_m < nearest_m)
        nearest = box.object(), nearest_m = crossing->entry_m;
    return nearest;
  }

  enum class Shown { background, ghost, in_map };
  // Determines the surface that a position in the image shows whose copied point is at a depth. `ray` is the position's.
  Shown judge(cv::Point2f position, const Eigen::Vector3d& ray, double depth_m) const {
    Shown shown = Shown::background;
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      if (!may_show(i, position)) continue;
      const auto crossing = boxes_[i].cross(ray);
      if (!crossing || depth_m < crossing->entry_m - kGhost.before_m) continue;
      if (depth_m > crossing->exit_m + kGhost.behind_m) return Shown::ghost;
      shown = Shown::in_map;
    }
    return shown;
  }

 private:
  // Whether a position is in the outline of an object, or its outline is unknown.
  bool may_show(std::size_t i, cv::Point2f position) const {
    const cv::Mat1b& outline = outlines_[i];
    const cv::Point pixel(cvRound(position.x), cvRound(position.y));
    return outline.empty() || !cv::Rect({}, outline.size()).contains(pixel) || outline(pixel) != 0;
  }

  std::vector<VisibleBox> boxes_;
  std::vector<cv::Mat1b> outlines_;  // the outlines of their objects; empty: unknown
};

struct FrameGhosts {
  GhostCounts counts;
  std::size_t unjudged = 0;
  std::vector<GhostTrack> tracks;
};

// Counts the ghosts of one frame.
class FrameCounter {
 public:
  FrameCounter(const fs::path& out, const GhostScene& scene, std::size_t frame)
      : scene_(scene), target_(*scene.sources[frame]), frame_(scene.frames[frame]) {
    const cv::Size size(target_.camera.width, target_.camera.height);
    kind_ = media::read_png_gray(out / picture_file("kind", frame_), size);
    provenance_ = media::read_png_triples(out / picture_file("provenance", frame_), size);
    depth_ = media::read_png_depth(out / picture_file("depth", frame_), size);
    is_ghost_ = cv::Mat1b(size, uchar{0});
    provenance_file_ = out / picture_file("provenance", frame_);
  }

  FrameGhosts count() {
    std::map<int, std::vector<cv::Point>> by_source;
    for (int y = 0; y < kind_.rows; ++y)
      for (int x = 0; x < kind_.cols; ++x)
        if (is_copied({x, y})) by_source[decode({x, y}).view].emplace_back(x, y);
    for (const auto& [source, pixels] : by_source) count_copies(source, pixels);
    count_tracks();
    return std::move(out_);
  }

 private:
  bool is_copied(cv::Point p) const {
    const auto kind = static_cast<harmonize::Kind>(kind_(p));
    return kind == harmonize::Kind::copied || kind == harmonize::Kind::copied_elsewhere;
  }

  harmonize::Provenance decode(cv::Point p) const { return harmonize::Provenance::decode(provenance_(p), {1, 1, 1}); }

  // Returns the point of a pixel in the target's axes.
  Eigen::Vector3d find_point(cv::Point p) const {
    const double depth_m = depth_(p) > 0 ? depth_(p) / 256.0 : kGhost.unknown_depth_m;
    return depth_m * target_.camera.ray({p.x, p.y});
  }

  void count_copies(int number, const std::vector<cv::Point>& pixels) {
    if (number < 0 || static_cast<std::size_t>(number) >= scene_.sources.size())
      throw InputError(provenance_file_, fmt::format("has a pixel of source {}, which sources.json does not list", number),
                       "run the same dvi run again, which completes the result");
    const std::optional<GhostSource>& source = scene_.sources[static_cast<std::size_t>(number)];
    if (!source) {
      out_.unjudged += pixels.size();
      return;
    }
    const VisibleBoxes boxes(scene_.objects, *source);
    const SE3 source_from_target = source->camera_from_world * target_.camera_from_world.inverse();
    for (const cv::Point p : pixels) {
      const cv::Point2f position = decode(p).position;
      const double depth_m = source->camera.depth(source_from_target * find_point(p));
      const auto shown = boxes.judge(position, source->camera.ray({position.x, position.y}), depth_m);
      ++out_.counts.copied;
      out_.counts.ghosts += shown == VisibleBoxes::Shown::ghost;
      out_.counts.in_map += shown == VisibleBoxes::Shown::in_map;
      if (shown == VisibleBoxes::Shown::ghost) is_ghost_(p) = 255;
    }
  }

  void count_tracks() {
    for (const StationaryObject& object : scene_.objects) out_.tracks.push_back({object.track, object.type});
    const VisibleBoxes boxes(scene_.objects, target_);
    for (int y = 0; y < kind_.rows; ++y)
      for (int x = 0; x < kind_.cols; ++x) {
        if (kind_(y, x) == 0) continue;
        const std::optional<std::size_t> object = boxes.find_nearest(target_.camera.ray({x, y}));
        if (!object) continue;
        ++out_.tracks[*object].removed;
        out_.tracks[*object].refilled += is_ghost_(y, x) != 0;
      }
  }

  const GhostScene& scene_;
  GhostSource target_;
  std::string frame_;
  fs::path provenance_file_;
  cv::Mat1b kind_, is_ghost_;
  cv::Mat_<cv::Vec3w> provenance_;
  cv::Mat1w depth_;
  FrameGhosts out_;
};

}  // namespace

GhostCounts& GhostCounts::operator+=(const GhostCounts& other) {
  copied += other.copied, ghosts += other.ghosts, in_map += other.in_map;
  return *this;
}
double GhostCounts::ghost_share() const { return share_of(ghosts, copied); }
double GhostCounts::in_map_share() const { return share_of(in_map, copied); }
double GhostTrack::refilled_share() const { return share_of(refilled, removed); }

std::vector<GhostFrame> Ghosts::find_worst_frames() const {
  std::vector<GhostFrame> worst = frames;
  std::stable_sort(worst.begin(), worst.end(),
                   [](const GhostFrame& a, const GhostFrame& b) { return a.counts.ghosts > b.counts.ghosts; });
  worst.resize(std::min(worst.size(), kGhost.worst_frames));
  std::erase_if(worst, [](const GhostFrame& frame) { return frame.counts.ghosts == 0; });
  return worst;
}

Ghosts count_ghosts(const fs::path& out, const GhostScene& scene, const Tick& tick) {
  Ghosts sum;
  for (const StationaryObject& object : scene.objects) sum.tracks.push_back({object.track, object.type});
  const auto count = [&](std::size_t i) -> std::optional<FrameGhosts> {
    if (!scene.sources[i] || !fs::exists(out / picture_file("frames", scene.frames[i]))) return std::nullopt;
    return FrameCounter(out, scene, i).count();
  };
  make_and_use(scene.frames.size(), count, [&](std::size_t i, const std::optional<FrameGhosts>& found) {
    tick();
    if (!found) return;
    sum.total += found->counts;
    sum.unjudged += found->unjudged;
    sum.frames.push_back({scene.frames[i], found->counts});
    for (std::size_t k = 0; k < sum.tracks.size(); ++k) {
      sum.tracks[k].removed += found->tracks[k].removed;
      sum.tracks[k].refilled += found->tracks[k].refilled;
    }
  });
  return sum;
}

}  // namespace dvi::metrics
