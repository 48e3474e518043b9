#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/datasets/gps.h"
#include "dvi/datasets/reader.h"
#include "dvi/media/write_image.h"
#include "program.h"

namespace dvi {
namespace {

using testing::HasSubstr;

class ExportTest : public ProgramTest {};

/// Returns GPS fixes along the path; the world's x axis points east.
std::vector<GeoFix> fixes_along(const fs::path& drive) {
  constexpr double kNorthDegreeM = 111'210, kEastDegreeM = 73'157;  // at this latitude
  std::vector<GeoFix> fixes;
  const Trajectory path = datasets::read_drive(drive).poses;
  for (const StampedPose& pose : path.poses()) {
    const Eigen::Vector3d& at = pose.world_from_body.t;
    fixes.push_back({pose.time_ns, 49.01 + at.y() / kNorthDegreeM, 8.43 + at.x() / kEastDegreeM});
  }
  return fixes;
}

TEST_F(ExportTest, CanBeReadByOtherTools) {
  const fs::path drive = small_drive();
  write_file(drive / "gps.txt", datasets::format_fixes(fixes_along(drive)));
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  for (const char* format : {"colmap", "nerfstudio", "ply", "las", "mcap", "video"}) {
    const Result result = dvi(std::string("export ") + format + " out -o exports/" + format + " --quiet --json");
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("dvi-export/1"));
  }
  const Result ortho = dvi("export ortho out -o exports/ortho --cell-m 0.2 --quiet");
  EXPECT_TRUE(ortho.code == 0 || ortho.err.find("no GDAL") != std::string::npos) << ortho.err;
  const Result read = shell("/usr/bin/python3 " DVI_EXPORT_READER " out exports");
  EXPECT_EQ(read.code, 0) << read.out << read.err;

  // Exported masks exclude exactly the pixels that no source observed.
  for (const fs::path& file : list_files(folder / "out/kind", {".png"})) {
    const cv::Mat1b kind = media::read_png_gray(file, kSize);
    const cv::Mat1b mask = media::read_png_gray(folder / "exports/colmap/masks" / (file.filename().string() + ".png"), kSize);
    EXPECT_EQ(cv::countNonZero(cv::Mat1b(kind <= 2) != mask), 0);
    EXPECT_EQ(read_file(folder / "out/frames" / file.filename()),
              read_file(folder / "exports/colmap/images" / file.filename()));
  }
}

TEST_F(ExportTest, LeavesNoFilesIfItFails) {
  small_drive();
  ASSERT_EQ(dvi("run drive -o out --method telea --quiet").code, 0);
  const Result no_map = dvi("export colmap out -o model");
  EXPECT_EQ(no_map.code, 3);
  EXPECT_THAT(no_map.err, HasSubstr("has no poses and no map"));
  EXPECT_FALSE(fs::exists(folder / "model"));
  const Result unknown = dvi("export colmpa out -o model");
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.err,
              HasSubstr("the formats are colmap, nerfstudio, ply, las, ortho, mcap, video, holes, labels, bag, folder"));
  const Result taken = dvi("export ply out -o drive");
  EXPECT_EQ(taken.code, 3);
}

}  // namespace
}  // namespace dvi
