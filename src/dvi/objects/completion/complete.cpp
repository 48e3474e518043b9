#include "dvi/objects/completion/complete.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/core/threads.h"
#include "dvi/drive/image_returns.h"
#include "dvi/drive/outline.h"
#include "dvi/image/enlarge.h"
#include "dvi/image/nearest_pixel.h"
#include "dvi/image/region.h"
#include "dvi/objects/close_returns.h"
#include "dvi/objects/completion/box_masks.h"
#include "dvi/objects/completion/identities.h"
#include "dvi/objects/completion/object_columns.h"
#include "dvi/objects/completion/removed_tracks.h"
#include "dvi/objects/seconds.h"

namespace dvi::objects {
namespace {

struct CompletionParams {
  double max_covered_share = 0.5;  ///< of a track's outline, from which the mask shows the object in this frame
  double static_s = 1;             ///< time over which scans observe a voxel of a stationary object
  double max_range_m = 200;        ///< farther objects cover a few pixels
  double border_m = 0.35;          ///< deviation of an object's drawn outline from its true one
  int min_border_px = 3;           ///< deviation of masks from the true outline
  double ground_m = 0.2;           ///< height above the ground up to which returns are on the ground
  int shadow_columns = 4;          ///< columns around an object whose ground its shadow may cover: 1 m
  /// Time to the scans that show whether something moves.
  std::array<double, 4> compared_s{-1, -0.5, 0.5, 1};
  float max_parallax_px = 12;     ///< distance to an object in the image up to which it may hide a return from the camera
  double max_object_m = 4.5;      ///< height of objects above the ground
  double body_margin_m = 0.2;     ///< by which drawn objects are larger than they are, in meters ...
  int body_margin_px = 2;         ///< ... and in pixels
  double object_margin_m = 0.08;  ///< by which objects extend beyond their silhouettes: roofs and glass return little
  double top_margin_m = 0.3;      ///< returns this far above an object are behind it
  double front_m = 0.5;           ///< distance of things in front of an object
};
constexpr CompletionParams kCompletion;

int to_pixels(double meters, double depth_m, const Camera& camera) {
  return cvRound(meters * camera.fx / std::max(depth_m, 1.0));
}

// Draws the convex hull of a silhouette: roofs and windows return little.
cv::Mat1b draw_convex_hull(const cv::Mat1b& silhouette) {
  cv::Mat1b out(silhouette.size(), uchar{0});
  std::vector<cv::Point> pixels, corners;
  cv::findNonZero(silhouette, pixels);
  if (pixels.empty()) return out;
  cv::convexHull(pixels, corners);
  cv::fillConvexPoly(out, corners, 255);
  return out;
}

// Returns the part of an object that a mask lacks, without the deviations at the border of the mask.
cv::Mat1b find_uncovered(const cv::Mat1b& object, const cv::Mat1b& mask, int border_px) {
  cv::Mat1b out(object.size(), uchar{0});
  const cv::Rect box = enlarge(cv::boundingRect(object), border_px, object.size());
  if (box.empty()) return out;
  const cv::Mat1b drawn = object(box), masked = mask(box), lacking(drawn & ~masked);
  const cv::Mat1b core = grown_far(lacking, -border_px);
  // A small object that the mask lacks completely has no core.
  if (cv::countNonZero(core) > 0)
    cv::Mat1b(grown_far(core, 2 * border_px) & lacking).copyTo(out(box));
  else if (cv::countNonZero(drawn & grown_far(masked, border_px)) == 0)
    lacking.copyTo(out(box));
  return out;
}

}  // namespace

CompletedObjects::CompletedObjects(const CompletionInput& input, const Tick& tick)
    : returns_(input.returns), ground_(input.ground), options_(input.options), refine_(input.refine) {
  if (input.cameras.empty()) return;
  const CameraMaskEvidence& own = input.cameras.front();
  std::vector<OccupiedVoxel> voxels = find_object_space(input.cameras, input.returns, tick);
  std::vector<SharedTrack> tracks = find_removed_tracks(input.cameras, input.returns, input.tracks);
  const Identities identities = identify(own, {voxels, tracks, input.returns});
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    CompletedObject& object = objects_[identities.of_voxel[i]];
    object.extent.extend(voxels[i].center());
    object.voxels.push_back(std::move(voxels[i]));
  }
  for (std::size_t k = 0; k < tracks.size(); ++k) objects_[identities.of_track[k]].tracks.push_back(std::move(tracks[k]));
  for (LabeledBoxes& boxes : LabeledBoxes::collect(own.camera.drive, *own.labels, own.camera.world_from_lidar))
    objects_[boxes.track()].boxes = std::move(boxes);
}

// One frame into which objects are drawn.
class CompletedObjects::FrameDrawing {
 public:
  FrameDrawing(const CompletedObjects& objects, const CameraEvidence& camera, std::size_t frame, const SE3& world_from_lidar)
      : all_(objects),
        drive_(camera.drive),
        frame_(frame),
        time_ns_(drive_.frames[frame].time_ns),
        lidar_from_world_(world_from_lidar.inverse()),
        camera_from_world_(drive_.camera_from_lidar * lidar_from_world_),
        camera_in_world_(camera_from_world_.inverse().t),
        scan_(objects.returns_.find_scan(time_ns_)) {
    if (scan_) space_ = objects.returns_.free_space(*scan_);
  }

  // Draws an object into the frame: where `mask` lacks it, and where the mask shows it.
  void draw(int number, const CompletedObject& object, const cv::Mat1b& mask) {
    const ObjectColumns occupied = fill_columns(object);
    std::vector<ObjectColumns> moving;
    for (const SharedTrack& track : object.tracks)
      if (ObjectColumns columns = objects::fill_columns(*track, time_ns_); !columns.empty())
        moving.push_back(std::move(columns));
    const std::optional<Box> box = find_visible_box(object);
    if (occupied.empty() && moving.empty() && !box) return;
    cv::Mat1b lacking(mask.size(), uchar{0}), covered = lacking.clone();
    const auto add = [&](const cv::Mat1b& drawn, double depth_m, double max_covered_share) {
      covered |= drawn & mask;
      if (cv::countNonZero(drawn & mask) > max_covered_share * cv::countNonZero(drawn)) return;
      const int border_px = std::max(kCompletion.min_border_px, to_pixels(kCompletion.border_m, depth_m, drive_.camera));
      const cv::Mat1b uncovered = find_uncovered(drawn, mask, border_px);
      const int margin_px =
          std::max(cvRound(kSilhouetteMarginShare * mask.cols), to_pixels(kCompletion.object_margin_m, depth_m, drive_.camera));
      lacking |= cv::countNonZero(uncovered) == 0 ? uncovered : cv::Mat1b(grown_far(uncovered, margin_px) & ~mask);
    };
    const auto add_columns = [&](const ObjectColumns& columns, double max_covered_share) {
      if (columns.empty()) return;
      columns_.add(columns);
      const cv::Mat1b drawn = columns.draw(all_.ground_, drive_.camera, camera_from_world_);
      const double depth_m = columns.nearest_m(drive_.camera, camera_from_world_);
      bodies_.push_back(
          {drawn, kCompletion.body_margin_px + to_pixels(kCompletion.body_margin_m, depth_m, drive_.camera), depth_m});
      add(drawn, depth_m, max_covered_share);
    };
    add_columns(occupied, 1);
    for (const ObjectColumns& columns : moving) add_columns(columns, kCompletion.max_covered_share);
    if (box) {
      const cv::Mat1b drawn = draw_box(*box);
      add(drawn, drive_.camera.depth(camera_from_world_ * box->frame_from_box.t), 1);
      bodies_.push_back({drawn, 0, find_nearest_depth(*box)});
    }
    drawn_.push_back({number, object.boxes ? object.boxes->type() : "", lacking, covered});
  }

  // Adds the objects to the outlines of the frame, except for the pixels of things in front of them.
  void add_outlines(const cv::Mat1b& foreground, ObjectOutlines& out) const {
    for (const DrawnObject& object : drawn_) {
      add_label(object, cv::Mat1b(object.lacking & ~foreground), out.completed[frame_]);
      add_label(object, cv::Mat1b(object.covered & ~foreground), out.shown[frame_]);
    }
  }

  bool is_empty() const { return bodies_.empty(); }

  // Returns the background that bounding boxes of a mask cover, once all objects are drawn.
  cv::Mat1b find_covered_background(const cv::Mat1b& mask, const std::vector<ImageReturn>& returns) const {
    cv::Mat1b out(mask.size(), uchar{0});
    if (columns_.empty() || !scan_) return out;
    const std::vector<BoxPart> parts = find_box_parts(mask);
    if (parts.empty()) return out;
    const BoxSeeds seeds = find_seeds(returns);
    const auto image = drive_.images[frame_];
    for (const BoxPart& part : parts) find_background(part, *image, seeds).copyTo(out(part.area), part.mask);
    for (const Body& body : bodies_) out.setTo(0, draw_convex_hull(grown_far(body.drawn, -body.margin_px)));
    return out;
  }

  // Returns the pixels of the drawn objects that show things in front of all of them, such as trunks and poles.
  cv::Mat1b find_foreground(const std::vector<ImageReturn>& returns) const {
    const cv::Size size(drive_.camera.width, drive_.camera.height);
    cv::Mat1b seeds(size, uchar{0});
    cv::Mat1f nearest_m(size, std::numeric_limits<float>::infinity());
    const int margin_px = cvRound(kSilhouetteMarginShare * size.width);
    for (const Body& body : bodies_) {
      cv::Mat1f around = nearest_m(enlarge(cv::boundingRect(body.drawn), 2 * margin_px, size));  // things continue beside it
      cv::min(around, body.depth_m, around);
    }
    const SE3 world_from_camera = camera_from_world_.inverse();
    for (const ImageReturn& r : returns) {
      const cv::Point pixel(cvRound(r[0]), cvRound(r[1]));
      if (!std::isfinite(nearest_m(pixel)) || r[2] + kCompletion.front_m > nearest_m(pixel)) continue;
      const Eigen::Vector3d world = world_from_camera * (static_cast<double>(r[2]) * drive_.camera.ray({r[0], r[1]}));
      if (classify(world) == Kind::background && !is_on_ground(world)) seeds(pixel) = 255;
    }
    // At its border, errors of the extrinsics would keep pixels of the objects.
    return grown_far(close_returns(seeds, drive_.camera), -margin_px);
  }

 private:
  struct Body {
    cv::Mat1b drawn;
    int margin_px;   // by which it is drawn larger than it is
    double depth_m;  // depth of its nearest part
  };

  // An object where the mask of the frame lacks it, and where the mask shows it.
  struct DrawnObject {
    int number;
    std::string type;
    cv::Mat1b lacking, covered;
  };

  static void add_label(const DrawnObject& object, const cv::Mat1b& drawn, std::vector<Label>& labels) {
    if (cv::countNonZero(drawn) == 0) return;
    Label label;
    label.track = object.number;
    label.type = object.type;
    label.instance = to_outline(drawn);
    labels.push_back(std::move(label));
  }

  // Returns whether an object is in a voxel at the time of the frame, and visible. Without a return there, a stationary object
  // is there for all of its time.
  bool is_visible(const OccupiedVoxel& voxel) const {
    if (time_ns_ <= voxel.first_ns || time_ns_ >= voxel.last_ns) return false;
    if (!drive_.camera.in_front(camera_from_world_ * voxel.center())) return false;
    if (scan_ && std::binary_search(voxel.returns.begin(), voxel.returns.end(), *scan_)) return true;
    const bool is_static = seconds_between(voxel.first_return_ns, voxel.last_return_ns) >= kCompletion.static_s;
    const bool is_between = time_ns_ >= voxel.first_return_ns && time_ns_ <= voxel.last_return_ns;
    if (!is_static && !is_between) return false;
    if (!space_ || !space_->valid()) return true;
    const FreeSpace::Seen seen = space_->judge(voxel.center(), kJudgedRadiusM);
    return seen != FreeSpace::Seen::passed && seen != FreeSpace::Seen::hidden;
  }

  enum class Kind { unknown, object, ground, background };

  Kind classify(const Eigen::Vector3d& world) const {
    const std::optional<double> ground_m = all_.ground_.height(world.head<2>());
    if (ground_m && world.z() < *ground_m + kCompletion.ground_m)
      return columns_.top_near(world.head<2>(), kCompletion.shadow_columns) ? Kind::ground : Kind::background;
    const std::optional<double> top_m = columns_.top_near(world.head<2>(), 1);
    if (top_m) return world.z() < *top_m + kCompletion.top_margin_m ? Kind::object : Kind::background;
    if (!ground_m || world.z() > *ground_m + kCompletion.max_object_m) return Kind::background;
    return find_motion(world);
  }

  bool is_on_ground(const Eigen::Vector3d& world) const {
    const std::optional<double> ground_m = all_.ground_.height(world.head<2>());
    return ground_m && world.z() < *ground_m + kCompletion.ground_m;
  }

  // Sorts the returns of the scan, which are in the image, into objects and background. The scanner observes the background
  // past the edges of objects at other pixels than the camera, so that returns behind an object count where their rays pass
  // beside it.
  BoxSeeds find_seeds(const std::vector<ImageReturn>& returns) const {
    const cv::Size size(drive_.camera.width, drive_.camera.height);
    BoxSeeds seeds{cv::Mat1b(size, uchar{0}), cv::Mat1b(size, uchar{0}), cv::Mat1f(size, 0.F), cv::Mat1b(size, uchar{0})};
    cv::Mat1f object_m(size, 0.F);
    std::vector<Eigen::Vector3d> behind;
    const SE3 world_from_camera = camera_from_world_.inverse();
    for (const ImageReturn& r : returns) {
      const cv::Point pixel(cvRound(r[0]), cvRound(r[1]));
      const Eigen::Vector3d in_camera = static_cast<double>(r[2]) * drive_.camera.ray({r[0], r[1]});
      switch (classify(world_from_camera * in_camera)) {
        case Kind::object:
          seeds.object(pixel) = 255;
          object_m(pixel) = r[2];
          seeds.margin_px(pixel) = static_cast<float>(kCompletion.object_margin_m * drive_.camera.fx) / r[2];
          break;
        case Kind::unknown:
          break;
        case Kind::ground:
          seeds.ground(pixel) = 255;
          break;
        case Kind::background:
          behind.push_back(in_camera);
          break;
      }
    }
    const NearestPixel nearest(seeds.object);
    const Eigen::Vector3d scanner = camera_from_world_ * space_->sensor();
    for (const Eigen::Vector3d& x : behind) {
      const Eigen::Vector2d at = drive_.camera.project(x);
      Eigen::Vector3d beside = x;
      if (const auto object = nearest.find({cvRound(at.x()), cvRound(at.y())}, kCompletion.max_parallax_px)) {
        const double before_m = drive_.camera.is_wide() ? scanner.dot(x.normalized()) : scanner.z();
        const double share = (object_m(*object) - before_m) / (drive_.camera.depth(x) - before_m);
        if (share > 0 && share < 1) beside = scanner + share * (x - scanner);
      }
      const Eigen::Vector2d pixel = drive_.camera.project(beside);
      if (drive_.camera.contains(pixel)) seeds.background(cvRound(pixel.y()), cvRound(pixel.x())) = 255;
    }
    return seeds;
  }

  // Returns whether a return is of a moving object, because a scan shortly before or after shows its position as free, or of
  // the background, because one shows a surface there.
  Kind find_motion(const Eigen::Vector3d& world) const {
    Kind kind = Kind::unknown;
    for (const double offset_s : kCompletion.compared_s) {
      const auto scan = all_.returns_.find_scan(time_ns_ + std::llround(1e9 * offset_s));
      if (!scan || !all_.returns_.is_trusted(*scan)) continue;
      const FreeSpace::Seen seen = all_.returns_.free_space(*scan)->judge(world, kJudgedRadiusM);
      if (seen == FreeSpace::Seen::passed) return Kind::object;
      if (seen == FreeSpace::Seen::hit) kind = Kind::background;
    }
    return kind;
  }

  // Returns whether an object at a position covers more than a few pixels.
  bool is_in_range(const Eigen::Vector3d& world) const { return (camera_from_world_ * world).norm() < kCompletion.max_range_m; }

  ObjectColumns fill_columns(const CompletedObject& object) const {
    ObjectColumns columns;
    if (object.voxels.empty() || object.extent.exteriorDistance(camera_in_world_) >= kCompletion.max_range_m) return columns;
    for (const OccupiedVoxel& voxel : object.voxels)
      if (is_visible(voxel)) columns.add(voxel.center(), 0.5 * kObjectVoxelM);
    return columns;
  }

  std::optional<Box> find_visible_box(const CompletedObject& object) const {
    if (!object.boxes) return std::nullopt;
    std::optional<Box> box = object.boxes->at(time_ns_);
    if (!box || !is_in_range(box->frame_from_box.t)) return std::nullopt;
    return space_ && is_absent_or_hidden(*box, *space_) ? std::nullopt : box;
  }

  // Returns the depth of the nearest corner of a box.
  double find_nearest_depth(const Box& world) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& corner : world.corners())
      nearest = std::min(nearest, drive_.camera.depth(camera_from_world_ * corner));
    return nearest;
  }

  cv::Mat1b draw_box(const Box& world) const {
    Label label;
    label.box = Box{lidar_from_world_ * world.frame_from_box, world.size};
    cv::Mat1b mask = draw_label(label, drive_.camera, drive_.camera_from_lidar, all_.options_);
    const int dilation_px = all_.options_.label_dilation_px();
    const cv::Rect drawn = enlarge(cv::boundingRect(mask), dilation_px, mask.size());
    if (!drawn.empty()) grown(mask(drawn), dilation_px).copyTo(mask(drawn));
    return mask;
  }

  const CompletedObjects& all_;
  const Drive& drive_;
  std::size_t frame_;
  std::int64_t time_ns_;
  SE3 lidar_from_world_, camera_from_world_;
  Eigen::Vector3d camera_in_world_;
  std::optional<std::size_t> scan_;  // taken with the frame
  std::shared_ptr<const FreeSpace> space_;
  ObjectColumns columns_;     // the objects, as far as scans show them
  std::vector<Body> bodies_;  // the same in the image, and labeled 3D boxes
  std::vector<DrawnObject> drawn_;
};

ObjectOutlines CompletedObjects::draw(const CameraMaskEvidence& evidence) const {
  const CameraEvidence& camera = evidence.camera;
  const std::size_t frames = camera.drive.frames.size();
  ObjectOutlines out{FrameLabels(frames), FrameLabels(frames), FrameLabels(frames)};
  const cv::Mat1b fixed = refine_ ? find_fixed_pixels(evidence.masks) : cv::Mat1b();
  parallel_in_order(frames, [&](std::size_t i) {
    const std::optional<SE3> pose = camera.world_from_lidar.at(camera.drive.frames[i].time_ns);
    if (!pose) return;
    FrameDrawing drawing(*this, camera, i, *pose);
    const auto mask = evidence.removed[i];
    for (const auto& [number, object] : objects_) drawing.draw(number, object, *mask);
    if (drawing.is_empty()) return;
    const std::vector<ImageReturn> returns = project_returns(camera.drive, i, camera.world_from_lidar);
    const cv::Mat1b foreground = drawing.find_foreground(returns);
    drawing.add_outlines(foreground, out);
    if (!refine_) return;
    cv::Mat1b background = drawing.find_covered_background(*evidence.masks[i], returns);
    background |= foreground & *mask & ~*evidence.masks[i];  // masks without boxes show their objects themselves
    if (!fixed.empty()) background.setTo(0, fixed);
    if (cv::countNonZero(background) == 0) return;
    out.background[i].emplace_back();
    out.background[i].back().instance = to_outline(background);
  });
  return out;
}

std::vector<ObjectMotion> CompletedObjects::motions() const {
  std::vector<ObjectMotion> out;
  for (const auto& [number, object] : objects_) {
    const bool is_static = std::any_of(object.voxels.begin(), object.voxels.end(), [](const OccupiedVoxel& voxel) {
      return seconds_between(voxel.first_return_ns, voxel.last_return_ns) >= kCompletion.static_s;
    });
    const bool moves = object.boxes ? object.boxes->moves() : !object.tracks.empty();
    out.push_back({number, moves                       ? MotionState::moving
                           : object.boxes || is_static ? MotionState::stationary
                                                       : MotionState::unknown});
  }
  return out;
}

}  // namespace dvi::objects
