#include "dvi/result/segment_store.h"

#include <memory>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "dvi/result/manifest.h"
#include "dvi/result/result_layout.h"
#include "dvi/testing/temp_folder.h"

namespace dvi::result {
namespace {

class SegmentStoreTest : public testing::Test {
 protected:
  SegmentStoreTest() {
    make_folder(out / ".dvi/frames/left");
    for (const std::string& name : names) finish_frame(name, "hash of " + name);
  }
  void finish_frame(const std::string& name, const std::string& hash) const {
    write_manifest(frame_manifest(out, name), {.fingerprint = "inputs",
                                               .files = {{"frames/" + name + ".png", 1, hash}},
                                               .content = std::make_shared<const nlohmann::json>("a frame")});
  }
  const TempFolder folder;
  const fs::path out = folder.path;
  const std::vector<std::string> names{"left/000016", "left/000017"};
  const SegmentStore store{out};
  const MediaSegment segment{.result = {{true, {1, 2, 3}}, {false, {}}}, .compare = {{true, {4}}, {false, {255, 0}}}};
};

TEST_F(SegmentStoreTest, ReturnsTheSegmentOfTheSameFrames) {
  EXPECT_TRUE(store.lacks(names));
  EXPECT_FALSE(store.read(names));
  store.write(names, segment);
  EXPECT_FALSE(store.lacks(names));
  const std::optional<MediaSegment> read = store.read(names);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->result, segment.result);
  EXPECT_EQ(read->compare, segment.compare);
  EXPECT_FALSE(store.read(std::span(names).first(1))) << "another number of frames";
  store.remove_all();
  EXPECT_TRUE(store.lacks(names));
  EXPECT_FALSE(fs::exists(out / ".dvi/video"));
}

TEST_F(SegmentStoreTest, DoesNotReturnASegmentOfOtherImages) {
  store.write(names, segment);
  finish_frame(names[1], "another hash");
  EXPECT_FALSE(store.read(names));
  EXPECT_TRUE(store.lacks(names));
}

TEST_F(SegmentStoreTest, DoesNotReturnADamagedSegment) {
  store.write(names, segment);
  const fs::path file = out / ".dvi/video/left/000016.bin";
  const std::string bytes = read_file(file);
  for (const std::string& damaged : {bytes.substr(0, bytes.size() / 2), std::string(), std::string(bytes.size(), '\0')}) {
    write_file(file, damaged);
    EXPECT_FALSE(store.read(names));
    EXPECT_TRUE(store.lacks(names));
  }
}

TEST_F(SegmentStoreTest, DoesNotTakeUnfinishedFrames) {
  store.write(names, segment);
  write_file(frame_manifest(out, names[0]), "");  // begun, but not finished
  EXPECT_FALSE(store.lacks(names));
  EXPECT_FALSE(store.read(names));
  EXPECT_THROW(store.write(names, segment), InputError);
}

}  // namespace
}  // namespace dvi::result
