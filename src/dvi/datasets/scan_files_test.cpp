#include "dvi/datasets/scan_files.h"

#include <functional>

#include <fmt/format.h>

#include "dvi/testing/image_folder.h"
#include "dvi/testing/test_scan.h"

namespace dvi::datasets {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kScanCount = 5;
constexpr double kFirstS = 1534313591.4, kPeriodS = 0.1;
constexpr const char* kToml =
    "[camera.front]\nsize = [8, 6]\nK = [4, 0, 4, 0, 4, 3, 0, 0, 1]\ncamera_from_lidar = [0, -1, 0, 0,  0, 0, -1, 0,  1, 0, 0, "
    "0]\n"
    "[lidar]\nrate = 10\n";

// A drive of five images and scans, whose times are the middle of each scan.
class ScanFilesOf : public testing::Test {
 protected:
  using Columns = std::vector<std::vector<double>>;

  ScanFilesOf() {
    folder.write("dvi.toml", kToml);
    std::string times;
    for (int i = 0; i < kScanCount; ++i) {
      folder.write_image(fmt::format("images/front/{:06d}.png", i), cv::Mat3b(6, 8, cv::Vec3b()));
      times += fmt::format("{:06d} {:.6f}\n", i, middle(i));
    }
    folder.write("times/lidar.txt", times);
  }
  static double middle(int number) { return kFirstS + kPeriodS * number; }

  void write_bin_scans(const Columns& columns) const {
    for (int i = 0; i < kScanCount; ++i) folder.write(fmt::format("lidar/{:06d}.bin", i), bin_of<float>(columns));
  }
  // Writes scans with a field of times; `time` computes it from the seconds after the start of scan n.
  void write_ply_scans(const std::string& field, const std::function<double(double, int)>& time) const {
    for (int n = 0; n < kScanCount; ++n) {
      std::vector<double> times;
      for (const double t : scan.t) times.push_back(time(t, n));
      folder.write(fmt::format("lidar/{:06d}.ply", n),
                   fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\n"
                               "property double z\nproperty double {}\nend_header\n",
                               scan.x.size(), field) +
                       bin_of<double>({scan.x, scan.y, scan.z, times}));
    }
  }
  void configure(const std::string& lidar) const { folder.write("dvi.toml", kToml + lidar); }
  Drive read() const { return read_drive(folder.path); }
  std::string error() const {
    return input_error([&] { read(); });
  }
  // Expects that the times of the points of all scans are those of the test's scan.
  void expect_times(const Drive& drive) const {
    for (std::size_t n = 0; n < drive.scans.size(); ++n) {
      const std::shared_ptr<const Scan> found = drive.scans[n];
      ASSERT_EQ(found->time.size(), scan.t.size());
      for (std::size_t i = 0; i < scan.t.size(); i += 100) ASSERT_NEAR(found->time[i], scan.t[i] - 0.5 * kPeriodS, 2e-6);
    }
  }

  const TestFolder folder;
  const TestScan scan;
};

TEST_F(ScanFilesOf, BinColumnsAreInferredAndReported) {
  write_bin_scans({scan.x, scan.y, scan.z, scan.intensity, scan.ring, scan.t});
  const Drive drive = read();
  EXPECT_THAT(
      drive.warnings,
      ElementsAre(HasSubstr("scans are read as 6 columns of float32: x y z intensity ring t, inferred from their values")));
  expect_times(drive);
  EXPECT_EQ(drive.scans[0]->ring[361], 1);
  EXPECT_FLOAT_EQ(drive.scans[0]->intensity[5], static_cast<float>(scan.intensity[5]));
  configure("columns = [\"x\", \"y\", \"z\", \"intensity\", \"_\", \"t\"]\n");
  const Drive stated = read();
  EXPECT_THAT(stated.warnings, IsEmpty());
  EXPECT_TRUE(stated.scans[0]->ring.empty());
  expect_times(stated);
}

TEST_F(ScanFilesOf, FourColumnsCauseNoWarning) {
  write_bin_scans({scan.x, scan.y, scan.z, scan.intensity});
  EXPECT_THAT(read().warnings, IsEmpty());
  EXPECT_EQ(read().scans[0]->size(), scan.x.size());
}

TEST_F(ScanFilesOf, AFileWithOtherColumnsIsRefused) {
  write_bin_scans({scan.x, scan.y, scan.z, scan.intensity});
  folder.write("lidar/000001.bin", bin_of<float>({scan.x, scan.y, scan.z, scan.intensity, scan.ring}));
  EXPECT_THAT(input_error([&] { read().scans[1]; }),
              HasSubstr("000001.bin: looks like 5 columns of float32, but other scans have 4"));
  folder.write("lidar/000004.bin", bin_of<float>({scan.x, scan.y, scan.z}));
  EXPECT_THAT(error(), HasSubstr("000004.bin: has 3 columns of float32, but 000002.bin has 4"));
}

TEST_F(ScanFilesOf, StatedColumnsMustMatchTheFiles) {
  write_bin_scans({scan.x, scan.y, scan.z, scan.intensity});
  configure("columns = [\"x\", \"y\", \"z\", \"intensity\", \"ring\", \"t\", \"a\"]\n");
  EXPECT_THAT(error(), AllOf(HasSubstr("000000.bin: 92160 bytes"), HasSubstr("points of 28 bytes")));
  configure("columns = [\"x\", \"y\", \"intensity\"]\n");
  EXPECT_THAT(error(), AllOf(HasSubstr("dvi.toml:"), HasSubstr("'columns' does not have 'z' exactly once")));
  configure("columns = 5\n");
  EXPECT_THAT(error(), HasSubstr("'columns' is not a list of names"));
}

TEST_F(ScanFilesOf, TimesOfAnyUnitAndOriginAreUsed) {
  struct Case {
    const char* field;
    std::function<double(double, int)> time;
    const char* words;
  };
  const auto start = [](int n) { return middle(n) - 0.5 * kPeriodS; };
  const Case cases[] = {
      {"t", [](double t, int) { return t * 1e9; }, "are nanoseconds after the start of the scan"},
      {"time", [](double t, int) { return t * 1e6; }, "are microseconds after the start of the scan"},
      {"offset_time", [](double t, int) { return t * 1e3; }, "are milliseconds after the start of the scan"},
      {"t", [](double t, int) { return t / kPeriodS; }, "are fractions of a scan after the start of the scan"},
      {"time", [](double t, int) { return t - kPeriodS; }, "are seconds before the end of the scan"},
      {"t", [](double t, int) { return t - 0.5 * kPeriodS; }, "are seconds before and after the middle of the scan"},
      {"timestamp", [&](double t, int n) { return t + start(n); }, "are seconds on the clock of the recording"},
      {"timestamp", [&](double t, int n) { return (t + start(n)) * 1e9; }, "are nanoseconds on the clock of the recording"},
      {"scalar_GpsTime", [&](double t, int n) { return t + start(n) - 1.5e9; }, "a scan starts with its first point"},
  };
  for (const Case& one : cases) {
    write_ply_scans(one.field, one.time);
    const Drive drive = read();
    EXPECT_THAT(drive.warnings, ElementsAre(HasSubstr(one.words)));
    if (std::string(one.field) != "scalar_GpsTime") expect_times(drive);
  }
  write_ply_scans("t", [](double t, int) { return t; });
  EXPECT_THAT(read().warnings, IsEmpty());
  expect_times(read());
}

TEST_F(ScanFilesOf, AbsoluteTimesGetTheOffsetOfTheClock) {
  configure("offset_s = 0.3\n");
  write_ply_scans("timestamp", [](double t, int n) { return t + middle(n) - 0.5 * kPeriodS; });
  expect_times(read());
}

TEST_F(ScanFilesOf, TimesThatAreAllZeroAreNotUsed) {
  write_ply_scans("t", [](double, int) { return 0; });
  const Drive drive = read();
  EXPECT_THAT(drive.warnings, ElementsAre(AllOf(HasSubstr("times of the points in scans are all 0 and are not used"),
                                                HasSubstr("assumed to be compensated for motion"))));
  EXPECT_EQ(drive.scans[0]->time[7], 0);
  configure("rotation = \"clockwise\"\n");
  EXPECT_THAT(read().warnings, ElementsAre(HasSubstr("not used: [lidar] rotation is used instead")));
  expect_times(read());
}

TEST_F(ScanFilesOf, OneTimeWithinTheScanIsUsedForAllPoints) {
  write_ply_scans("t", [](double, int) { return 0.02; });
  EXPECT_THAT(read().warnings, IsEmpty());
  EXPECT_FLOAT_EQ(read().scans[0]->time[7], -0.03F);
}

TEST_F(ScanFilesOf, TimesThatMatchNoScanAreRefused) {
  write_ply_scans("t", [](double t, int) { return 200 * t; });
  EXPECT_THAT(error(), AllOf(HasSubstr("000004.ply: the times of its points go from 0"), HasSubstr("in no unit"),
                             HasSubstr("remove the field")));
  write_ply_scans("t", [](double t, int n) { return n == 1 ? 1e9 * t : t; });
  EXPECT_THAT(input_error([&] { read().scans[1]; }), HasSubstr("000001.ply: a time of its points is"));
}

TEST_F(ScanFilesOf, MillimetersAreRefused) {
  Columns columns = {scan.x, scan.y, scan.z, scan.intensity};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (double& value : columns[axis]) value *= 1000;
  write_bin_scans(columns);
  EXPECT_THAT(error(), AllOf(HasSubstr("000004.bin: half of its points are"),
                             HasSubstr("its coordinates look like millimeters"), HasSubstr("units_per_meter = 1000")));
  configure("units_per_meter = 1000\n");
  EXPECT_THAT(read().warnings, IsEmpty());
  EXPECT_NEAR(read().scans[0]->points[9].x(), scan.x[9], 1e-5);
  configure("units_per_meter = 0.5\n");
  EXPECT_THAT(error(), HasSubstr("'units_per_meter' is not between 1 and 1000000"));
  configure("");
  for (double& value : columns[0]) value += 5e8;
  write_bin_scans(columns);
  EXPECT_THAT(error(), HasSubstr("its coordinates are not meters in the axes of the sensor"));
}

TEST_F(ScanFilesOf, OtherFormatsAreRefused) {
  for (int n = 0; n < kScanCount; ++n) folder.write(fmt::format("lidar/{:06d}.npy", n), "\x93NUMPY");
  folder.write("lidar/README", "x");
  EXPECT_THAT(
      error(),
      AllOf(HasSubstr("lidar: holds no scans in a supported format (.bin, .ply, .pcd), but 1 without an ending, 5 .npy"),
            HasSubstr("convert each scan")));
  fs::remove_all(folder.path / "lidar");
  folder.write("map.laz", "LASF");
  EXPECT_THAT(error(), AllOf(HasSubstr("map.laz: is in a format that is not supported for maps"), HasSubstr("decompress it")));
  fs::remove(folder.path / "map.laz");
  folder.write("map.copc.laz", "LASF");
  EXPECT_THAT(error(), HasSubstr("map.copc.laz: is in a format"));
}

}  // namespace
}  // namespace dvi::datasets
