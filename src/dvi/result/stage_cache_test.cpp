#include "dvi/result/stage_cache.h"

#include <vector>

#include <gmock/gmock.h>

#include "dvi/result/manifest.h"
#include "dvi/testing/temp_folder.h"

namespace dvi::result {
namespace {

using testing::ElementsAre;

class StageCacheTest : public testing::Test {
 protected:
  /// Runs the stage "map", which returns `value` and warns, with the cache. Sets warnings_ to the warnings of this call.
  int call(int value, const std::string& fingerprint = "inputs") {
    Progress progress(ProgressStyle::quiet);
    progress.warn("before");
    const StageCache stages(folder.path, fingerprint, progress);
    const int result = stages.load_or_compute("map", [&] {
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

TEST_F(StageCacheTest, ComputesAStageOnceAndRepeatsItsWarnings) {
  for (const int value : {1, 2}) {
    EXPECT_EQ(call(value), 1);
    EXPECT_THAT(warnings_, ElementsAre("before", "few points", "after"));
  }
  EXPECT_THAT(list_cached_stages(folder.path), ElementsAre("map"));
}

TEST_F(StageCacheTest, ComputesAStageOfOtherInputsAgain) {
  call(1);
  EXPECT_EQ(call(2, "others"), 2);
  EXPECT_EQ(call(3, "others"), 2);
}

TEST_F(StageCacheTest, ComputesADamagedStageAgain) {
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

TEST_F(StageCacheTest, ComputesAStageOfAnotherSchemaAgain) {
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
