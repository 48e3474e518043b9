#include "dvi/objects/object_returns.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "dvi/drive/deskew.h"
#include "dvi/objects/clusters.h"
#include "dvi/objects/completion/object_columns.h"
#include "dvi/objects/label_masks.h"

namespace dvi::objects {
namespace {

struct ColumnReturnParams {
  double min_height_m = 0.05;  ///< above the ground; lower returns are on the ground
  double margin_m = 0.05;      ///< above the highest return of a column: noise of ranges
  double box_margin_m = 0.1;   ///< error of 3D boxes
  double max_drift_m = 3;      ///< motion of an object within half of a scan
  double max_low_m = 0.3;      ///< height up to which wheels and feet extend beside the columns of the returns above
  double path_length_m = 5;    ///< from the returns of an object along its path to others in its outline
  double path_margin_m = 0.2;  ///< beside the returns of an object
  double square_m = 0.75;  ///< edge of the squares that group moving returns with their object; rays along its side are sparse
};
constexpr ColumnReturnParams kColumnReturn;

// Returns the upper bits of the label of a return of an object.
std::uint32_t instance_of(const std::optional<int>& number) {
  return std::min(number ? static_cast<std::uint32_t>(*number) : kUnnumberedInstance, kUnnumberedInstance) << 16U;
}

// The numbers of the objects that labels show in one frame.
class NumberFinder {
 public:
  NumberFinder(const ObjectCamera& camera, const MaskedFrame& frame, const MaskOptions& options) : frame_(frame) {
    const Drive& drive = camera.evidence.camera.drive;
    numbers_ = cv::Mat1i(drive.camera.height, drive.camera.width, -1);
    for (const SharedLabels& labels : camera.objects)
      for (const Label& label : (*labels)[frame.index])
        if (label.track >= 0) numbers_.setTo(label.track, draw_label(label, drive.camera, drive.camera_from_lidar, options));
  }

  // Returns the number of the object at a position in world axes: of the labeled 3D box, else of the outline; nothing if there
  // is neither.
  std::optional<int> find(const Eigen::Vector3d& world) const {
    const Eigen::Vector3d in_lidar = frame_.lidar_from_world * world;
    for (const Label& label : *frame_.labels)
      if (label.box && label.track >= 0 && label.box->contains(in_lidar, kColumnReturn.box_margin_m)) return label.track;
    const std::optional<cv::Point> pixel = frame_.project(world);
    return pixel && numbers_(*pixel) >= 0 ? std::optional(numbers_(*pixel)) : std::nullopt;
  }

 private:
  const MaskedFrame& frame_;
  cv::Mat1i numbers_;
};

// The area that the known returns of an object in one scan cover along its path, seen from above.
class ObjectPath {
 public:
  ObjectPath(const std::vector<Eigen::Vector2d>& points, const Eigen::Vector2d& heading) : heading_(heading) {
    for (const Eigen::Vector2d& point : points) area_.extend(to_path(point));
    const Eigen::Vector2d margin_m(kColumnReturn.path_length_m, kColumnReturn.path_margin_m);
    area_ = {area_.min() - margin_m, area_.max() + margin_m};
  }

  bool contains(const Eigen::Vector2d& point) const { return area_.contains(to_path(point)); }

 private:
  // Returns the position along the heading and to its left.
  Eigen::Vector2d to_path(const Eigen::Vector2d& point) const {
    return {point.dot(heading_), point.y() * heading_.x() - point.x() * heading_.y()};
  }

  Eigen::Vector2d heading_;
  Eigen::AlignedBox2d area_;
};

}  // namespace

// The columns that objects fill in one scan.
class ObjectReturns::ScanColumns {
 public:
  // Extends the column of an object up to a height. A column belongs to the object that was added first.
  void add(int number, const Eigen::Vector3d& point, double half_height_m) {
    const Eigen::Vector3i index = voxel_at(point);
    Column& column = columns_.try_emplace(std::pair(index.x(), index.y()), Column{number, point.z()}).first->second;
    if (column.number == number) column.top_m = std::max(column.top_m, point.z() + half_height_m);
  }

  bool empty() const { return columns_.empty(); }
  bool contains(const Eigen::Vector3d& point) const { return find(point).has_value(); }
  // Returns the number of the object in whose column a point is.
  std::optional<int> find(const Eigen::Vector3d& point) const {
    const Eigen::Vector3i index = voxel_at(point);
    const auto column = columns_.find({index.x(), index.y()});
    if (column == columns_.end() || point.z() > column->second.top_m + kColumnReturn.margin_m) return std::nullopt;
    return column->second.number;
  }
  // Returns the number of the object of a column beside that of a point, at any height.
  std::optional<int> find_beside(const Eigen::Vector3d& point) const {
    const Eigen::Vector3i index = voxel_at(point);
    for (int x = index.x() - 1; x <= index.x() + 1; ++x) {
      const auto column = columns_.lower_bound({x, index.y() - 1});
      if (column != columns_.end() && column->first <= std::pair(x, index.y() + 1)) return column->second.number;
    }
    return std::nullopt;
  }

 private:
  struct Column {
    int number;
    double top_m;
  };
  std::map<std::pair<int, int>, Column> columns_;
};

ObjectReturns::ObjectReturns(ScannedObjects objects) : all_(std::move(objects)) {}

PointLabels ObjectReturns::label(std::size_t scan) const {
  const auto returns = all_.drive.scans[scan];
  PointLabels out{std::vector<std::uint32_t>(returns->size(), 0)};
  if (!all_.ground) return out;
  const std::vector<Eigen::Vector3d> world = to_world(*returns, all_.drive.scan_headers[scan], all_.world_from_lidar);
  if (world.empty()) return out;
  const ScanColumns columns = fill_columns(scan);
  const auto given = all_.drive.point_labels.empty() ? nullptr : all_.drive.point_labels[scan];
  for (std::size_t i = 0; i < world.size(); ++i) {
    const std::optional<int> number = find_object(world[i], columns);
    if (given && given->values[i] != 0)
      out.values[i] = instance_of(number) | static_cast<std::uint32_t>(class_of_point(given->values[i]));
    else if (number)
      out.values[i] = instance_of(number) | class_of(*number);
  }
  return out;
}

std::optional<int> ObjectReturns::find_object(const Eigen::Vector3d& world, const ScanColumns& columns) const {
  const std::optional<int> inside = columns.find(world);
  const std::optional<int> number = inside ? inside : columns.find_beside(world);
  if (!number) return std::nullopt;
  const std::optional<double> ground_m = all_.ground->height(world.head<2>());
  if (!ground_m) return inside;
  const double height_m = world.z() - *ground_m;
  const bool is_object = height_m > kColumnReturn.min_height_m && (inside || height_m < kColumnReturn.max_low_m);
  return is_object ? number : std::nullopt;
}

ObjectReturns::ScanColumns ObjectReturns::fill_columns(std::size_t scan) const {
  ScanColumns columns;
  for (const auto& [number, object] : all_.objects) {
    for (const SharedTrack& track : object.tracks)
      for (const Cluster& observation : track->observations)
        if (observation.scan == scan)
          for (const ClusterReturn& r : observation.returns)
            columns.add(number, r.point, 0.5 * std::min(r.ray_spacing_m, kObjectVoxelM));
    for (const OccupiedVoxel& voxel : object.voxels)
      if (std::binary_search(voxel.returns.begin(), voxel.returns.end(), scan))
        columns.add(number, voxel.center(), 0.5 * kObjectVoxelM);
  }
  add_boxed(scan, columns);
  for (const ObjectCamera& camera : all_.cameras)
    if (camera.evidence.camera.shows_objects()) add_masked(camera, scan, columns);
  if (!all_.all_moving) return columns;
  const ObstacleReturns voted = std::move(all_.returns->vote(scan, scan + 1).front());
  add_moving(scan, voted, columns);
  for (const ObjectCamera& camera : all_.cameras) add_outlined(camera, scan, voted, columns);
  return columns;
}

// Adds the returns in labeled 3D boxes, each at the time of the return.
void ObjectReturns::add_boxed(std::size_t scan, ScanColumns& columns) const {
  const auto obstacles = all_.returns->obstacles(scan);
  for (const auto& [number, object] : all_.objects) {
    const std::optional<Box> near = object.boxes ? object.boxes->at(all_.returns->time_ns(scan)) : std::nullopt;
    if (!near) continue;
    for (std::size_t i = 0; i < obstacles->points.size(); ++i) {
      const Eigen::Vector3d& point = obstacles->points[i];
      if (!near->contains(point, kColumnReturn.max_drift_m)) continue;
      if (object.boxes->at(obstacles->time_ns[i]).value_or(*near).contains(point, kColumnReturn.box_margin_m))
        columns.add(number, point, 0.5 * std::min(obstacles->ray_spacing_m[i], kObjectVoxelM));
    }
  }
}

// Adds the moving returns close to an object, because a scan may show a part of it that its box lacks, and those at the
// predicted position of an object that has no observation in this scan.
void ObjectReturns::add_moving(std::size_t scan, const ObstacleReturns& obstacles, ScanColumns& columns) const {
  std::vector<std::size_t> members;
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < obstacles.points.size(); ++i) {
    if (obstacles.vote[i] != VisibilityVote::moving && !columns.contains(obstacles.points[i])) continue;
    members.push_back(i);
    points.push_back(obstacles.points[i]);
  }
  const std::vector<int> groups = group_by_distance(points, kColumnReturn.square_m);
  std::map<int, std::vector<std::pair<Eigen::Vector3d, int>>> numbered;  // by group
  const std::vector<std::pair<int, ObjectColumns>> predicted = predict_columns(scan);
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (const std::optional<int> number = columns.find(points[k])) numbered[groups[k]].emplace_back(points[k], *number);
    for (const auto& [number, object] : predicted)
      if (object.top_near(points[k].head<2>(), 1)) numbered[groups[k]].emplace_back(points[k], number);
  }
  const ScanColumns known = columns;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto group = numbered.find(groups[k]);
    if (group == numbered.end() || known.contains(points[k])) continue;
    const auto nearest = std::min_element(group->second.begin(), group->second.end(), [&](const auto& a, const auto& b) {
      return (a.first - points[k]).squaredNorm() < (b.first - points[k]).squaredNorm();
    });
    columns.add(nearest->second, points[k], 0.5 * std::min(obstacles.ray_spacing_m[members[k]], kObjectVoxelM));
  }
}

// Adds the returns in the outline of an object that lie on its path ahead of or behind its other returns, such as those on the
// sides of a vehicle ahead. Their votes are not used: a vehicle that drives ahead covers the same positions in several scans.
void ObjectReturns::add_outlined(const ObjectCamera& camera, std::size_t scan, const ObstacleReturns& obstacles,
                                 ScanColumns& columns) const {
  const std::optional<MaskedFrame> frame = find_masked_frame(camera.evidence, all_.returns->time_ns(scan));
  if (!frame) return;
  std::map<int, std::vector<Eigen::Vector2d>> known;  // by number
  for (const Eigen::Vector3d& point : obstacles.points)
    if (const std::optional<int> number = columns.find(point)) known[*number].emplace_back(point.head<2>());
  std::map<int, ObjectPath> paths;
  for (const auto& [number, points] : known)
    if (const auto heading = find_heading(number, scan)) paths.emplace(number, ObjectPath(points, *heading));
  if (paths.empty()) return;
  const NumberFinder numbers(camera, *frame, all_.options);
  for (std::size_t i = 0; i < obstacles.points.size(); ++i) {
    const Eigen::Vector3d& point = obstacles.points[i];
    if (columns.contains(point)) continue;
    const std::optional<int> number = numbers.find(point);
    const auto path = number ? paths.find(*number) : paths.end();
    if (path != paths.end() && path->second.contains(point.head<2>()))
      columns.add(*number, point, 0.5 * std::min(obstacles.ray_spacing_m[i], kObjectVoxelM));
  }
}

// Returns the direction of motion of a tracked object at the time of a scan; nothing if it is unknown.
std::optional<Eigen::Vector2d> ObjectReturns::find_heading(int number, std::size_t scan) const {
  const auto object = all_.objects.find(number);
  if (object == all_.objects.end() || object->second.tracks.empty()) return std::nullopt;
  const Track& track = *object->second.tracks.front();
  return track.observations.empty() ? std::nullopt : track.heading(track.nearest(all_.returns->time_ns(scan)));
}

// Predicts the columns of tracked objects without an observation in a scan.
std::vector<std::pair<int, ObjectColumns>> ObjectReturns::predict_columns(std::size_t scan) const {
  std::vector<std::pair<int, ObjectColumns>> out;
  for (const auto& [number, object] : all_.objects)
    for (const SharedTrack& track : object.tracks) {
      const auto observes = [scan](const Cluster& observation) { return observation.scan == scan; };
      if (std::any_of(track->observations.begin(), track->observations.end(), observes)) continue;
      if (ObjectColumns columns = objects::fill_columns(*track, all_.returns->time_ns(scan)); !columns.empty())
        out.emplace_back(number, std::move(columns));
    }
  return out;
}

void ObjectReturns::add_masked(const ObjectCamera& camera, std::size_t scan, ScanColumns& columns) const {
  const std::int64_t time_ns = all_.returns->time_ns(scan);
  const std::optional<MaskedFrame> frame = find_masked_frame(camera.evidence, time_ns);
  if (!frame) return;
  const auto obstacles = all_.returns->obstacles(scan);
  const std::vector<MaskVote> votes = vote_by_masks({camera.evidence}, *obstacles, time_ns);
  const NumberFinder numbers(camera, *frame, all_.options);
  for (std::size_t i = 0; i < votes.size(); ++i) {
    if (votes[i] != MaskVote::object || columns.contains(obstacles->points[i])) continue;
    const std::optional<int> number = numbers.find(obstacles->points[i]);
    columns.add(number.value_or(static_cast<int>(kUnnumberedInstance)), obstacles->points[i],
                0.5 * std::min(obstacles->ray_spacing_m[i], kObjectVoxelM));
  }
}

std::uint32_t ObjectReturns::class_of(int number) const {
  const auto type = all_.types.find(number);
  const auto motion = all_.motions.find(number);
  const bool moves = motion != all_.motions.end() && motion->second == MotionState::moving;
  return static_cast<std::uint32_t>(point_class_id(type == all_.types.end() ? "" : type->second, moves));
}

}  // namespace dvi::objects
