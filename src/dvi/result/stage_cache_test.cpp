#include "dvi/result/stage_cache.h"

#include <vector>

#include <gmock/gmock.h>

#include "dvi/result/manifest.h"
#include "dvi/testing/temp_folder.h"

namespace dvi::result {
namespace {

using testing::ElementsAre;

class Cached : public testing::Test {
 protected:
  // What a call gets from stage "map", which makes `value` and warns; warnings_ are those of the call.
  int call(int value, const std::string& fingerprint = "inputs") {
    Progress progress(ProgressStyle::quiet);
    progress.warn("before");
    const StageCache stages(folder.path, fingerprint, progress);
    const int result = stages.cached("map", [&] {
      progress.warn("few points");
      return value;
    });
    progress.warn("after");
    warnings_ = progress.warnings();
    return result;
  }
  TempFolder folder;
  const fs::path bin = folder.path / ".dvi/stages/map.bin", manifest = folder.path / ".dvi/stages/map.json";
  std::vector<std::string> warnings_;
};

TEST_F(Cached, StageIsMadeOnceAndWarnsEachTime) {
  for (const int value : {1, 2}) {
    EXPECT_EQ(call(value), 1);
    EXPECT_THAT(warnings_, ElementsAre("before", "few points", "after"));
  }
  EXPECT_THAT(cached_stages(folder.path), ElementsAre("map"));
}

TEST_F(Cached, OfOtherInputsIsMadeAgain) {
  call(1);
  EXPECT_EQ(call(2, "others"), 2);
  EXPECT_EQ(call(3, "others"), 2);
}

TEST_F(Cached, DamagedIsMadeAgain) {
  call(1);
  int value = 1;
  for (const fs::path& file : {bin, manifest}) {
    const std::string bytes = read_file(file);
    for (const std::string& damaged : {bytes.substr(0, bytes.size() / 2), std::string(), std::string(bytes.size(), '\0')}) {
      write_file(file, damaged);
      ++value;
      EXPECT_EQ(call(value), value);
    }
    fs::remove(file);
    ++value;
    EXPECT_EQ(call(value), value);
    EXPECT_THAT(warnings_, ElementsAre("before", "few points", "after"));
  }
}

TEST_F(Cached, OfAnotherSchemaIsMadeAgain) {
  call(1);
  {
    ArchiveWriter out(bin, "dvi-stage/2 map");
    out << std::vector<std::string>() << 7;
    out.finish();
  }
  write_manifest(manifest, {"inputs", list_contents(folder.path, {".dvi/stages/map.bin"})});
  EXPECT_EQ(call(2), 2);
}

}  // namespace
}  // namespace dvi::result
