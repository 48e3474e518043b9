#include "dvi/bags/bag_parts.h"

#include "dvi/bags/bag_frame_numbers.h"
#include "dvi/bags/bag_metadata.h"
#include "dvi/testing/image_folder.h"

namespace dvi::bags {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

// Written by rosbag2: rosbag2_cpp/test/rosbag2_cpp/reindex_test_bags/target_metadata/multiple_files of github.com/ros2/rosbag2.
constexpr const char* kMetadata = R"(rosbag2_bagfile_information:
  version: 4
  storage_identifier: sqlite3
  relative_file_paths:
    - drive_0.db3
    - drive_1.db3
    - drive_2.db3
  duration:
    nanoseconds: 59997863418
  starting_time:
    nanoseconds_since_epoch: 1604356847420232242
  message_count: 766
  topics_with_message_count:
    - topic_metadata:
        name: /topic
        type: std_msgs/msg/String
        serialization_format: cdr
        offered_qos_profiles: "- history: 3\n  depth: 0\n  name: /none\n  message_count: 5"
      message_count: 378
    - topic_metadata:
        name: /rosout
        type: rcl_interfaces/msg/Log
        serialization_format: cdr
        offered_qos_profiles:
          - history: keep_last
            depth: 10
      message_count: 388
  compression_format: ""
  compression_mode: ""
)";

// Written by PyYAML: rosbag2_py/test/resources/mcap/talker of the same repository.
constexpr const char* kSortedMetadata = R"(rosbag2_bagfile_information:
  compression_format: ''
  message_count: 20
  relative_file_paths:
  - talker/talker.mcap
  starting_time:
    nanoseconds_since_epoch: 1585866235112411371
  topics_with_message_count:
  - message_count: 10
    topic_metadata:
      name: /topic
      offered_qos_profiles: "- history: 3\n  depth: 0\n  reliability: 1\n  durability:\
        \ 2\n  deadline:\n    sec: 0\n    nsec: 0"
      type: std_msgs/msg/String
  - message_count: 11
    topic_metadata:
      name: /rosout
  version: 4
)";

TEST(BagMetadata, MustBeAFile) {
  const TestFolder folder;
  fs::create_directory(folder.path / "metadata.yaml");
  EXPECT_THAT(input_error([&] { read_bag_metadata(folder.path); }), HasSubstr("metadata.yaml: is a folder"));
}

TEST(BagMetadata, IsReadFromFilesOfRosbag2) {
  const TestFolder folder;
  EXPECT_FALSE(read_bag_metadata(folder.path));
  folder.write("metadata.yaml", kMetadata);
  const auto metadata = read_bag_metadata(folder.path);
  ASSERT_TRUE(metadata);
  EXPECT_THAT(metadata->files, ElementsAre("drive_0.db3", "drive_1.db3", "drive_2.db3"));
  EXPECT_THAT(metadata->counts, ElementsAre(Pair("/rosout", 388), Pair("/topic", 378)));
  folder.write("metadata.yaml", kSortedMetadata);
  const auto sorted = read_bag_metadata(folder.path);
  ASSERT_TRUE(sorted);
  EXPECT_THAT(sorted->files, ElementsAre("talker.mcap"));
  EXPECT_THAT(sorted->counts, ElementsAre(Pair("/rosout", 11), Pair("/topic", 10)));
}

TEST(BagMetadata, IgnoresOtherFilesOfThatName) {
  const TestFolder folder;
  for (const char* text : {"", "title: a page\n", "rosbag2"}) {
    folder.write("metadata.yaml", text);
    EXPECT_FALSE(read_bag_metadata(folder.path)) << text;
  }
  folder.write("metadata.yaml", "rosbag2_bagfile_information:\n- - -\n:\n  : :\n    -\n \"\n");
  EXPECT_THAT(read_bag_metadata(folder.path)->files, IsEmpty());
}

class BagPartsOf : public testing::Test {
 protected:
  // Returns the names of the parts of a folder with these files.
  BagParts parts(const std::vector<std::string>& files) {
    for (const std::string& file : files) folder.write(file, "x");
    return find_bag_parts(folder.path);
  }
  static std::vector<std::string> names(const BagParts& parts) {
    std::vector<std::string> out;
    for (const fs::path& file : parts.files) out.push_back(file.filename().string());
    return out;
  }
  TestFolder folder;
};

TEST_F(BagPartsOf, ReportsMissingFilesByMetadata) {
  folder.write("metadata.yaml", kMetadata);
  const BagParts found = parts({"drive_0.db3", "drive_2.db3"});
  EXPECT_THAT(names(found), ElementsAre("drive_0.db3", "drive_2.db3"));
  ASSERT_EQ(found.missing.size(), 1U);
  EXPECT_EQ(found.missing[0].name, "drive_1.db3");
  EXPECT_EQ(found.missing[0].position, 1U);
  EXPECT_THAT(found.warnings, ElementsAre("metadata.yaml lists drive_1.db3, which is missing"));
  EXPECT_THAT(found.counts, Contains(Pair("/topic", 378)));
}

TEST_F(BagPartsOf, ReadsFilesThatMetadataDoesNotList) {
  folder.write("metadata.yaml", kMetadata);
  const BagParts found = parts({"drive_0.db3", "drive_1.db3", "drive_2.db3", "added.db3"});
  EXPECT_THAT(names(found), ElementsAre("drive_0.db3", "drive_1.db3", "drive_2.db3", "added.db3"));
  EXPECT_THAT(found.warnings, ElementsAre(HasSubstr("does not list added.db3")));
}

TEST_F(BagPartsOf, ReadsRenamedFilesWithoutMetadata) {
  folder.write("metadata.yaml", kMetadata);
  const BagParts found = parts({"renamed.db3"});
  EXPECT_THAT(names(found), ElementsAre("renamed.db3"));
  EXPECT_THAT(found.missing, IsEmpty());
  EXPECT_THAT(found.warnings, ElementsAre(HasSubstr("drive_0.db3, drive_1.db3, drive_2.db3, which are missing")));
}

TEST_F(BagPartsOf, ReportsTheNamesIfThereIsNoFile) {
  folder.write("metadata.yaml", kMetadata);
  EXPECT_THAT(input_error([&] { parts({}); }), HasSubstr("none of the files that metadata.yaml lists: drive_0.db3"));
}

TEST_F(BagPartsOf, RefusesCompressedFiles) {
  std::string text = kMetadata;
  text.replace(text.find("drive_1.db3"), 11, "drive_1.db3.zstd");
  folder.write("metadata.yaml", text);
  EXPECT_THAT(input_error([&] { parts({"drive_0.db3", "drive_1.db3.zstd"}); }),
              AllOf(HasSubstr("drive_1.db3.zstd: is compressed as a whole"), HasSubstr("zstd -d")));
  EXPECT_THAT(parts({"drive_1.db3", "drive_2.db3"}).warnings, IsEmpty()) << "decompressed beside it";
}

TEST_F(BagPartsOf, ReportsMissingFilesByNumber) {
  const BagParts found = parts({"d_2019-07-01-12-00-00_0.bag", "d_2019-07-01-12-00-30_1.bag", "d_2019-07-01-12-05-00_10.bag"});
  EXPECT_THAT(found.files, testing::SizeIs(3));
  EXPECT_THAT(found.missing, testing::SizeIs(8));
  EXPECT_EQ(found.missing.front().position, 2U);
  EXPECT_THAT(found.warnings, ElementsAre(HasSubstr("part 2, part 3")));
}

TEST_F(BagPartsOf, IgnoresOtherNumbersInNames) {
  EXPECT_THAT(parts({"2011_09_26.bag", "2011_09_28.bag"}).warnings, IsEmpty()) << "dates";
  EXPECT_THAT(parts({"run_0.bag"}).warnings, IsEmpty()) << "beside files with other names";
}

TEST_F(BagPartsOf, WarnsOfASinglePart) {
  parts({"drive_0.db3", "drive_1.db3", "drive_2.db3", "other.db3"});
  const auto warnings = [&](const char* file) { return find_bag_parts(folder.path / file).warnings; };
  EXPECT_THAT(warnings("drive_1.db3"), ElementsAre(AllOf(HasSubstr("drive_1.db3 is one of 3 files"),
                                                         HasSubstr("masks of the whole recording do not match"))));
  EXPECT_THAT(warnings("drive_0.db3"), ElementsAre(testing::Not(HasSubstr("masks"))));
  EXPECT_THAT(warnings("other.db3"), IsEmpty());
  folder.write("metadata.yaml", kMetadata);
  EXPECT_THAT(warnings("drive_1.db3"), ElementsAre(HasSubstr("one of 3 files")));
  EXPECT_THAT(warnings("other.db3"), IsEmpty());
}

// A topic of 20 images, 100 ms apart, in files of five, some of which are missing.
class SplitTopic : public testing::Test {
 protected:
  static constexpr std::int64_t kStepNs = 100'000'000;

  void remove_file(std::size_t removed) { removed_.push_back(removed); }
  FrameNumbers numbers() {
    Bag bag;
    BagTopic topic{"/image", "sensor_msgs/Image"};
    std::vector<StampedEntry> entries;
    for (std::size_t file = 0; file < 4; ++file) {
      if (std::find(removed_.begin(), removed_.end(), file) != removed_.end()) {
        bag.missing.push_back({"part_" + std::to_string(file), bag.files.size()});
        continue;
      }
      for (std::size_t i = 5 * file; i < 5 * file + 5; ++i) {
        const std::int64_t time = static_cast<std::int64_t>(i) * kStepNs + (i % 2 == 0 ? jitter_ns : 0);
        entries.push_back({time, topic.messages.size()});
        topic.messages.push_back({time, bag.files.size(), 0, 0});
      }
      bag.files.push_back("part_" + std::to_string(file));
    }
    if (count) bag.counts["/image"] = *count;
    bag.topics.push_back(topic);
    return number_frames(BagMessages("drive", bag), topic, entries);
  }
  std::optional<std::size_t> count;  // stated by metadata.yaml
  std::int64_t jitter_ns = 0;

 private:
  std::vector<std::size_t> removed_;
};

TEST_F(SplitTopic, IsNumberedFrom0IfComplete) {
  const FrameNumbers found = numbers();
  EXPECT_THAT(found.missing_before, ElementsAre(0, 0, 0, 0));
  EXPECT_THAT(found.missing, IsEmpty());
}

TEST_F(SplitTopic, NumbersFramesAfterAMissingFileByCounts) {
  remove_file(1);
  count = 20, jitter_ns = 60'000'000;
  const FrameNumbers found = numbers();
  EXPECT_THAT(found.missing_before, ElementsAre(0, 5, 5));
  EXPECT_THAT(found.missing, ElementsAre("5-9"));
  EXPECT_FALSE(found.is_estimated);
}

TEST_F(SplitTopic, NumbersFramesAfterAMissingFirstFileByCounts) {
  remove_file(0);
  count = 20;
  EXPECT_THAT(numbers().missing_before, ElementsAre(5, 5, 5));
}

TEST_F(SplitTopic, NumbersFramesByRegularTimesWithoutCounts) {
  remove_file(1);
  jitter_ns = 5'000'000;
  const FrameNumbers found = numbers();
  EXPECT_THAT(found.missing_before, ElementsAre(0, 5, 5));
  EXPECT_TRUE(found.is_estimated);
}

TEST_F(SplitTopic, RequiresRegularTimesThatMatchTheCountsForSeveralGaps) {
  remove_file(0);
  remove_file(2);
  count = 20;
  const FrameNumbers found = numbers();
  EXPECT_THAT(found.missing_before, ElementsAre(5, 10));
  EXPECT_THAT(found.missing, ElementsAre("0-4", "10-14"));
}

TEST_F(SplitTopic, KeepsNumbersIfTheLastFileIsMissing) {
  remove_file(3);
  jitter_ns = 60'000'000;
  EXPECT_THAT(numbers().missing_before, ElementsAre(0, 0, 0));
  count = 20;
  EXPECT_THAT(numbers().missing_before, ElementsAre(0, 0, 0));
}

TEST_F(SplitTopic, RefusesUnknownNumbers) {
  remove_file(1);
  jitter_ns = 60'000'000;
  EXPECT_THAT(input_error([&] { numbers(); }),
              AllOf(HasSubstr("part_1 is missing"), HasSubstr("/image"), HasSubstr("restore")));
}

TEST_F(SplitTopic, RefusesInconsistentCounts) {
  remove_file(1);
  jitter_ns = 60'000'000;
  for (const std::size_t wrong : {3UL, 4'000'000'000'000UL}) {
    count = wrong;
    EXPECT_THAT(input_error([&] { numbers(); }), HasSubstr("unknown")) << wrong;
  }
}

}  // namespace
}  // namespace dvi::bags
