#include "dvi/job/retired_options.h"

namespace dvi::job {

std::vector<RetiredOption> retired_options() {
  return {
      {"odometry.min_range_m", "lidar.min_range_m", "odometry uses returns from 1.25 times this range"},
      {"odometry.max_range_m", "lidar.max_range_m", "odometry uses returns up to 0.75 times this range"},
      {"map.min_range_m", "lidar.min_range_m", ""},
      {"map.max_range_m", "lidar.max_range_m", ""},
      {"map.witnessed_only", "map.require_camera_visibility", ""},
      {"exposure.enabled", "stages.exposure", ""},
      {"align.enabled", "stages.align", ""},
      {"sweep.enabled", "stages.plane_sweep", ""},
      {"sweep.sources", "plane_sweep.sources", ""},
      {"sweep.reach_frames", "plane_sweep.max_frame_gap", ""},
      {"depth.see_through", "depth.occlusion_tolerance", ""},
      {"depth.mask_margin_px", "", "a margin lost good sources and gained nothing: pixels near a mask rank lower anyway"},
      {"sample.reach_frames", "sample.max_frame_gap", ""},
      {"sample.least_trust", "sample.max_error_px", "a trust of 0.03 was an error of 1.7 px, less near masks and edges"},
      {"sample.min_trust", "sample.max_error_px", "a trust of 0.03 was an error of 1.7 px, less near masks and edges"},
      {"regularize.enabled", "stages.regularize", ""},
      {"regularize.alpha", "", "no result depended on it, only the reported energy"},
      {"harmonize.unseen_last", "harmonize.never_seen_last", ""},
      {"harmonize.unseen_vertical", "harmonize.never_seen_vertical", ""},
      {"harmonize.fill_unseen", "harmonize.never_seen", "false is leave now, true interpolate"},
      {"harmonize.fill_never_seen", "harmonize.never_seen", "false is leave now, true interpolate"},
      {"smooth.enabled", "stages.smooth", ""},
  };
}

}  // namespace dvi::job
