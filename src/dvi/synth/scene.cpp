#include "dvi/synth/scene.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "dvi/core/threads.h"
#include "dvi/geometry/angles.h"
#include "dvi/synth/render.h"
#include "dvi/synth/room.h"
#include "dvi/synth/synth_rig.h"

namespace dvi::synth {
namespace {

using Eigen::Vector3d;

constexpr std::int64_t kStartNs = 1'000'000'000'000, kReverseDelayNs = 500'000'000'000;
constexpr double kLidarHeightM = 1.73;

// Returns the elevation of a beam of the HDL-64E: three beams per degree in its upper half, two in its lower half.
double elevation_deg(int beam, int beams) {
  if (beams == 64) return beam < 32 ? -24.33 + 0.5 * beam : -8.33 + (beam - 32) / 3.0;
  return beams == 1 ? -5.0 : -24.8 + 26.8 * beam / (beams - 1);
}

std::uint32_t label_point(const PlacedMover& placed) {
  return static_cast<std::uint32_t>(placed.mover->track) << 16U |
         static_cast<std::uint32_t>(point_class_of(placed.model->type).moving);
}

}  // namespace

struct Scene::World {
  explicit World(const SynthOptions& options)
      : noise(static_cast<std::uint64_t>(options.seed)),
        still(options, noise),
        course(options),
        movers(options.room ? make_visitors(options, noise) : make_traffic(options, course, noise)) {}

  std::vector<PlacedMover> place_movers(double time) const {
    return synth::place_movers(movers, still.street, time, course.place(course.path_length(time), 0).x());
  }

  Noise noise;
  StaticWorld still;
  Course course;
  std::vector<Mover> movers;
};

Scene::Scene(const SynthOptions& options) : options_(options) {
  options.check();
  camera_ = make_lens(options);
  cameras_ = make_rig(options);
  world_ = std::make_unique<const World>(options);
}

Scene::~Scene() = default;

std::string Scene::name(int frame) const { return fmt::format("{:06d}", frame); }

std::int64_t Scene::time_ns(int frame) const {
  const std::int64_t start = kStartNs * options_.day + (options_.reverse ? kReverseDelayNs : 0);
  return start + std::llround(1e9 * (frame + 0.5) / options_.rate_hz);
}

double Scene::seconds(std::int64_t time_ns) const { return 1e-9 * static_cast<double>(time_ns - this->time_ns(0)); }

SE3 Scene::world_from_lidar(std::int64_t time_ns) const {
  const double t = seconds(time_ns), p = t + 1.7 * (options_.day - 1);
  if (options_.room) return world_from_hand(options_, t);
  const Course& course = world_->course;
  const double sway = 0.12 * std::sin(0.8 * p + 0.3);
  const double yaw = 0.55 * kRadPerDegree * std::sin(1.3 * p + 0.2), roll = 0.25 * kRadPerDegree * std::sin(2.3 * p);
  const double pitch = kRadPerDegree * (0.22 * std::sin(6.1 * p) + 0.05 * std::sin(11 * p));
  const SE3 level = course.world_from_place(
      world_->still.street, {course.path_length(t), course.lane() + sway, kLidarHeightM + 0.012 * std::sin(7 * p)}, yaw);
  return level * SE3{so3_exp({0, pitch, 0}) * so3_exp({roll, 0, 0}), Vector3d::Zero()};
}

SE3 Scene::camera_from_world(int frame, std::size_t camera) const {
  Random random = synth::make_random(static_cast<std::uint64_t>(options_.seed), stream(200, camera), frame);
  const double pitch = random.uniform(-1, 1) * options_.jitter_deg, yaw = random.uniform(-1, 1) * options_.jitter_deg;
  const SE3 jitter{so3_exp({pitch * kRadPerDegree, 0, 0}) * so3_exp({0, yaw * kRadPerDegree, 0}), Vector3d::Zero()};
  return jitter * cameras_[camera].camera_from_lidar * world_from_lidar(time_ns(frame)).inverse();
}

// Returns a separate stream of random numbers for each purpose, day, direction and camera.
int Scene::stream(int purpose, std::size_t camera) const {
  return purpose + options_.day + 100 * static_cast<int>(camera) + (options_.reverse ? 1000 : 0);
}

double Scene::gain(int frame, std::size_t camera) const {
  const double drift = options_.frames < 2 ? 0 : options_.exposure_drift * (2.0 * frame / (options_.frames - 1) - 1);
  return cameras_[camera].gain * (1 + drift);
}

SynthFrame Scene::render(int frame, std::size_t camera) const {
  const double t = seconds(time_ns(frame));
  return synth::render(world_->still, world_->place_movers(t),
                       {camera_, camera_from_world(frame, camera), gain(frame, camera)});
}

cv::Mat3b Scene::record(int frame, const SynthFrame& rendered, std::size_t camera) const {
  cv::Mat3b image = rendered.image.clone();
  if (options_.image_noise == 0) return image;
  parallel_for(static_cast<std::size_t>(image.rows), [&](std::size_t row) {
    const auto number = static_cast<std::int64_t>(frame) * image.rows + static_cast<std::int64_t>(row);
    Random random = synth::make_random(static_cast<std::uint64_t>(options_.seed), stream(210, camera), number);
    cv::Vec3b* pixels = image[static_cast<int>(row)];
    for (int x = 0; x < image.cols; ++x)
      for (int c = 0; c < 3; ++c)
        pixels[x][c] = cv::saturate_cast<uchar>(pixels[x][c] + options_.image_noise * random.normal());
  });
  return image;
}

cv::Mat1b Scene::mask(const SynthFrame& rendered) const {
  const int radius = std::max(2, options_.width / 240);
  cv::Mat1b mask;
  cv::dilate(rendered.dynamic, mask, cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * radius + 1, 2 * radius + 1}));
  return mask;
}

cv::Mat1w Scene::depth_image(int frame, const SynthFrame& rendered) const {
  return simulate_depth(rendered.seen, options_.range_noise,
                        synth::make_random(static_cast<std::uint64_t>(options_.seed), stream(230, 0), frame));
}

SynthScan Scene::scan(int frame) const {
  const auto columns = static_cast<std::size_t>(options_.columns);
  std::vector<SynthScan> parts(columns);
  const double period = 1 / options_.rate_hz;
  parallel_for(columns, [&](std::size_t column) {
    SynthScan& out = parts[column];
    const double share = static_cast<double>(column) / static_cast<double>(columns), after = (share - 0.5) * period;
    const std::int64_t time = time_ns(frame) + std::llround(1e9 * after);
    const double t = seconds(time), azimuth = std::numbers::pi * (1 - 2 * share);
    const Tracer tracer(world_->still, world_->place_movers(t));
    const SE3 pose = world_from_lidar(time);
    Random random = synth::make_random(static_cast<std::uint64_t>(options_.seed), stream(220, 0),
                                       static_cast<std::int64_t>(frame) * options_.columns + static_cast<std::int64_t>(column));
    for (int beam = 0; beam < options_.beams; ++beam) {
      const double up = elevation_deg(beam, options_.beams) * kRadPerDegree, error = options_.range_noise * random.normal();
      const Vector3d direction(std::cos(up) * std::cos(azimuth), std::cos(up) * std::sin(azimuth), std::sin(up));
      const Ray ray{pose.t, pose.R * direction};
      const Tracer::Seen seen = tracer.trace(ray, options_.range_m);
      if (seen.t > options_.range_m) continue;
      const cv::Vec3f color = tracer.shade(ray, seen);
      out.scan.points.emplace_back(((seen.t + error) * direction).cast<float>());
      out.scan.intensity.push_back(std::min(1.0F, (color[0] + color[1] + color[2]) / 765));
      out.scan.time.push_back(static_cast<float>(after));
      out.scan.ring.push_back(static_cast<std::uint16_t>(beam));
      out.dynamic.push_back(seen.dynamic ? 1 : 0);
      out.label.push_back(seen.dynamic ? label_point(tracer.movers()[static_cast<std::size_t>(seen.mover)])
                                       : kStaticPointClass);
      out.range.push_back(static_cast<float>(seen.t));
    }
  });
  SynthScan whole;
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  for (const SynthScan& part : parts) {
    append(whole.scan.points, part.scan.points);
    append(whole.scan.intensity, part.scan.intensity);
    append(whole.scan.time, part.scan.time);
    append(whole.scan.ring, part.scan.ring);
    append(whole.dynamic, part.dynamic);
    append(whole.label, part.label);
    append(whole.range, part.range);
  }
  return whole;
}

std::vector<Label> Scene::boxes(int frame) const {
  const double t = seconds(time_ns(frame));
  const SE3 lidar_from_world = world_from_lidar(time_ns(frame)).inverse();
  std::vector<Label> labels;
  for (const PlacedMover& placed : world_->place_movers(t)) {
    const Model& model = *placed.model;
    const SE3 pose = lidar_from_world * placed.world_from_mover;
    const Vector3d center = pose * Vector3d(0, 0, 0.5 * model.size.z());
    if (center.norm() > options_.range_m) continue;
    // Labels have only a rotation about z.
    const double yaw = std::atan2(pose.R(1, 0), pose.R(0, 0));
    Label label;
    label.track = placed.mover->track;
    label.type = model.type;
    label.box = Box{{so3_exp({0, 0, yaw}), center}, model.size};
    labels.push_back(label);
  }
  return labels;
}

}  // namespace dvi::synth
