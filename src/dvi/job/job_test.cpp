#include "dvi/job/job.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/core/error.h"

namespace dvi::job {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StrEq;
using testing::ThrowsMessage;

// Defaults, the method's values, then the file: the order in which a run takes them.
Job reread(const std::string& toml) {
  const fs::path file =
      fs::path(testing::TempDir()) / (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".toml");
  write_file(file, toml);
  Job job;
  job.table().load_toml(file);
  use_method(job.method, job.options);
  job.table().load_toml(file);
  return job;
}

TEST(Job, UsersAreShownFewOptions) {
  Job job;
  const OptionTable table = job.table();
  const auto users = std::count_if(table.options().begin(), table.options().end(),
                                   [](const Option& o) { return o.audience == Audience::user; });
  EXPECT_LE(users, 30);
  EXPECT_GT(table.options().size(), 60);
}

TEST(Job, RangeOfTheScansIsOneOptionForOdometryAndMap) {
  Job job;
  EXPECT_FALSE(job.options.map.min_range_m) << "the sensor's";
  job.table().set("lidar.min_range_m=3");
  EXPECT_EQ(job.options.odometry.min_range_m, 3);
  EXPECT_EQ(job.options.map.min_range_m, 3);
  EXPECT_NO_THROW(job.options.check());
  job.table().set("lidar.max_range_m=2");
  EXPECT_THAT([&] { job.options.check(); },
              ThrowsMessage<UsageError>(StrEq("option lidar.max_range_m = 2: must be greater than lidar.min_range_m = 3")));
}

TEST(Job, CheckNamesFieldValueAndWhatIsAllowed) {
  Options options;
  EXPECT_NO_THROW(options.check());
  options.depth.median_px = 4;
  EXPECT_THAT([&] { options.check(); }, ThrowsMessage<UsageError>(StrEq("option depth.median_px = 4: must be one of 0, 3, 5")));
  options.depth.median_px = 3;
  options.regularize.window = 4;
  EXPECT_THAT([&] { options.check(); },
              ThrowsMessage<UsageError>(HasSubstr("option regularize.window = 4: must be one of 1, 3, 5")));
  options.regularize.window = 3;
  options.map.voxel_m = -1;
  EXPECT_THAT([&] { options.check(); },
              ThrowsMessage<UsageError>(HasSubstr("option map.voxel_m = -1.0: must be within 0.005 .. 1")));
}

TEST(Job, ChoicesAreWordsOrPaths) {
  EXPECT_EQ(PosesFrom::parse("auto").kind, PosesFrom::Kind::automatic);
  EXPECT_EQ(PosesFrom::parse("").kind, PosesFrom::Kind::automatic);
  EXPECT_EQ(PosesFrom::parse("poses.txt").file, "poses.txt");
  EXPECT_EQ(MasksFrom::parse("labels").kind, MasksFrom::Kind::labels);
  for (const char* text : {"auto", "given", "loam", "a/poses.txt"}) EXPECT_EQ(to_string(PosesFrom::parse(text)), text);
  EXPECT_EQ(MasksFrom::parse("found").kind, MasksFrom::Kind::found);
  for (const char* text : {"auto", "labels", "found", "none", "a/masks", "white:a/masks", "black:labels"})
    EXPECT_EQ(to_string(MasksFrom::parse(text)), text);
  for (const std::string& name : list_names<Method>()) EXPECT_EQ(to_string(parse_name<Method>(name)), name);
  EXPECT_TRUE(is_baseline(Method::ns));
  EXPECT_FALSE(is_baseline(Method::paper));
}

// The options that a run records have to give the same run again, although they omit developer options with their default.
TEST(Job, RecordedOptionsReadBackAsTheyWere) {
  for (const char* change : {"", "depth.median_px=0", "depth.median_px=3", "stages.smooth=false", "align.method=joint",
                             "sample.max_frame_gap=120", "job.masks=a/folder", "job.remove=all"}) {
    for (const Method method : {Method::dvi, Method::paper, Method::flow}) {
      Job job;
      job.method = method;
      use_method(method, job.options);
      if (*change != '\0') job.table().set(change);
      EXPECT_EQ(reread(effective_toml(job)).table().dump_toml(), job.table().dump_toml()) << change << to_string(method);
    }
  }
}

TEST(Job, RecordHoldsDeveloperOptionsThatDiffer) {
  Job job;
  EXPECT_THAT(effective_toml(job), Not(HasSubstr("median_px")));
  EXPECT_THAT(effective_toml(job), HasSubstr("min_range_m"));
  job.options.depth.median_px = 0;
  EXPECT_THAT(effective_toml(job), HasSubstr("median_px = 0"));
}

}  // namespace
}  // namespace dvi::job
