#pragma once

#include <type_traits>
#include <utility>
#include <vector>

#include "dvi/align/align.h"
#include "dvi/drive/label.h"
#include "dvi/exposure/exposure.h"
#include "dvi/map/static_map.h"
#include "dvi/pipeline/archive.h"
#include "dvi/pipeline/poses.h"

// What the results of the stages are made of, for KeptStages: only who keeps stages includes this.
namespace dvi::pipeline {

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
  return std::tuple{&ScanFit::state,      &ScanFit::features, &ScanFit::inliers,          &ScanFit::residual_m,
                    &ScanFit::degenerate, &ScanFit::given,    &ScanFit::lag_correction_m, &ScanFit::information};
}
constexpr auto fields_of(Of<odometry::Odometry>) {
  using odometry::Odometry;
  return std::tuple{
      &Odometry::world_from_lidar, &Odometry::scans, &Odometry::plane_features,      &Odometry::edge_features, &Odometry::rings,
      &Odometry::warnings,         &Odometry::loops, &Odometry::largest_correction_m};
}
constexpr auto fields_of(Of<odometry::Sharpness>) {
  using odometry::Sharpness;
  return std::tuple{&Sharpness::ground_m, &Sharpness::vertical_m, &Sharpness::ground_patches, &Sharpness::vertical_patches};
}
constexpr auto fields_of(Of<plausibility::ScanTrack>) {
  using plausibility::ScanTrack;
  return std::tuple{&ScanTrack::first, &ScanTrack::last, &ScanTrack::world_from_lidar};
}
constexpr auto fields_of(Of<plausibility::PoseReading>) {
  using plausibility::PoseReading;
  return std::tuple{&PoseReading::words, &PoseReading::as_given, &PoseReading::as_read};
}
constexpr auto fields_of(Of<PoseChoice>) {
  return std::tuple{&PoseChoice::from,   &PoseChoice::odometry, &PoseChoice::given,   &PoseChoice::loam,
                    &PoseChoice::tracks, &PoseChoice::misread,  &PoseChoice::warnings};
}
constexpr auto fields_of(Of<registration::PlacementFigures>) {
  using registration::PlacementFigures;
  return std::tuple{&PlacementFigures::target_from_source,
                    &PlacementFigures::overlap,
                    &PlacementFigures::residual_m,
                    &PlacementFigures::bound_m,
                    &PlacementFigures::bound_deg,
                    &PlacementFigures::things,
                    &PlacementFigures::things_agree,
                    &PlacementFigures::passed_share,
                    &PlacementFigures::rival};
}
constexpr auto fields_of(Of<DrivePoses>) {
  return std::tuple{&DrivePoses::choice, &DrivePoses::world_from_lidar, &DrivePoses::placed};
}

constexpr auto fields_of(Of<cv::Size>) { return std::tuple{&cv::Size::width, &cv::Size::height}; }
constexpr auto fields_of(Of<cv::Rect2d>) {
  return std::tuple{&cv::Rect2d::x, &cv::Rect2d::y, &cv::Rect2d::width, &cv::Rect2d::height};
}
constexpr auto fields_of(Of<Instance>) { return std::tuple{&Instance::size, &Instance::runs}; }
constexpr auto fields_of(Of<Box>) { return std::tuple{&Box::frame_from_box, &Box::size}; }
constexpr auto fields_of(Of<Label>) {
  return std::tuple{&Label::track, &Label::type, &Label::box, &Label::rect, &Label::instance};
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
constexpr auto fields_of(Of<map::MapPoint>) {
  using map::MapPoint;
  return std::tuple{&MapPoint::position, &MapPoint::intensity, &MapPoint::count, &MapPoint::first,
                    &MapPoint::last,     &MapPoint::normal,    &MapPoint::absent};
}
constexpr auto fields_of(Of<map::StaticMap::Tile>) {
  using map::StaticMap;
  return std::tuple{&StaticMap::Tile::bounds, &StaticMap::Tile::first, &StaticMap::Tile::last};
}
constexpr auto fields_of(Of<map::RemovedPoint>) { return std::tuple{&map::RemovedPoint::position, &map::RemovedPoint::cause}; }
constexpr auto fields_of(Of<map::MapScan>) {
  return std::tuple{&map::MapScan::drive, &map::MapScan::time_ns, &map::MapScan::sensor};
}
constexpr auto fields_of(Of<map::MapCounts>) {
  using map::MapCounts;
  return std::tuple{&MapCounts::returns, &MapCounts::masked,   &MapCounts::boxed, &MapCounts::unseen_by_camera,
                    &MapCounts::moved,   &MapCounts::too_near, &MapCounts::scans, &MapCounts::scans_without_pose};
}
constexpr auto fields_of(Of<map::StaticMap>) {
  using map::StaticMap;
  return std::tuple{&StaticMap::points, &StaticMap::tiles, &StaticMap::removed, &StaticMap::scans, &StaticMap::counts};
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

}  // namespace dvi::pipeline
