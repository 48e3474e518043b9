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
      if (const int part = image.part(*pixels_[i]); part > 0) {
        ++counts.masked;
        add_to_part(part, i);
      }
    }
  }

  MaskVote vote(std::size_t i) const {
    if (!pixels_[i]) return MaskVote::unseen;
    if (is_boxed(i)) return MaskVote::object;
    const int part = image_.part(*pixels_[i]);
    const Counts& counts = things_.at(thing_[i]);
    const bool is_object = counts.masked >= kMaskVoting.min_object_share * counts.visible;
    const bool is_touched = counts.masked >= kMaskVoting.min_touching_share * counts.visible;
    if (part == 0) return is_object || near_(*pixels_[i]) != 0 ? MaskVote::unclear : MaskVote::background;
    if (image_.is_behind(returns_.points[i], *pixels_[i])) return MaskVote::unclear;
    return is_object || (is_touched && dominates(part, thing_[i])) ? MaskVote::object : MaskVote::unclear;
  }

 private:
  struct Counts {
    double visible = 0, masked = 0;
  };
  // The returns of a connected part of the mask.
  struct Part {
    std::map<int, double> returns;  // by thing
    double all = 0;
    double nearest_m = std::numeric_limits<double>::max();
    int nearest_thing = -1;
  };

  void add_to_part(int part, std::size_t i) {
    Part& p = of_part_[part];
    ++p.returns[thing_[i]];
    ++p.all;
    const double depth_m = (image_.frame().camera_from_world * returns_.points[i]).z();
    if (depth_m < p.nearest_m) p.nearest_m = depth_m, p.nearest_thing = thing_[i];
  }

  bool is_boxed(std::size_t i) const {
    const MaskedFrame& frame = image_.frame();
    return is_in_any_box(*frame.labels, frame.lidar_from_world * returns_.points[i], kMaskVoting.box_margin_m);
  }

  bool dominates(int part, int thing) const {
    const Part& p = of_part_.at(part);
    return p.nearest_thing == thing && p.returns.at(thing) >= kMaskVoting.min_dominant_share * p.all;
  }

  const MaskedSurfaces& image_;
  const ObstacleReturns& returns_;
  const std::vector<int>& thing_;
  std::vector<std::optional<cv::Point>> pixels_;
  cv::Mat1b near_;
  std::map<int, Counts> things_;
  std::map<int, Part> of_part_;
};

}  // namespace

MaskedSurfaces::MaskedSurfaces(MaskedFrame frame, const std::vector<Eigen::Vector3d>& returns) : frame_(std::move(frame)) {
  cv::connectedComponents(*frame_.mask, parts_, 8, CV_32S);
  for (const Eigen::Vector3d& world : returns) {
    const auto pixel = frame_.project(world);
    if (!pixel || part(*pixel) == 0) continue;
    double& nearest_m =
        nearest_m_.try_emplace({part(*pixel), strip_of(*pixel)}, std::numeric_limits<double>::max()).first->second;
    nearest_m = std::min(nearest_m, depth_m(world));
  }
}

bool MaskedSurfaces::is_behind(const Eigen::Vector3d& world, cv::Point pixel) const {
  const auto nearest = nearest_m_.find({part(pixel), strip_of(pixel)});
  return nearest != nearest_m_.end() && depth_m(world) > nearest->second + kMaskVoting.max_object_depth_m;
}

std::optional<bool> MaskedSurfaces::shows_masked(const Eigen::Vector3d& world) const {
  const auto pixel = frame_.project(world);
  if (!pixel) return std::nullopt;
  if (is_in_any_box(*frame_.labels, frame_.lidar_from_world * world, kMaskVoting.box_margin_m)) return true;
  if (part(*pixel) > 0 && is_behind(world, *pixel)) return std::nullopt;
  return part(*pixel) > 0;
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
  return MaskedFrame{
      &(*evidence.labels)[frame], &drive.camera,        pose->inverse(), drive.camera_from_lidar * pose->inverse(),
      evidence.removed[frame],    evidence.masks[frame]};
}

std::vector<MaskVote> vote_by_masks(const std::vector<CameraMaskEvidence>& cameras, const ObstacleReturns& returns,
                                    std::int64_t time_ns) {
  std::vector<MaskVote> votes(returns.points.size(), MaskVote::unseen);
  const std::vector<int> thing = group_by_distance(returns.points, kMaskVoting.square_m);
  for (const CameraMaskEvidence& camera : cameras) {
    const std::optional<MaskedFrame> frame = find_masked_frame(camera, time_ns);
    if (!frame) continue;
    const MaskedSurfaces image(*frame, returns.points);
    const MaskedThings things(image, returns, thing);
    for (std::size_t i = 0; i < votes.size(); ++i) votes[i] = std::max(votes[i], things.vote(i));
  }
  return votes;
}

}  // namespace dvi::objects
