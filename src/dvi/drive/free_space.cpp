#include "dvi/drive/free_space.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <opencv2/imgproc.hpp>

namespace dvi {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr int kColumns = 1800;
constexpr float kCellRad = 2 * kPi / kColumns;  // 0.2 degrees, the approximate resolution of LiDARs
constexpr int kPaddingColumns = 24;             // repeated beyond the seam, as wide as the widest window
constexpr float kStepsPerMeter = 512;           // the unit of stored ranges
constexpr ushort kNoReturn = 0xFFFF;            // returns beyond 128 m are stored as at 128 m, which is beyond kMaxRangeM
constexpr float kMinRangeM = 0.5F;              // nearer returns mark rays without a return

// The error is below 1e-4 radians, 3 % of a cell; the function is five times as fast as that of the library.
float fast_atan2(float y, float x) {
  const float ax = std::abs(x), ay = std::abs(y);
  const float a = std::min(ax, ay) / std::max(std::max(ax, ay), 1e-20F), s = a * a;
  float angle = ((-0.0464964749F * s + 0.15931422F) * s - 0.327622764F) * s * a + a;
  if (ay > ax) angle = kPi / 2 - angle;
  if (x < 0) angle = kPi - angle;
  return y < 0 ? -angle : angle;
}

// Rounds as std::lround() does, without its call: the sum is exact. Returns 0 for numbers that are not finite.
int round_to_int(float value) {
  const double x = value;
  if (!(std::abs(x) < 1e9)) return 0;
  return static_cast<int>(x < 0 ? x - 0.5 : x + 0.5);
}

float compute_elevation(const Eigen::Vector3f& p) { return fast_atan2(p.z(), std::sqrt(p.x() * p.x() + p.y() * p.y())); }

int find_column(const Eigen::Vector3f& p) {
  const int column = round_to_int((fast_atan2(p.y(), p.x()) + kPi) / kCellRad);
  return column < kColumns ? column : 0;
}

ushort to_steps(float range_m) { return static_cast<ushort>(std::min(range_m * kStepsPerMeter + 0.5F, kNoReturn - 1.0F)); }

bool is_return(const Eigen::Vector3f& p) { return p.squaredNorm() > kMinRangeM * kMinRangeM; }

// Estimates the number of cells between rays, vertically and horizontally, from the fill of the fullest columns and rows.
cv::Size estimate_spacing(const cv::Mat1w& nearest) {
  std::vector<int> in_column(nearest.cols, 0), in_row(nearest.rows, 0);
  for (int y = 0; y < nearest.rows; ++y)
    for (int x = 0; x < nearest.cols; ++x)
      if (nearest(y, x) < kNoReturn) {
        ++in_column[x];
        ++in_row[y];
      }
  std::erase(in_column, 0);
  const auto tenth = in_column.begin() + static_cast<std::ptrdiff_t>(in_column.size() * 9 / 10);
  std::nth_element(in_column.begin(), tenth, in_column.end());
  const int across = *std::max_element(in_row.begin(), in_row.end());
  return {std::clamp(cvRound(static_cast<double>(nearest.cols) / across), 1, 8),
          std::clamp(cvRound((nearest.rows - 1.0) / std::max(1, *tenth - 1)), 1, 15)};
}

}  // namespace

FreeSpace::FreeSpace(const Scan& scan, const ScanHeader& header, const Trajectory& world_from_lidar, double pose_error_m)
    : pose_error_(pose_error_m) {
  high_ = -kPi;
  low_ = kPi;
  for (const Eigen::Vector3f& p : scan.points)
    if (is_return(p)) {
      const float elevation = compute_elevation(p);
      low_ = std::min(low_, elevation);
      high_ = std::max(high_, elevation);
    }
  if (low_ > high_) return;
  place(scan, header, world_from_lidar);
  if (!valid()) return;
  cv::Mat1w nearest(round_to_int((high_ - low_) / kCellRad) + 1, kColumns, kNoReturn);
  for (const Eigen::Vector3f& p : scan.points)
    if (is_return(p)) {
      ushort& cell = nearest(round_to_int((compute_elevation(p) - low_) / kCellRad), find_column(p));
      cell = std::min(cell, to_steps(p.norm()));
    }
  erode(nearest);
}

// Stores the sensor's pose at the time of each column; columns without returns get that of the previous one.
void FreeSpace::place(const Scan& scan, const ScanHeader& header, const Trajectory& world_from_lidar) {
  std::vector<std::optional<float>> time(kColumns);
  for (std::size_t i = 0; i < scan.size(); ++i)
    if (is_return(scan.points[i])) time[find_column(scan.points[i])] = scan.time[i];
  const auto any = std::find_if(time.begin(), time.end(), [](const auto& t) { return t.has_value(); });
  float last = **any;
  std::vector<SE3> lidar_from_world;
  for (const std::optional<float>& t : time) {
    last = t.value_or(last);
    const std::optional<SE3> pose = world_from_lidar.at(header.time_ns + std::llround(1e9 * static_cast<double>(last)));
    if (!pose) return;
    lidar_from_world.push_back(pose->inverse());
  }
  sensor_ = lidar_from_world[kColumns / 2].inverse().t;
  for (const SE3& pose : lidar_from_world) {
    poses_.push_back({pose.R.cast<float>(), (pose * sensor_).cast<float>()});
    reach_ = std::max(reach_, static_cast<float>(kMaxRangeM) + poses_.back().t.norm() + kObjectDepthM);
  }
}

void FreeSpace::erode(const cv::Mat1w& nearest) {
  const cv::Size gap = estimate_spacing(nearest);
  rise_ = static_cast<float>(gap.height) * kCellRad;
  cv::Mat1w padded;
  cv::copyMakeBorder(nearest, padded, 0, 0, kPaddingColumns, kPaddingColumns, cv::BORDER_WRAP);
  cv::Mat1w ends = padded.clone();
  ends.setTo(0, padded == kNoReturn);
  for (std::size_t level = 0; level < kWindows.size(); ++level) {
    const int dx = gap.width + kWindows[level], dy = gap.height + kWindows[level];
    const cv::Mat window = cv::Mat1b::ones(dy + 1, 2 * dx + 1);
    cv::Mat1w above, below, nearest_around, farthest;
    cv::erode(padded, above, window, {dx, 0});
    cv::erode(padded, below, window, {dx, dy});
    cv::min(cv::InputArray(above), cv::InputArray(below), cv::OutputArray(nearest_around));
    nearest_around.setTo(0, (above == kNoReturn) | (below == kNoReturn));
    // The dilation is only vertical, because a ground at grazing angles has a wide spread of ranges there.
    cv::dilate(ends, farthest, cv::Mat1b::ones(2 * dy + 1, 1));
    cv::merge(std::array<cv::Mat, 2>{nearest_around, farthest}, ranges_[level]);
  }
}

Eigen::Vector3f FreeSpace::to_sensor(const Eigen::Vector3d& world) const {
  const Eigen::Vector3f x = (world - sensor_).cast<float>();
  const auto seen_from = [&](int column) -> Eigen::Vector3f { return poses_[column].R * x + poses_[column].t; };
  // The time of the ray depends on its direction and vice versa; one iteration is accurate to a millisecond.
  return seen_from(find_column(seen_from(kColumns / 2)));
}

bool FreeSpace::is_above(const Eigen::Vector3d& world) const { return valid() && compute_elevation(to_sensor(world)) > high_; }

FreeSpace::Seen FreeSpace::judge(const Eigen::Vector3d& world, double radius_m) const {
  if ((world - sensor_).cast<float>().squaredNorm() > reach_ * reach_) return Seen::unknown;
  const Eigen::Vector3f p = to_sensor(world);
  const float range = p.norm();
  if (range > kMaxRangeM) return Seen::unknown;
  const float reach = static_cast<float>(pose_error_ + radius_m) / (range * kCellRad);
  const auto window = std::find_if(kWindows.begin(), kWindows.end(), [&](int w) { return static_cast<float>(w) >= reach; });
  const int row = round_to_int((compute_elevation(p) - low_) / kCellRad);
  if (window == kWindows.end() || row < 0 || row >= ranges_[0].rows) return Seen::unknown;
  const auto level = static_cast<std::size_t>(window - kWindows.begin());
  const int column = find_column(p) + kPaddingColumns;
  const cv::Vec2w& ranges = ranges_[level](row, column);
  const float nearest = ranges[0], farthest = ranges[1];
  if (nearest == 0) return Seen::unknown;
  if (nearest > (range + kObjectDepthM) * kStepsPerMeter) return Seen::passed;
  return farthest < (range - kObjectDepthM) * kStepsPerMeter ? Seen::hidden : Seen::hit;
}

std::size_t FreeSpace::bytes() const {
  std::size_t bytes = bytes_of(poses_);
  for (const cv::Mat2w& ranges : ranges_) bytes += bytes_of(ranges);
  return bytes;
}

}  // namespace dvi
