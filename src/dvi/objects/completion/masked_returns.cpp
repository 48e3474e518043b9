#include "dvi/objects/completion/masked_returns.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "dvi/drive/nearest_in_time.h"
#include "dvi/drive/removed_at.h"
#include "dvi/image/region.h"
#include "dvi/objects/clusters.h"
#include "dvi/objects/completion/box_masks.h"

namespace dvi::objects {
namespace {

struct MaskVoteParams {
  double square_m = 0.3;            ///< edge of the squares that group returns; cars are parked 0.5 m apart
  double min_object_share = 0.7;    ///< masked share of the visible returns of an object
  double min_dominant_share = 0.6;  ///< share of a mask's returns that its object has if other things touch the object ...
  double min_touching_share = 0.3;  ///< ... and masked share of the visible returns of both together
  double box_margin_m = 0.1;        ///< error of 3D boxes
  int strip_px = 8;                 ///< width of the vertical strips of a mask in which its nearest returns are searched
  double max_object_depth_m = 1.5;  ///< a return this far behind the nearest one of its strip may be behind the object
  double min_box_share = 0.5;       ///< width and height of an object, relative to its bounding box; its windows return little
  int boundary_px = 3;              ///< beside a mask, a return may belong to the object: masks and poses have errors
};
constexpr MaskVoteParams kMaskVoting;

int strip_of(cv::Point pixel) { return pixel.x / kMaskVoting.strip_px; }

// The things of one scan in the image of one camera.
class MaskedThings {
 public:
  MaskedThings(const MaskedSurfaces& image, const ObstacleReturns& returns, const std::vector<int>& thing)
      : image_(image), returns_(returns), thing_(thing), pixels_(returns.points.size()) {
    near_ = grown(*image.frame().removed, kMaskVoting.boundary_px);
    for (std::size_t i = 0; i < returns.points.size(); ++i) {
      pixels_[i] = image.frame().project(returns.points[i]);
      if (!pixels_[i]) continue;
      Counts& counts = things_[thing_[i]];
      ++counts.visible;
      if (!image.is_masked(*pixels_[i])) continue;
      ++counts.masked;
      for (const int region : image.regions_at(*pixels_[i])) add_to_region(region, i);
    }
    for (auto& [region, things] : of_region_) find_boxed_thing(region, things);
  }

  MaskVote vote(std::size_t i) const {
    if (!pixels_[i]) return MaskVote::unseen;
    if (is_boxed(i)) return MaskVote::object;
    const Counts& counts = things_.at(thing_[i]);
    const bool is_object = counts.masked >= kMaskVoting.min_object_share * counts.visible;
    if (!image_.is_masked(*pixels_[i])) return is_object || near_(*pixels_[i]) != 0 ? MaskVote::unclear : MaskVote::background;
    if (image_.is_behind(returns_.points[i], *pixels_[i])) return MaskVote::unclear;
    const bool is_touched = counts.masked >= kMaskVoting.min_touching_share * counts.visible;
    const std::vector<int> regions = image_.regions_at(*pixels_[i]);
    const auto shows = [&](int region) {
      if (image_.box_of(region)) return is_touched && of_region_.at(region).boxed_thing == thing_[i];
      return is_object || (is_touched && dominates(region, thing_[i]));
    };
    return std::any_of(regions.begin(), regions.end(), shows) ? MaskVote::object : MaskVote::unclear;
  }

 private:
  struct Counts {
    double visible = 0, masked = 0;
  };
  // A thing in a region of the mask.
  struct Extent {
    double returns = 0;
    double nearest_m = std::numeric_limits<double>::max();
    cv::Rect box;  // extent of its returns in the image
  };
  struct Region {
    std::map<int, Extent> things;
    double returns = 0;
    int boxed_thing = -1;  // the object that a bounding box shows
  };

  void add_to_region(int region, std::size_t i) {
    Region& r = of_region_[region];
    Extent& extent = r.things[thing_[i]];
    ++r.returns;
    ++extent.returns;
    extent.nearest_m =
        std::min(extent.nearest_m, image_.frame().camera->depth(image_.frame().camera_from_world * returns_.points[i]));
    extent.box |= cv::Rect(*pixels_[i], cv::Size(1, 1));
  }

  // Finds the nearest thing that extends over most of a bounding box.
  void find_boxed_thing(int region, Region& things) const {
    const std::optional<cv::Rect> box = image_.box_of(region);
    if (!box) return;
    double nearest_m = std::numeric_limits<double>::max();
    for (const auto& [thing, extent] : things.things) {
      if (extent.box.width < kMaskVoting.min_box_share * box->width || extent.nearest_m >= nearest_m) continue;
      if (extent.box.height < kMaskVoting.min_box_share * box->height) continue;
      nearest_m = extent.nearest_m;
      things.boxed_thing = thing;
    }
  }

  bool is_boxed(std::size_t i) const {
    const MaskedFrame& frame = image_.frame();
    return is_in_any_box(*frame.labels, frame.lidar_from_world * returns_.points[i], kMaskVoting.box_margin_m);
  }

  bool dominates(int region, int thing) const {
    const Region& r = of_region_.at(region);
    const Extent& own = r.things.at(thing);
    const bool is_nearest = std::all_of(r.things.begin(), r.things.end(),
                                        [&](const auto& other) { return other.second.nearest_m >= own.nearest_m; });
    return is_nearest && own.returns >= kMaskVoting.min_dominant_share * r.returns;
  }

  const MaskedSurfaces& image_;
  const ObstacleReturns& returns_;
  const std::vector<int>& thing_;
  std::vector<std::optional<cv::Point>> pixels_;
  cv::Mat1b near_;
  std::map<int, Counts> things_;
  std::map<int, Region> of_region_;
};

}  // namespace

MaskedSurfaces::MaskedSurfaces(MaskedFrame frame, const std::vector<Eigen::Vector3d>& returns) : frame_(std::move(frame)) {
  cv::Mat1i stats;
  cv::Mat centers;
  // A region per part, then those of the boxes.
  int regions = cv::connectedComponentsWithStats(*frame_.mask, parts_, stats, centers, 8, CV_32S);
  boxes_.resize(static_cast<std::size_t>(regions));
  for (int part = 1; part < stats.rows; ++part) {
    const cv::Rect area = box_of_part(stats, part);
    for (const cv::Rect& within : split_into_boxes(cv::Mat1b(parts_(area) == part))) {
      const cv::Rect box = within + area.tl();
      box_of_.emplace(regions, box);
      boxes_[static_cast<std::size_t>(part)].emplace_back(regions++, box);
    }
  }
  for (const Eigen::Vector3d& world : returns) {
    const auto pixel = frame_.project(world);
    if (!pixel) continue;
    for (const int region : regions_at(*pixel)) {
      double& nearest_m = nearest_m_.try_emplace({region, strip_of(*pixel)}, std::numeric_limits<double>::max()).first->second;
      nearest_m = std::min(nearest_m, depth_m(world));
    }
  }
}

std::vector<int> MaskedSurfaces::regions_at(cv::Point pixel) const {
  std::vector<int> out;
  const int part = parts_(pixel);
  if (part == 0) return out;
  for (const auto& [region, box] : boxes_[static_cast<std::size_t>(part)])
    if (box.contains(pixel)) out.push_back(region);
  if (out.empty()) out.push_back(part);
  return out;
}

std::optional<cv::Rect> MaskedSurfaces::box_of(int region) const {
  const auto found = box_of_.find(region);
  return found == box_of_.end() ? std::nullopt : std::optional(found->second);
}

bool MaskedSurfaces::is_behind(const Eigen::Vector3d& world, cv::Point pixel, int region) const {
  const auto nearest = nearest_m_.find({region, strip_of(pixel)});
  return nearest != nearest_m_.end() && depth_m(world) > nearest->second + kMaskVoting.max_object_depth_m;
}

bool MaskedSurfaces::is_behind(const Eigen::Vector3d& world, cv::Point pixel) const {
  const std::vector<int> regions = regions_at(pixel);
  return std::all_of(regions.begin(), regions.end(), [&](int region) { return is_behind(world, pixel, region); });
}

std::optional<bool> MaskedSurfaces::shows_masked(const Eigen::Vector3d& world) const {
  const auto pixel = frame_.project(world);
  if (!pixel) return std::nullopt;
  if (is_in_any_box(*frame_.labels, frame_.lidar_from_world * world, kMaskVoting.box_margin_m)) return true;
  if (is_masked(*pixel) && is_behind(world, *pixel)) return std::nullopt;
  return is_masked(*pixel);
}

std::optional<cv::Point> MaskedFrame::project(const Eigen::Vector3d& world) const {
  const Eigen::Vector3d in_camera = camera_from_world * world;
  if (!camera->in_front(in_camera)) return std::nullopt;
  const Eigen::Vector2d pixel = camera->project(in_camera);
  if (!camera->contains(pixel)) return std::nullopt;
  return cv::Point(cvRound(pixel.x()), cvRound(pixel.y()));
}

std::optional<MaskedFrame> find_masked_frame(const CameraMaskEvidence& evidence, std::int64_t time_ns) {
  const Drive& drive = evidence.camera.drive;
  const Frame* const nearest = nearest_in_time(drive.frames, time_ns, kMaxFrameToScanNs);
  if (!nearest) return std::nullopt;
  const std::optional<SE3> pose = evidence.camera.world_from_lidar.at(nearest->time_ns);
  if (!pose) return std::nullopt;
  const auto frame = static_cast<std::size_t>(nearest - drive.frames.data());
  return MaskedFrame{&(*evidence.labels)[frame],
                     &drive.camera,
                     pose->inverse(),
                     drive.camera_from_lidar * pose->inverse(),
                     evidence.removed[frame],
                     evidence.masks[frame],
                     frame};
}

std::vector<MaskVote> vote_by_masks(const std::vector<CameraMaskEvidence>& cameras, const ObstacleReturns& returns,
                                    std::int64_t time_ns) {
  std::vector<MaskVote> votes(returns.points.size(), MaskVote::unseen);
  std::vector<char> masked(votes.size()), unmasked(votes.size());  // by any camera
  const std::vector<int> thing = group_by_distance(returns.points, kMaskVoting.square_m);
  for (const CameraMaskEvidence& camera : cameras) {
    const std::optional<MaskedFrame> frame = find_masked_frame(camera, time_ns);
    if (!frame) continue;
    const MaskedSurfaces image(*frame, returns.points);
    const MaskedThings things(image, returns, thing);
    const bool has_mask = cv::countNonZero(*frame->removed) > 0;
    for (std::size_t i = 0; i < votes.size(); ++i) {
      const MaskVote vote = things.vote(i);
      masked[i] |= vote == MaskVote::object;
      unmasked[i] |= has_mask && vote == MaskVote::background;
      votes[i] = masked[i] && unmasked[i] ? MaskVote::disputed : std::max(votes[i], vote);
    }
  }
  return votes;
}

}  // namespace dvi::objects
