#include "dvi/inputs/recordings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/media/write_image.h"
#include "dvi/testing/temp_folder.h"

namespace dvi::inputs {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

class OpenedDrive : public testing::Test {
 protected:
  OpenedDrive() {
    folder.write("dvi.toml",
                 "[camera.front]\nsize=[8,6]\nK=[4,0,4,0,4,3,0,0,1]\ncamera_from_lidar=[0,-1,0,0, 0,0,-1,0, 1,0,0,0]\n");
    const float points[] = {1, 0, 0, 0, 9, 0, 0, 0};  // one below the minimum range, one in range
    for (const char* name : {"0", "1"}) {
      folder.write(std::string("lidar/") + name + ".bin", std::string(reinterpret_cast<const char*>(points), sizeof points));
      make_folder(folder.path / "images/front");
      media::write_png(folder.path / "images/front" / (std::string(name) + ".png"), cv::Mat3b(6, 8, cv::Vec3b()));
    }
    make_folder(folder.path / "masks/front");
    media::write_png(folder.path / "masks/front/0.png", cv::Mat1b(6, 8, uchar{255}));
    job.target = folder.path.string();
  }
  TempFolder folder;
  job::Job job;
  Progress progress{ProgressStyle::quiet};
};

TEST_F(OpenedDrive, FramesWithoutAMaskCauseAWarningAndHaveAFingerprint) {
  const Recordings drives = open_recordings(job, MaskNeed::required, progress);
  EXPECT_THAT(drives.front().drive.warnings, Contains("1 of 2 frames have no mask file, and nothing is removed in them: 1"));
  Fingerprint print;
  add_files(print, drives.front());
  EXPECT_FALSE(print.hex().empty());
}

TEST_F(OpenedDrive, WithoutMasksAndLabelsMovingObjectsAreFound) {
  const TempFolder bare;
  fs::copy(folder.path, bare.path, fs::copy_options::recursive);
  fs::remove_all(bare.path / "masks");
  job.sources = {bare.path.string()};
  const Recordings drives = open_recordings(job, MaskNeed::required, progress);
  ASSERT_EQ(drives.size(), 2);
  EXPECT_EQ(drives[0].masks_from, MaskSources{MaskSource::files});
  EXPECT_EQ(drives[1].masks_from, MaskSources{MaskSource::found});
  job.sources.clear();
  job.target = bare.path.string();
  EXPECT_THAT(open_recordings(job, MaskNeed::optional, progress).front().masks_from, IsEmpty());
  job.method = job::Method::telea;
  EXPECT_THAT(input_error([&] { open_images(job, progress); }), HasSubstr("dvi mask"));
}

TEST_F(OpenedDrive, WarnsIfTheRangeExcludesManyReturns) {
  const Recordings drives = open_recordings(job, MaskNeed::required, progress);
  EXPECT_THAT(verify(drives, job, progress),
              Contains(AllOf(HasSubstr("50 % of all returns are not used"), HasSubstr("lidar.min_range_m = 2"))));
  job.options.map.min_range_m = 0.1;
  EXPECT_TRUE(verify(drives, job, progress).empty());
}

TEST(SourceNumbers, HaveSixteenBits) {
  Recordings drives(2);
  drives[0].drive.frames.resize(65'000);
  drives[1].drive.frames.resize(534);
  EXPECT_NO_THROW(require_provenance_range(drives));
  drives[1].drive.frames.resize(535);
  EXPECT_THROW(require_provenance_range(drives), InputError);
}

TEST(SourcePositions, HaveTwelveBitsBeforeThePoint) {
  Recordings drives(1);
  drives[0].drive.camera.width = 4096;
  drives[0].drive.camera.height = 2160;
  EXPECT_NO_THROW(require_provenance_range(drives));
  drives[0].drive.camera.width = 4097;
  EXPECT_THAT(input_error([&] { require_provenance_range(drives); }),
              AllOf(HasSubstr("4097x2160 pixels"), HasSubstr("at most 4096")));
}

TEST_F(OpenedDrive, WarnsOfATruncatedScan) {
  std::string points;
  for (int i = 0; i < 20; ++i) {
    const float point[] = {9, 0, 0, 0};
    points.append(reinterpret_cast<const char*>(point), sizeof point);
  }
  for (const char* name : {"0", "1"}) folder.write(std::string("lidar/") + name + ".bin", points);
  EXPECT_TRUE(verify(open_recordings(job, MaskNeed::required, progress), job, progress).empty());
  folder.write("lidar/1.bin", points.substr(0, 16));
  EXPECT_THAT(verify(open_recordings(job, MaskNeed::required, progress), job, progress),
              Contains(AllOf(HasSubstr("1 of 2 scans"), HasSubstr("the first is 1 with 1"))));
}

TEST_F(OpenedDrive, TheMinimumRangeDependsOnTheSensorUnlessTheUserSetsIt) {
  Recordings drives = open_recordings(job, MaskNeed::required, progress);
  drives.front().drive.sensor = Sensor::depth_camera;
  EXPECT_TRUE(verify(drives, job, progress).empty());
  job.table().set("lidar.min_range_m=2");
  EXPECT_THAT(verify(drives, job, progress), Contains(HasSubstr("lidar.min_range_m = 2")));
}

}  // namespace
}  // namespace dvi::inputs
