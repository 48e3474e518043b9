#include "dvi/inputs/reports_json.h"

#include <nlohmann/json.hpp>

#include "dvi/core/json_optional.h"

namespace dvi::inputs {

using nlohmann::json;

// The keys are the names of the fields.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SharpnessReport, ground_m, vertical_m, ground_patches, vertical_patches)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(LengthReport, median_m, largest_m)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(MotionReport, median_m, largest_m, median_deg, largest_deg)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DriftReport, lag_correction, given_over_10_m, loops, largest_correction_m)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ScanReport, state, guess, features, inliers, residual_m, lag_correction_m,
                                   degenerate_directions)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(OdometryReport, rings, path_m, plane_features, edge_features, drift, scans)

void to_json(json& j, const PosesReport& report) {
  j = {{"from", report.from}, {"sharpness", {{"given", report.given}, {"loam", report.loam}}}, {"odometry", report.odometry}};
}
void from_json(const json& j, PosesReport& report) {
  j.at("from").get_to(report.from);
  j.at("sharpness").at("given").get_to(report.given);
  j.at("sharpness").at("loam").get_to(report.loam);
  j.at("odometry").get_to(report.odometry);
}

}  // namespace dvi::inputs
