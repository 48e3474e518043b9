#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"
#include "dvi/core/interrupt.h"
#include "dvi/drive/drive.h"
#include "dvi/holdout/mask_errors.h"
#include "dvi/holdout/painted_box.h"
#include "dvi/holdout/virtual_vehicle.h"

namespace dvi::holdout {

struct HoldoutOptions {
  Scenario scenario = Scenario::lead;
  int seed = 1;
  int margin_px = 3;                          ///< margin of the masks around the virtual vehicle
  int ignore_margin_px = 5;                   ///< margin around the masks of real traffic in which nothing is scored
  MaskErrors mask_errors = MaskErrors::none;  ///< of the virtual vehicle, in all cameras
};

/// One frame of a case.
struct HoldoutFrame {
  cv::Mat3b image;     ///< all pixels of `held_out` are painted, the others are those of the drive
  cv::Mat1b held_out;  ///< 255: the virtual vehicle and its margin
  cv::Mat1b mask;      ///< held_out, with the errors of the options, and the traffic of the drive
  cv::Mat1b ignore;    ///< 255: not scored, because its truth shows real traffic
};

/// One camera of the drive, with the masks of its real traffic.
struct HoldoutCamera {
  Drive drive;
  Lazy<cv::Mat1b> traffic;  ///< one per frame of the drive
};

/// A real drive with virtual traffic (docs/holdout.md), in memory. Frames and scans are made on demand, with the same result
/// at each call. Thread-safe.
class Holdout {
 public:
  /// `cameras` are the cameras of the drive, the target's first. Frames and scans without a pose are left out of the case.
  /// Throws InputError if no scan shows the ground, or if the vehicle is in no image of the target.
  Holdout(const std::vector<HoldoutCamera>& cameras, const Trajectory& world_from_lidar, const HoldoutOptions& options);

  /// Returns the case as a drive: poses at the middle of its scans, boxes of real and virtual traffic. With mask errors,
  /// the virtual vehicle has no boxes, because they would show it where its masks lack it. It has no images, masks, or scans:
  /// see frame() and scan().
  const Drive& drive() const { return drive_; }
  /// Returns the same for the other cameras.
  const std::vector<Drive>& more_cameras() const { return more_drives_; }
  const HoldoutOptions& options() const { return options_; }
  const std::optional<VirtualVehicle>& vehicle() const { return vehicle_; }  ///< none for a banner
  int track() const { return track_; }  ///< track of the virtual vehicle in the labels, if these have it
  bool is_labeled() const { return vehicle_ && options_.mask_errors == MaskErrors::none; }
  double sensor_height() const { return road_ ? road_->sensor_height() : 0; }
  const std::vector<bool>& visible() const { return visible_; }  ///< per frame: whether anything is held out

  HoldoutFrame frame(std::size_t i) const { return make_frame(drive_, target_, i); }
  HoldoutFrame camera_frame(std::size_t camera, std::size_t i) const {
    return make_frame(more_drives_[camera], more_[camera], i);
  }
  cv::Mat3b truth(std::size_t i) const { return *target_.images[target_.frames[i]]; }
  Scan scan(std::size_t i) const;

 private:
  struct Pictures {
    Lazy<cv::Mat3b> images;
    Lazy<cv::Mat1b> traffic;
    std::vector<std::size_t> frames;  // indices of the case's frames in the drive
    ObjectErrors errors;              // in the masks of the virtual vehicle
  };

  Pictures take_pictures(const HoldoutCamera& camera, Drive& drive) const;
  void add_labels();
  std::vector<bool> find_visible_frames(const Drive& drive) const;
  void draw_mask_errors();
  Painting paint(const Drive& drive, std::size_t frame) const;
  HoldoutFrame make_frame(const Drive& drive, const Pictures& pictures, std::size_t i) const;

  Drive drive_;
  HoldoutOptions options_;
  Lazy<Scan> scans_;
  std::vector<std::size_t> scan_indices_;  // indices in the drive of the case's scans
  Pictures target_;
  std::vector<Drive> more_drives_;
  std::vector<Pictures> more_;  // one per drive of more_drives_
  std::shared_ptr<const DrivenPath> road_;
  std::optional<VirtualVehicle> vehicle_;
  std::vector<bool> visible_;
  int track_ = 0;
};

/// Writes the case: drive/ in the folder layout, truth/NAME.png, truth_masks/NAME.png (HoldoutFrame::held_out),
/// ignore/NAME.png, and holdout.json, in which `recipe` describes the input of the case. Everything is written beside CASE and
/// renamed. Calls `tick` once per frame and once per scan. Throws InputError if the folder is not empty or cannot be written.
void write_holdout(const Holdout& holdout, const fs::path& case_folder, const std::string& recipe, const Tick& tick = {});

/// Reads the recipe of a complete case; empty if there is no case.
std::string read_holdout_recipe(const fs::path& case_folder);

}  // namespace dvi::holdout
