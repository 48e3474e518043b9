#include "dvi/media/point_times.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dvi::media {
namespace {

using testing::HasSubstr;
using Use = PointTimes::Use;
using Zero = PointTimes::Zero;

constexpr double kScanPeriodS = 0.1, kStartS = 1534313591.4;

// Returns 1,000 values from `first`, evenly spaced over `span`.
std::vector<double> values(double first, double span) {
  std::vector<double> out;
  for (int i = 0; i < 1000; ++i) out.push_back(first + span * i / 1000);
  return out;
}

PointTimes infer(const std::vector<double>& of, double turn_share = 1) {
  return infer_point_times(of, {.period_s = kScanPeriodS, .start_s = kStartS, .turn_share = turn_share});
}

TEST(PointTimes, RecognizeManyFieldNames) {
  for (const char* name :
       {"t", "time", "timestamp", "time_stamp", "offset_time", "timeOffset", "scalar_GpsTime", "GpsTime", "gps_time"})
    EXPECT_EQ(find_time_field({"x", "y", "z", "intensity", name}), 4U) << name;
  EXPECT_EQ(find_time_field({"timestamp", "t"}), 1U);
  EXPECT_FALSE(find_time_field({"x", "y", "z", "tag", "temperature"}));
}

TEST(PointTimes, InferUnitsFromTheSpan) {
  // These are the formats of Velodyne (float seconds), Hesai (double seconds), Ouster (uint32 nanoseconds), Livox (uint32
  // nanoseconds, offset_time), RoboSense and others (microseconds and milliseconds).
  for (const double unit : {1.0, 1e-3, 1e-6, 1e-9}) {
    const PointTimes times = infer(values(0, 0.1 / unit));
    EXPECT_EQ(times.use, Use::times) << unit;
    EXPECT_EQ(times.zero, Zero::scan_start) << unit;
    EXPECT_EQ(times.unit_s, unit);
  }
  EXPECT_TRUE(infer(values(0, 0.1)).usual());
  EXPECT_EQ(infer(values(0, 1e8)).text, "are nanoseconds after the start of the scan");
  const PointTimes fractions = infer(values(0, 1));
  EXPECT_EQ(fractions.unit_s, kScanPeriodS);
  EXPECT_EQ(fractions.text, "are fractions of a scan after the start of the scan");
}

TEST(PointTimes, InferOriginsFromTheEnds) {
  EXPECT_EQ(infer(values(-0.1, 0.1)).zero, Zero::scan_end);
  EXPECT_EQ(infer(values(-1e8, 1e8)).zero, Zero::scan_end);
  EXPECT_EQ(infer(values(-0.05, 0.1)).zero, Zero::scan_middle);
  EXPECT_EQ(infer(values(-0.002, 0.1)).zero, Zero::scan_start);
  EXPECT_EQ(infer(values(kStartS, 0.1)).zero, Zero::recording_clock);
  EXPECT_EQ(infer(values(1e9 * kStartS, 1e8)).zero, Zero::recording_clock);
  EXPECT_EQ(infer(values(345600, 0.1)).zero, Zero::first_point);  // seconds of the GPS week
  const PointTimes unclear = infer(values(-0.032, 0.1));
  EXPECT_EQ(unclear.use, Use::unknown);
  EXPECT_THAT(unclear.text, HasSubstr("go from -0.0319 to 0.0678 s around neither the start"));
}

TEST(PointTimes, IgnoreTimesWithASmallSpan) {
  EXPECT_EQ(infer(values(0, 0)).use, Use::none);
  EXPECT_EQ(infer(values(0, 0)).text, "are all 0");
  EXPECT_EQ(infer(values(kStartS, 0)).use, Use::none);
  EXPECT_EQ(infer(values(0.05, 0)).use, Use::one_time);
  EXPECT_EQ(infer(values(0, 0.04)).use, Use::none);
  EXPECT_EQ(infer({}).use, Use::none);
  // Seconds since 1970 in 32 bits have steps of 128 s and are ambiguous with milliseconds.
  std::vector<double> coarse = values(1534313472, 0);
  for (std::size_t i = 500; i < coarse.size(); ++i) coarse[i] += 128;
  EXPECT_EQ(infer(coarse).use, Use::none);
  EXPECT_EQ(infer(coarse).text, "have only 2 different values");
}

TEST(PointTimes, AreUnknownIfTheSpanMatchesNoUnit) {
  EXPECT_EQ(infer(values(0, 20)).use, Use::unknown);
  EXPECT_THAT(infer(values(0, 20)).text, HasSubstr("which matches a scan of 0.1 s in no unit"));
}

TEST(PointTimes, AreInferredForScansCroppedToAFieldOfView) {
  EXPECT_EQ(infer(values(0.037, 0.026)).use, Use::none);
  EXPECT_TRUE(infer(values(0.037, 0.026), 0.26).usual());
  EXPECT_EQ(infer(values(-0.063, 0.026), 0.26).zero, Zero::scan_end);
  EXPECT_EQ(infer(values(0.37e8, 0.26e8), 0.26).unit_s, 1e-9);
}

TEST(PointTimes, IgnoreSingleValuesOfPointsThatWereNotMeasured) {
  std::vector<double> of = values(kStartS, 0.1);
  of.insert(of.end(), 500, kStartS);
  of[7] = 0;
  of[8] = std::nan("");
  of[9] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(infer(of).zero, Zero::recording_clock);
}

TEST(PointTimes, AreConvertedToSecondsAfterTheStart) {
  const auto converted = [](double value, const PointTimes& times) {
    return to_seconds_after_start({value, value + 0.01 / times.unit_s}, times, kStartS, kScanPeriodS);
  };
  EXPECT_DOUBLE_EQ(converted(0.02, {})[0], 0.02);
  EXPECT_DOUBLE_EQ(converted(-0.02, {.zero = Zero::scan_end, .text = {}})[0], 0.08);
  EXPECT_DOUBLE_EQ(converted(-2e7, {.zero = Zero::scan_end, .unit_s = 1e-9, .text = {}})[0], 0.08);
  EXPECT_DOUBLE_EQ(converted(-0.02, {.zero = Zero::scan_middle, .text = {}})[0], 0.03);
  EXPECT_NEAR(converted(1e9 * kStartS + 2e7, {.zero = Zero::recording_clock, .unit_s = 1e-9, .text = {}})[0], 0.02, 1e-6);
  EXPECT_NEAR(converted(777, {.zero = Zero::first_point, .text = {}})[1], 0.01, 1e-9);
}

TEST(PointTimes, HaveAShareOfTheRevolutionByOccupiedSectors) {
  std::vector<Eigen::Vector3f> points;
  for (int degree = -180; degree < 180; ++degree) {
    const double a = degree * 3.14159265358979 / 180;
    points.push_back(Eigen::Vector3d(10 * std::cos(a), 10 * std::sin(a), 1).cast<float>());
  }
  EXPECT_EQ(compute_turn_share(points), 1);
  points.resize(90);
  EXPECT_NEAR(compute_turn_share(points), 0.25, 0.02);
  EXPECT_EQ(compute_turn_share({}), 0);
}

}  // namespace
}  // namespace dvi::media
