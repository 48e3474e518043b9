#include "dvi/diagnostics/check_scan_times.h"

#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/diagnostics/test_drive.h"
#include "dvi/drive/deskew.h"

namespace dvi::diagnostics {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Drive change_scans(const Drive& drive, const std::function<Scan(const Scan&, const ScanHeader&)>& change) {
  Drive out = drive;
  out.scans = Lazy<Scan>(drive.scans.size(), 20, [scans = drive.scans, headers = drive.scan_headers, change](std::size_t i) {
    return change(*scans[i], headers[i]);
  });
  return out;
}

TEST(CheckScanTimes, AcceptsAGoodRecording) {
  const Drive drive = make_test_drive(1, 0, 16);
  EXPECT_THAT(check_scan_times(drive, drive.poses), ElementsAre());
}

TEST(CheckScanTimes, ReportsScansThatAreCompensatedAlready) {
  const Drive drive = make_test_drive(1, 0, 16);
  const Drive compensated = change_scans(drive, [&](const Scan& scan, const ScanHeader& header) {
    Scan out = scan;
    const std::vector<Eigen::Vector3d> world = to_world(scan, header, drive.poses);
    const auto lidar_from_world = drive.poses.at(header.time_ns)->inverse();
    for (std::size_t k = 0; k < world.size(); ++k) out.points[k] = (lidar_from_world * world[k]).cast<float>();
    return out;
  });
  EXPECT_THAT(check_scan_times(compensated, drive.poses), ElementsAre(HasSubstr("scans seem to be compensated already")));
}

TEST(CheckScanTimes, ReportsALidarThatRotatesInTheOtherDirection) {
  const Drive drive = make_test_drive(1, 0, 16);
  const Drive backwards = change_scans(drive, [](const Scan& scan, const ScanHeader&) {
    Scan out = scan;
    for (float& time : out.time) time = -time;
    return out;
  });
  EXPECT_THAT(check_scan_times(backwards, drive.poses), ElementsAre(HasSubstr("rotate in the other direction")));
}

}  // namespace
}  // namespace dvi::diagnostics
