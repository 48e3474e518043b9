#pragma once

#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "dvi/align/align.h"
#include "dvi/drive/label.h"
#include "dvi/exposure/exposure.h"
#include "dvi/ground/scan_ground.h"
#include "dvi/inputs/poses.h"
#include "dvi/map/static_map.h"
#include "dvi/objects/find_objects.h"
#include "dvi/result/archive.h"
#include "dvi/synthesize/completed_views.h"

// Lists the fields of the stages' results for StageCache. Only files that call StageCache::load_or_compute() include this.
namespace dvi::result {

constexpr auto fields_of(Of<SE3>) { return std::tuple{&SE3::R, &SE3::t}; }
constexpr auto fields_of(Of<StampedPose>) { return std::tuple{&StampedPose::time_ns, &StampedPose::world_from_body}; }

template <class Archive, class T>
void pass_parts(Archive& archive, T& trajectory, Of<Trajectory>) {
  std::vector<StampedPose> poses = trajectory.poses();
  pass(archive, poses);
  if constexpr (!std::is_const_v<T>) trajectory = Trajectory(std::move(poses));
  pass(archive, trajectory.max_extrapolation);
  pass(archive, trajectory.max_gap);
}

constexpr auto fields_of(Of<odometry::ScanFit>) {
  using odometry::ScanFit;
  return std::tuple{&odometry::ScanFit::state,
                    &odometry::ScanFit::features,
                    &odometry::ScanFit::inliers,
                    &odometry::ScanFit::residual_m,
                    &odometry::ScanFit::degenerate,
                    &odometry::ScanFit::given,
                    &odometry::ScanFit::lag_correction_m,
                    &odometry::ScanFit::information};
}
constexpr auto fields_of(Of<odometry::Odometry>) {
  using odometry::Odometry;
  return std::tuple{&odometry::Odometry::world_from_lidar,
                    &odometry::Odometry::scans,
                    &odometry::Odometry::plane_features,
                    &odometry::Odometry::edge_features,
                    &odometry::Odometry::rings,
                    &odometry::Odometry::warnings,
                    &odometry::Odometry::loops,
                    &odometry::Odometry::largest_correction_m};
}
constexpr auto fields_of(Of<odometry::Sharpness>) {
  using odometry::Sharpness;
  return std::tuple{&odometry::Sharpness::ground_m, &odometry::Sharpness::vertical_m, &odometry::Sharpness::ground_patches,
                    &odometry::Sharpness::vertical_patches};
}
constexpr auto fields_of(Of<diagnostics::ScanTrack>) {
  using diagnostics::ScanTrack;
  return std::tuple{&diagnostics::ScanTrack::first, &diagnostics::ScanTrack::last, &diagnostics::ScanTrack::world_from_lidar};
}
constexpr auto fields_of(Of<diagnostics::PoseReading>) {
  using diagnostics::PoseReading;
  return std::tuple{&diagnostics::PoseReading::words, &diagnostics::PoseReading::as_given, &diagnostics::PoseReading::as_read};
}
constexpr auto fields_of(Of<inputs::PoseChoice>) {
  return std::tuple{&inputs::PoseChoice::from,    &inputs::PoseChoice::odometry, &inputs::PoseChoice::given,
                    &inputs::PoseChoice::loam,    &inputs::PoseChoice::tracks,   &inputs::PoseChoice::misread,
                    &inputs::PoseChoice::warnings};
}
constexpr auto fields_of(Of<registration::PlacementFigures>) {
  using registration::PlacementFigures;
  return std::tuple{&PlacementFigures::target_from_source, &PlacementFigures::overlap,
                    &PlacementFigures::residual_m,         &PlacementFigures::bound_m,
                    &PlacementFigures::bound_deg,          &PlacementFigures::landmarks,
                    &PlacementFigures::landmark_inliers,   &PlacementFigures::passed_share,
                    &PlacementFigures::second_best_ratio};
}
constexpr auto fields_of(Of<inputs::DrivePoses>) {
  return std::tuple{&inputs::DrivePoses::choice, &inputs::DrivePoses::world_from_lidar, &inputs::DrivePoses::placed};
}

constexpr auto fields_of(Of<ground::GroundSquare>) {
  using ground::GroundSquare;
  return std::tuple{&GroundSquare::x, &GroundSquare::y, &GroundSquare::height_m};
}

template <class Archive, class T>
void pass_parts(Archive& archive, T& ground, Of<std::shared_ptr<const ground::ScanGround>>) {
  std::optional<std::vector<ground::GroundSquare>> squares;
  if (ground) squares = ground->squares();
  pass(archive, squares);
  if constexpr (!std::is_const_v<T>) ground = squares ? std::make_shared<const ground::ScanGround>(*squares) : nullptr;
}

constexpr auto fields_of(Of<cv::Size>) { return std::tuple{&cv::Size::width, &cv::Size::height}; }
constexpr auto fields_of(Of<cv::Rect2d>) {
  return std::tuple{&cv::Rect2d::x, &cv::Rect2d::y, &cv::Rect2d::width, &cv::Rect2d::height};
}
constexpr auto fields_of(Of<Instance>) { return std::tuple{&Instance::size, &Instance::runs}; }
constexpr auto fields_of(Of<Box>) { return std::tuple{&Box::frame_from_box, &Box::size}; }
constexpr auto fields_of(Of<Label>) {
  return std::tuple{&Label::track,    &Label::type,   &Label::box,         &Label::rect,
                    &Label::instance, &Label::source, &Label::class_number};
}

template <class Archive, class T>
void pass_parts(Archive& archive, T& labels, Of<SharedLabels>) {
  if constexpr (std::is_const_v<T>) {
    pass(archive, *labels);
  } else {
    FrameLabels read;
    pass(archive, read);
    labels = shared(std::move(read));
  }
}
constexpr auto fields_of(Of<objects::ObjectMotion>) {
  return std::tuple{&objects::ObjectMotion::object, &objects::ObjectMotion::state};
}
constexpr auto fields_of(Of<objects::CameraObjects>) {
  using objects::CameraObjects;
  return std::tuple{&CameraObjects::labels, &CameraObjects::completed, &CameraObjects::shown, &CameraObjects::background,
                    &CameraObjects::motions};
}
constexpr auto fields_of(Of<map::MapPoint>) {
  using map::MapPoint;
  return std::tuple{&map::MapPoint::position, &map::MapPoint::intensity, &map::MapPoint::count, &map::MapPoint::first,
                    &map::MapPoint::last,     &map::MapPoint::normal,    &map::MapPoint::absent};
}
constexpr auto fields_of(Of<map::StaticMap::Tile>) {
  using map::StaticMap;
  return std::tuple{&map::StaticMap::Tile::bounds, &map::StaticMap::Tile::first, &map::StaticMap::Tile::last};
}
constexpr auto fields_of(Of<map::RemovedPoint>) { return std::tuple{&map::RemovedPoint::position, &map::RemovedPoint::cause}; }
constexpr auto fields_of(Of<map::MapScan>) {
  return std::tuple{&map::MapScan::drive, &map::MapScan::time_ns, &map::MapScan::sensor};
}
constexpr auto fields_of(Of<map::MapCounts>) {
  using map::MapCounts;
  return std::tuple{
      &map::MapCounts::returns, &map::MapCounts::masked,   &map::MapCounts::boxed, &map::MapCounts::unseen_by_camera,
      &map::MapCounts::moved,   &map::MapCounts::too_near, &map::MapCounts::scans, &map::MapCounts::scans_without_pose};
}
constexpr auto fields_of(Of<map::StaticMap>) {
  using map::StaticMap;
  return std::tuple{&map::StaticMap::points, &map::StaticMap::tiles, &map::StaticMap::removed, &map::StaticMap::scans,
                    &map::StaticMap::counts};
}

constexpr auto fields_of(Of<exposure::Gains>) {
  return std::tuple{&exposure::Gains::of_view, &exposure::Gains::compared, &exposure::Gains::vignetting};
}

constexpr auto fields_of(Of<align::ViewAlignment>) {
  using align::ViewAlignment;
  return std::tuple{&ViewAlignment::rotation, &ViewAlignment::position, &ViewAlignment::offset_before_px,
                    &ViewAlignment::offset_after_px, &ViewAlignment::points};
}
constexpr auto fields_of(Of<align::SequenceAlignment>) {
  using align::SequenceAlignment;
  return std::tuple{&SequenceAlignment::kept, &SequenceAlignment::mounting, &SequenceAlignment::warnings};
}
constexpr auto fields_of(Of<align::Cameras>) {
  using align::Cameras;
  return std::tuple{&Cameras::camera_from_world, &Cameras::views, &Cameras::sequences};
}
constexpr auto fields_of(Of<synthesize::CompletedView>) {
  using synthesize::CompletedView;
  return std::tuple{&CompletedView::view, &CompletedView::pixels, &CompletedView::colors, &CompletedView::depths_m};
}

}  // namespace dvi::result
