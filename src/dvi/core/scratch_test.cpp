#include "dvi/core/scratch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "dvi/core/error.h"
#include "dvi/testing/temp_folder.h"

namespace dvi {
namespace {

using Numbers = ScratchVector<std::size_t>;

std::shared_ptr<Scratch> scratch(std::size_t bound, const std::filesystem::path& folder) {
  return std::make_shared<Scratch>(bound, folder);
}

TEST(Scratch, IgnoresAnEmptyTmpdir) {
  const char* set = std::getenv("TMPDIR");
  const std::string before = set != nullptr ? set : "/tmp";
  setenv("TMPDIR", "", 1);
  EXPECT_EQ(find_temporary_folder(), "/tmp");
  setenv("TMPDIR", before.c_str(), 1);
}

TEST(Scratch, HoldsEqualDataInMemoryAndOnDisk) {
  constexpr std::size_t kCount = 100'000;
  for (const std::size_t bound : {std::size_t{0}, std::size_t{1} << 30}) {
    const auto memory = scratch(bound, std::filesystem::temp_directory_path());
    Numbers numbers(memory);
    for (std::size_t i = 0; i < kCount; ++i) numbers.push_back(i);
    EXPECT_EQ(memory->on_disk() > 0, bound == 0);
    memory->page_out();
    EXPECT_EQ(std::accumulate(numbers.begin(), numbers.end(), std::size_t{0}), kCount * (kCount - 1) / 2);
    Numbers moved;
    moved = std::move(numbers);
    const Numbers copy = moved;
    EXPECT_EQ(copy, moved);
    moved = Numbers();
    EXPECT_EQ(copy.back(), kCount - 1);
  }
}

TEST(Scratch, ReleasesMemory) {
  const auto memory = scratch(0, std::filesystem::temp_directory_path());
  {
    const Numbers numbers(100'000, 1, memory);
  }
  EXPECT_EQ(memory->on_disk(), 0);
  const Numbers few(10, 1, memory);
  EXPECT_EQ(memory->on_disk(), 0) << "too small for a file";
}

TEST(Scratch, ReportsAFolderWithoutSpace) {
  const auto message = [](const std::filesystem::path& folder, std::size_t count) {
    return input_error([&] { Numbers(scratch(0, folder)).reserve(count); });
  };
  EXPECT_THAT(message("/nowhere", 100'000), testing::HasSubstr("TMPDIR"));
  EXPECT_THAT(message(std::filesystem::temp_directory_path(), std::size_t{1} << 56), testing::HasSubstr("memory_mb"));
}

}  // namespace
}  // namespace dvi
