#include "dvi/core/draft.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/core/error.h"
#include "dvi/testing/temp_folder.h"

namespace dvi {
namespace {

TEST(Draft, IsRenamedWhenFinished) {
  const TempFolder folder;
  const fs::path place = folder.path / "a.txt";
  Draft draft(place, temporary_beside(place));
  write_file(draft.path(), "whole");
  EXPECT_FALSE(fs::exists(place));
  draft.finish();
  EXPECT_EQ(read_file(place), "whole");
  EXPECT_FALSE(fs::exists(draft.path()));
}

TEST(Draft, MayBeAFolderAndRemovesLeftovers) {
  const TempFolder folder;
  folder.write(".case.part/left/behind.txt", "by a killed process");
  Draft draft(folder.path / "case", folder.path / ".case.part");
  EXPECT_FALSE(fs::exists(draft.path()));
  folder.write(".case.part/file.txt", "new");
  draft.finish();
  EXPECT_EQ(read_file(folder.path / "case/file.txt"), "new");
}

TEST(Draft, IsRemovedIfNotFinished) {
  const TempFolder folder;
  const auto give_up = [&] {
    Draft draft(folder.path / "case", folder.path / ".case.part");
    folder.write(".case.part/deep/file.txt", "half");
    throw std::runtime_error("stop");
  };
  EXPECT_THROW(give_up(), std::runtime_error);
  EXPECT_TRUE(fs::is_empty(folder.path));
}

TEST(Draft, ReportsAPathThatCannotBeReplaced) {
  const TempFolder folder;
  folder.write("case/mine.txt", "years of work");
  {
    Draft draft(folder.path / "case", folder.path / ".case.part");
    folder.write(".case.part/file.txt", "new");
    EXPECT_THAT(input_error([&] { draft.finish(); }), testing::HasSubstr("case: cannot be written"));
  }
  EXPECT_EQ(read_file(folder.path / "case/mine.txt"), "years of work");
  EXPECT_FALSE(fs::exists(folder.path / ".case.part"));
}

}  // namespace
}  // namespace dvi
