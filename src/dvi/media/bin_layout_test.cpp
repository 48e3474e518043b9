#include "dvi/media/bin_layout.h"

#include <algorithm>
#include <cstdint>

#include "dvi/core/random.h"
#include "dvi/media/point_cloud.h"
#include "dvi/testing/find_recording.h"
#include "dvi/testing/image_folder.h"
#include "dvi/testing/test_scan.h"

namespace dvi::media {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

using Columns = std::vector<std::vector<double>>;

constexpr TimedScan kTimes{.period_s = 0.1, .start_s = 0, .turn_share = 1};

// Returns all columns that converters write, and further columns of noise.
Columns all_columns(std::size_t count) {
  const TestScan scan;
  Columns columns = {scan.x, scan.y, scan.z, scan.intensity, scan.ring, scan.t};
  Random random(1);
  while (columns.size() < count) {
    columns.emplace_back();
    for (std::size_t i = 0; i < scan.x.size(); ++i) columns.back().push_back(random.uniform(0, 1));
  }
  columns.resize(count);
  return columns;
}

BinLayout layout_of(const std::string& bytes) {
  const TestFolder folder;
  return infer_bin_layout({folder.write("a.bin", bytes)}, kTimes);
}

TEST(BinLayout, InfersShapesFromTheValues) {
  for (std::size_t count = 3; count <= 8; ++count) {
    EXPECT_EQ(infer_bin_shape(bin_of<float>(all_columns(count))), (BinShape{4, count}));
    EXPECT_EQ(infer_bin_shape(bin_of<double>(all_columns(count))), (BinShape{8, count}));
  }
}

TEST(BinLayout, InfersShapesInAnyOrderOfPoints) {
  for (std::size_t count = 3; count <= 8; ++count) {
    Columns columns = all_columns(count);
    for (std::vector<double>& column : columns) {
      Random random(7);
      for (std::size_t i = column.size() - 1; i > 0; --i)
        std::swap(column[i], column[static_cast<std::size_t>(random.uniform(0, static_cast<double>(i)))]);
    }
    EXPECT_EQ(infer_bin_shape(bin_of<float>(columns)), (BinShape{4, count}));
  }
}

TEST(BinLayout, CountsPaddingAndUnsetColumns) {
  const TestScan scan;
  const std::vector<double> zeros(scan.x.size(), 0);
  EXPECT_EQ(infer_bin_shape(bin_of<float>({scan.x, scan.y, scan.z, zeros})), (BinShape{4, 4}));
  EXPECT_EQ(infer_bin_shape(bin_of<float>({scan.x, scan.y, scan.z, scan.intensity, zeros})), (BinShape{4, 5}));
  EXPECT_EQ(infer_bin_shape(bin_of<float>({scan.x, scan.y, scan.z, zeros, scan.intensity, zeros, zeros, zeros})),
            (BinShape{4, 8}));
}

// Lasers fire alternately in the lower and the upper half (VLP-16: -15, 1, -13, 3 degrees and so on). Consecutive points differ
// in height and range, but they are not one point of eight numbers.
TEST(BinLayout, DoesNotMergeAlternatingPoints) {
  for (const std::size_t count : {3, 4, 5, 6}) {
    const Columns all = all_columns(count);
    Columns columns(count);
    for (std::size_t step = 0; step < TestScan::kSteps; ++step)
      for (std::size_t ring = 0; ring < TestScan::kRings / 2; ++ring)
        for (const std::size_t fired : {ring, ring + TestScan::kRings / 2})
          for (std::size_t c = 0; c < count; ++c) columns[c].push_back(all[c][fired * TestScan::kSteps + step]);
    EXPECT_EQ(infer_bin_shape(bin_of<float>(columns)), (BinShape{4, count}));
  }
}

TEST(BinLayout, InfersNothingFromFewOrEqualPoints) {
  EXPECT_EQ(infer_bin_shape(""), std::nullopt);
  EXPECT_EQ(infer_bin_shape(bin_of<float>({{1, 2}, {3, 4}, {5, 6}, {0, 0}, {7, 8}})), std::nullopt);
  EXPECT_EQ(infer_bin_shape(std::string(4000, '\0')), std::nullopt);
  EXPECT_THAT(layout_of(bin_of<float>({{1, 2}, {3, 4}, {5, 6}, {0, 0}})).columns, ElementsAre("x", "y", "z", "intensity"));
}

TEST(BinLayout, InfersColumnsFromTheValues) {
  const TestScan scan;
  const std::vector<double> zeros(scan.x.size(), 0);
  const auto named = [](const Columns& columns) { return layout_of(bin_of<float>(columns)).columns; };
  EXPECT_THAT(named({scan.x, scan.y, scan.z}), ElementsAre("x", "y", "z"));
  EXPECT_THAT(named({scan.x, scan.y, scan.z, scan.intensity, scan.ring}), ElementsAre("x", "y", "z", "intensity", "ring"));
  EXPECT_THAT(named({scan.x, scan.y, scan.z, scan.intensity, zeros}), ElementsAre("x", "y", "z", "intensity", "_"));
  EXPECT_THAT(named({scan.x, scan.y, scan.z, scan.intensity, scan.ring, scan.t}),
              ElementsAre("x", "y", "z", "intensity", "ring", "t"));
  EXPECT_THAT(named({scan.x, scan.y, scan.z, scan.ring, scan.t, scan.intensity}),
              ElementsAre("x", "y", "z", "ring", "t", "intensity"));
  EXPECT_THAT(named({scan.x, scan.y, scan.z, zeros, scan.intensity, zeros, zeros, zeros}),
              ElementsAre("x", "y", "z", "_", "intensity", "_", "_", "_"))
      << "the memory layout of PCL's PointXYZI";
  Columns columns = all_columns(8);
  EXPECT_EQ(layout_of(bin_of<double>(columns)).text(), "8 columns of float64: x y z intensity ring t _ _");
}

TEST(BinLayout, RequiresOneShapeForAllFilesOfADrive) {
  const TestFolder folder;
  const fs::path four = folder.write("0.bin", bin_of<float>(all_columns(4))),
                 five = folder.write("1.bin", bin_of<float>(all_columns(5)));
  EXPECT_THAT(input_error([&] { infer_bin_layout({four, five}, kTimes); }),
              AllOf(HasSubstr("1.bin: has 5 columns of float32, but 0.bin has 4 columns of float32")));
  EXPECT_THAT(input_error([&] { read_point_cloud(five); }),
              HasSubstr("1.bin: looks like 5 columns of float32, but other scans have 4"));
  const fs::path small = folder.write("2.bin", bin_of<float>({{1, 2}, {3, 4}, {5, 6}}));
  EXPECT_THAT(input_error([&] { infer_bin_layout({small}, kTimes); }),
              AllOf(HasSubstr("2.bin: 24 bytes"), HasSubstr("[lidar] columns")));
}

// Points of numbers of several types, such as 18 bytes of x y z intensity and a 16-bit ring, repeat after a multiple of 4.
TEST(BinLayout, RequiresThatUnusualLayoutsAreStated) {
  const TestFolder folder;
  const TestScan scan;
  std::string bytes;
  for (std::size_t i = 0; i < scan.x.size(); ++i) {
    bytes += bin_of<float>({{scan.x[i]}, {scan.y[i]}, {scan.z[i]}, {scan.intensity[i]}});
    bytes += bin_of<std::uint16_t>({{scan.ring[i]}});
  }
  EXPECT_THAT(input_error([&] { infer_bin_layout({folder.write("0.bin", bytes)}, kTimes); }),
              AllOf(HasSubstr("0.bin: looks like 9 columns"), HasSubstr("[lidar] columns")));
}

TEST(BinLayout, UsesStatedColumns) {
  const TestFolder folder;
  const fs::path file = folder.write("0.bin", bin_of<float>({{1, 2}, {3, 4}, {5, 6}, {0, 0}, {7, 8}}));
  EXPECT_EQ(use_stated_layout({file}, {"x", "y", "z", "_", "ring"}).text(), "5 columns of float32: x y z _ ring");
  EXPECT_THAT(input_error([&] { use_stated_layout({file}, {"x", "y", "z"}); }),
              AllOf(HasSubstr("40 bytes are not a whole number of points of 12 bytes"), HasSubstr("correct [lidar] columns")));
  const fs::path wide = folder.write("1.bin", bin_of<double>(all_columns(5)));
  EXPECT_EQ(use_stated_layout({wide}, {"x", "y", "z", "_", "ring"}).scalar_bytes, 8U);
}

// These scans were written by other programs.
TEST(BinLayout, RecognizesScansOfDataSets) {
  const fs::path clouds = find_recording("foreign_files/clouds");
  DVI_SKIP_WITHOUT(clouds);
  const auto text = [&](const char* name) { return infer_bin_layout({clouds / name}, kTimes).text(); };
  EXPECT_EQ(text("kitti.bin"), "4 columns of float32: x y z intensity");
  EXPECT_EQ(text("nuscenes.pcd.bin"), "5 columns of float32: x y z intensity ring");
  EXPECT_EQ(text("waymo_kitti.bin"), "6 columns of float32: x y z intensity _ _");
}

}  // namespace
}  // namespace dvi::media
