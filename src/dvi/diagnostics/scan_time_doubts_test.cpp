#include "dvi/diagnostics/scan_time_doubts.h"

#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/diagnostics/test_drive.h"
#include "dvi/drive/deskew.h"

namespace dvi::diagnostics {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Drive changed(const Drive& drive, const std::function<Scan(const Scan&, const ScanHeader&)>& change) {
  Drive out = drive;
  out.scans = Lazy<Scan>(drive.scans.size(), 20, [scans = drive.scans, headers = drive.scan_headers, change](std::size_t i) {
    return change(*scans[i], headers[i]);
  });
  return out;
}

TEST(ScanTimeDoubts, SaysNothingOfAGoodRecording) {
  const Drive drive = test_drive(1, 0, 16);
  EXPECT_THAT(scan_time_doubts(drive, drive.poses), ElementsAre());
}

TEST(ScanTimeDoubts, NamesScansThatAreCompensatedAlready) {
  const Drive drive = test_drive(1, 0, 16);
  const Drive compensated = changed(drive, [&](const Scan& scan, const ScanHeader& header) {
    Scan out = scan;
    const std::vector<Eigen::Vector3d> world = to_world(scan, header, drive.poses);
    const auto lidar_from_world = drive.poses.at(header.time_ns)->inverse();
    for (std::size_t k = 0; k < world.size(); ++k) out.points[k] = (lidar_from_world * world[k]).cast<float>();
    return out;
  });
  EXPECT_THAT(scan_time_doubts(compensated, drive.poses), ElementsAre(HasSubstr("scans look compensated already")));
}

TEST(ScanTimeDoubts, NamesALidarThatTurnsTheOtherWay) {
  const Drive drive = test_drive(1, 0, 16);
  const Drive backwards = changed(drive, [](const Scan& scan, const ScanHeader&) {
    Scan out = scan;
    for (float& time : out.time) time = -time;
    return out;
  });
  EXPECT_THAT(scan_time_doubts(backwards, drive.poses), ElementsAre(HasSubstr("turn the other way")));
}

}  // namespace
}  // namespace dvi::diagnostics
