#include "dvi/commands/outline_masks.h"

#include <algorithm>
#include <map>
#include <set>

#include <opencv2/imgproc.hpp>

#include "dvi/core/threads.h"
#include "dvi/image/nearest_pixel.h"
#include "dvi/labels/image_labels.h"
#include "dvi/labels/trace_polygons.h"

namespace dvi::commands {
namespace {

constexpr const char* kUnknownType = "object";

/// An object of a frame before its mask is dilated.
struct Region {
  int track = -1;
  std::string type;
  cv::Mat1b mask;
};

// Draws the shape of a label that fits the object best.
void draw_label(const Drive& drive, const Label& label, cv::Mat1b& mask) {
  if (label.instance) return draw(*label.instance, mask);
  if (label.rect) {
    const cv::Rect2d image(0, 0, mask.cols, mask.rows);
    cv::rectangle(mask, cv::Rect(*label.rect & image), 255, cv::FILLED);
  } else if (label.box) {
    std::vector<Eigen::Vector3d> corners;
    for (const Eigen::Vector3d& corner : label.box->corners()) corners.push_back(drive.camera_from_lidar * corner);
    draw_hull(corners, drive.camera, mask);
  }
}

std::vector<Region> draw_regions(const Drive& drive, const objects::CameraObjects& objects, std::size_t frame) {
  std::vector<Region> regions;
  std::map<int, std::size_t> of_track;
  for (const SharedLabels& labels : {objects.labels, objects.completed, objects.shown}) {
    if (frame >= labels->size()) continue;
    for (const Label& label : (*labels)[frame]) {
      const auto [known, is_new] = of_track.emplace(label.track, regions.size());
      if (is_new || label.track < 0) {
        known->second = regions.size();
        regions.push_back({label.track, label.type.empty() ? kUnknownType : label.type,
                           cv::Mat1b(drive.camera.height, drive.camera.width, uchar{0})});
      }
      draw_label(drive, label, regions[known->second].mask);
    }
  }
  return regions;
}

// Returns 1 plus the index of the nearest region for each pixel of the mask; 0 for connected parts that touch no region.
cv::Mat1i assign_regions(const cv::Mat1b& mask, const std::vector<Region>& regions) {
  cv::Mat1i owner(mask.size(), 0);
  for (std::size_t i = 0; i < regions.size(); ++i) owner.setTo(static_cast<int>(i + 1), regions[i].mask & mask);
  if (cv::countNonZero(owner != 0) == 0) return owner;
  const NearestPixel nearest(cv::Mat1b(owner != 0));
  cv::Mat1i parts;
  std::vector<uchar> is_touched(static_cast<std::size_t>(cv::connectedComponents(mask, parts)), 0);
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
      if (owner(y, x) != 0) is_touched[static_cast<std::size_t>(parts(y, x))] = 1;
  cv::Mat1i out(mask.size(), 0);
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
      if (mask(y, x) != 0 && is_touched[static_cast<std::size_t>(parts(y, x))] != 0) out(y, x) = owner(*nearest.find({x, y}));
  return out;
}

labels::DrawnObject outline(int track, const std::string& type, const cv::Mat1b& mask) {
  return {.track = track, .type = type, .parts = labels::trace_polygons(mask), .pixels = cv::countNonZero(mask)};
}

std::vector<labels::DrawnObject> outline_frame(const cv::Mat1b& mask, const std::vector<Region>& regions) {
  std::vector<labels::DrawnObject> objects;
  const cv::Mat1i owners = assign_regions(mask, regions);
  cv::Mat1b own;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    cv::compare(owners, static_cast<double>(i + 1), own, cv::CMP_EQ);
    if (cv::countNonZero(own) > 0) objects.push_back(outline(regions[i].track, regions[i].type, own));
  }
  cv::Mat1i parts;
  const int count = cv::connectedComponents((owners == 0) & mask, parts);
  for (int part = 1; part < count; ++part) {
    cv::compare(parts, part, own, cv::CMP_EQ);
    objects.push_back(outline(-1, kUnknownType, own));
  }
  return objects;
}

cv::Rect2d find_bounds(const labels::DrawnObject& object) {
  std::vector<cv::Point2f> corners(object.parts.front().begin(), object.parts.front().end());
  return cv::boundingRect(corners);
}

/// Gives objects without a track the track of the object in the frame before that overlaps most.
class TrackLinker {
 public:
  explicit TrackLinker(int first_track) : next_(first_track) {}

  void link(std::vector<labels::DrawnObject>& objects) {
    std::map<int, cv::Rect2d> now;
    for (labels::DrawnObject& object : objects) {
      if (object.track >= 0) continue;
      const cv::Rect2d bounds = find_bounds(object);
      object.track = take_track(object.type, bounds);
      now[object.track] = bounds;
      types_[object.track] = object.type;
    }
    before_ = std::move(now);
  }

 private:
  int take_track(const std::string& type, const cv::Rect2d& bounds) {
    auto best = before_.end();
    double largest = 0;
    for (auto known = before_.begin(); known != before_.end(); ++known)
      if (const double overlap = (known->second & bounds).area(); overlap > largest && types_[known->first] == type)
        largest = overlap, best = known;
    if (best == before_.end()) return next_++;
    const int track = best->first;
    before_.erase(best);
    return track;
  }

  std::map<int, cv::Rect2d> before_;  // by track
  std::map<int, std::string> types_;
  int next_;
};

std::string choose_file_name(const Frame& frame) {
  return frame.file.stem() == frame.name ? frame.file.filename().string() : frame.name + ".png";
}

}  // namespace

labels::DrawnLabels outline_masks(const Drive& drive, const objects::CameraMasks& masks) {
  const std::vector<std::string> order = labels::list_names_in_order(drive);
  std::map<std::string, int> index_of;
  for (std::size_t i = 0; i < order.size(); ++i) index_of[order[i]] = static_cast<int>(i);
  labels::DrawnLabels out{{drive.camera.width, drive.camera.height}, static_cast<int>(order.size()), {}};
  out.images.resize(drive.frames.size());
  parallel_for(drive.frames.size(), [&](std::size_t i) {
    const Frame& frame = drive.frames[i];
    out.images[i] = {choose_file_name(frame), index_of.at(frame.name),
                     outline_frame(*masks.images[i], draw_regions(drive, masks.objects, i))};
  });
  int last_track = -1;
  for (const labels::DrawnImage& image : out.images)
    for (const labels::DrawnObject& object : image.objects) last_track = std::max(last_track, object.track);
  TrackLinker linker(last_track + 1);
  for (labels::DrawnImage& image : out.images) linker.link(image.objects);
  return out;
}

}  // namespace dvi::commands
