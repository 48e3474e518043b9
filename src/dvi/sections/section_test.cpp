#include "dvi/sections/section.h"

#include <gmock/gmock.h>

#include "dvi/core/error.h"

namespace dvi::sections {
namespace {

/// A drive at 10 Hz whose frames are numbered from 100; `speed_mps` 0: without given poses.
Drive make_drive(int frames, double speed_mps = 0) {
  Drive drive;
  std::vector<StampedPose> poses;
  for (int i = 0; i < frames; ++i) {
    Frame frame;
    frame.number = 100 + i;
    frame.name = std::to_string(frame.number);
    frame.time_ns = std::int64_t{100'000'000} * i;
    drive.frames.push_back(frame);
    poses.push_back({frame.time_ns, {Eigen::Matrix3d::Identity(), {0.1 * speed_mps * i, 0, 0}}});
  }
  if (speed_mps > 0) drive.poses = Trajectory(poses);
  return drive;
}

job::Job job_with_gap(int frames) {
  job::Job job;
  job.options.sample.max_frame_gap = frames;
  return job;
}

testing::Matcher<const FrameRange&> is_range(int first, int last) {
  return testing::AllOf(testing::Field(&FrameRange::first, first), testing::Field(&FrameRange::last, last));
}

TEST(Sections, DivideTheFramesAndOverlap) {
  const std::vector<Section> sections = cut_into_sections(make_drive(100), 3, job_with_gap(10));
  ASSERT_EQ(sections.size(), 3U);
  EXPECT_THAT(sections[0].own, is_range(100, 132));
  EXPECT_THAT(sections[0].read, is_range(100, 142));
  EXPECT_THAT(sections[1].own, is_range(133, 165));
  EXPECT_THAT(sections[1].read, is_range(123, 175));
  EXPECT_THAT(sections[2].own, is_range(166, 199));
  EXPECT_THAT(sections[2].read, is_range(156, 199));
  EXPECT_EQ(sections[2].number, 3U);
  EXPECT_EQ(sections[2].count, 3U);
}

TEST(Sections, OverlapByDistanceWherePosesAreGiven) {
  // 5 m/s: 100 m are 200 frames, more than 60.
  EXPECT_THAT(cut_into_sections(make_drive(1000, 5), 2, job_with_gap(60))[0].read, is_range(100, 599 + 200));
  // 1 m/s: 100 m would be 1,000 frames; four times as many as the gap are enough.
  EXPECT_THAT(cut_into_sections(make_drive(1000, 1), 2, job_with_gap(60))[1].read, is_range(600 - 240, 1099));
  EXPECT_THAT(cut_into_sections(make_drive(1000, 50), 2, job_with_gap(60))[1].read, is_range(600 - 60, 1099));
}

TEST(Sections, AreAtLeastTwoFrames) {
  EXPECT_EQ(cut_into_sections(make_drive(6), 3, job_with_gap(1)).size(), 3U);
  EXPECT_THROW(cut_into_sections(make_drive(5), 3, job_with_gap(1)), UsageError);
  EXPECT_THROW(cut_into_sections(make_drive(5), 0, job_with_gap(1)), UsageError);
}

TEST(Sections, AreCountedByFramesUnlessGiven) {
  job::Job job;
  EXPECT_EQ(count_sections(job, 1), 1U);
  EXPECT_EQ(count_sections(job, 10'000), 1U);
  EXPECT_EQ(count_sections(job, 10'001), 2U);
  job.sections = 7;
  EXPECT_EQ(count_sections(job, 10), 7U);
  job.method = job::Method::telea;
  EXPECT_EQ(count_sections(job, 100'000), 1U) << "it fills each frame alone";
}

TEST(Sections, MeetAtBorders) {
  const Drive drive = make_drive(100);
  const std::vector<Border> borders = find_borders(drive, cut_into_sections(drive, 2, job_with_gap(10)));
  ASSERT_EQ(borders.size(), 1U);
  EXPECT_EQ(borders[0].time_ns, 4'950'000'000);
  EXPECT_EQ(borders[0].reach_ns, 950'000'000) << "to the tenth frame on each side";
  EXPECT_EQ(section_at(borders, drive.frames[49].time_ns), 0U);
  EXPECT_EQ(section_at(borders, drive.frames[50].time_ns), 1U);
  const std::vector<Border> near = find_borders(drive, cut_into_sections(drive, 4, job_with_gap(30)));
  for (std::size_t k = 0; k + 1 < near.size(); ++k)
    EXPECT_LE(near[k].time_ns + near[k].reach_ns, near[k + 1].time_ns - near[k + 1].reach_ns) << "no time is near two borders";
}

TEST(Sections, AreJobsWithFramesOfTheirOwn) {
  job::Job whole;
  whole.sections = 3;
  whole.out = "out";
  const job::Job job = section_job(whole, {2, 3, {10, 19}, {5, 24}}, "folder");
  EXPECT_EQ(job.read.frames, "5:24");
  EXPECT_EQ(job.out, "folder");
  EXPECT_EQ(job.sections, 1);
}

}  // namespace
}  // namespace dvi::sections
