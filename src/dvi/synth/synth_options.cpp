#include "dvi/synth/synth_options.h"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "dvi/core/error.h"

namespace dvi::synth {

void SynthOptions::describe(OptionTable& table) {
  table.section("synth");
  table.flags(true);
  table.add("frames", frames, {1, 100000}, "Number of images and of scans of the LiDAR.");
  table.add("width", width, {32, 4096}, "Image width in pixels.");
  table.add("height", height, {32, 4096}, "Image height in pixels.");
  table.add("seed", seed, {0, 1e9}, "Seed of the street and its traffic.");
  table.add("day", day, {1, 9}, "The same street on another day, with other light, parked cars, lane and traffic.");
  table.add("reverse", reverse,
            "The same street driven in reverse: it begins 20 m beyond the end and returns in the opposite lane.");
  table.add("speed_mps", speed_mps, {0, 30}, "Speed of the recording car in meters per second.");
  table.add("turn_deg", turn_deg, {-90, 90}, "Angle by which the street bends, left positive.");
  table.add("truck", truck, "A truck stays close ahead during the whole drive.");
  table.add("walker", walker, "People walk over the crossings, with moving legs and shadows from the sun.");
  table.add("wet", wet, "The road is wet: darker, with puddles.");
  table.add("changes", changes, "Every third house has a new front and new signs, and there are building sites on the right.");
  table.add("stereo_m", stereo_m, {0, 5},
            "Distance in meters of a second camera, \"right\", to the right of the first one; 0: none.");
  table.add("side_cameras", side_cameras,
            "Two more cameras, \"side-left\" and \"side-right\", which look 60 degrees to the sides.");
  table.add("six_cameras", six_cameras,
            "Six cameras instead, which look in all directions: \"front\", \"front-left\", \"front-right\", \"back\", "
            "\"back-left\", and \"back-right\".");
  table.add("lens", lens,
            "The lens of all cameras: pinhole, fisheye or unified (180 degrees wide), or panorama (the whole sphere; the image "
            "must be twice as wide as high).");
  table.add("room", room,
            "A furnished room instead of a street: a hand-held RGB-D camera, and a person who walks through. Options of the "
            "street, its traffic and the LiDAR do not apply.");
  table.add("beams", beams, {1, 256}, "Beams of the LiDAR, from -24.8 to +2 degrees.");
  table.add("columns", columns, {36, 7200}, "Firings per scan.");
  table.add("rate_hz", rate_hz, {1, 50}, "Scans and images per second.");
  table.add("range_m", range_m, {5, 300}, "Largest range of the LiDAR in meters.");
  table.add("exposure_drift", exposure_drift, {0, 0.8},
            "Change of the exposure over the drive; 0.12 means from -12 % to +12 %.");
  table.add("jitter_deg", jitter_deg, {0, 5},
            "Largest error of the calibration in yaw and pitch, drawn anew for each image, in degrees.");
  table.add("image_noise", image_noise, {0, 50}, "Standard deviation of the image noise in gray levels.");
  table.add("range_noise", range_noise, {0, 1},
            "Standard deviation of the ranges in meters; in a room at 5 m, growing with the square of the depth.");
}

void SynthOptions::check() const {
  check_ranges(*this);
  if (lens == SynthLens::panorama && width != 2 * height)
    throw UsageError(fmt::format("--lens panorama needs images twice as wide as high, not {}x{}", width, height));
  if (six_cameras && (side_cameras || stereo_m > 0))
    throw UsageError("--six-cameras cannot be combined with --side-cameras and --stereo-m");
  if (!room) return;
  const std::pair<const char*, bool> of_the_street[] = {{"--reverse", reverse},         {"--truck", truck},
                                                        {"--walker", walker},           {"--wet", wet},
                                                        {"--changes", changes},         {"--stereo-m", stereo_m > 0},
                                                        {"--turn-deg", turn_deg != 0},  {"--side-cameras", side_cameras},
                                                        {"--six-cameras", six_cameras}, {"--lens", lens != SynthLens::pinhole}};
  for (const auto& [name, given] : of_the_street)
    if (given) throw UsageError(std::string(name) + " is an option of the street and cannot be combined with --room");
}

}  // namespace dvi::synth
