#include "dvi/result/manifest.h"

#include <cctype>
#include <memory>
#include <optional>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "dvi/testing/temp_folder.h"

namespace dvi::result {
namespace {

class ManifestFile : public testing::Test {
 protected:
  ManifestFile() {
    write_file(folder.path / "part.bin", "bytes");
    write_manifest(file, {.fingerprint = "inputs",
                          .files = list_contents(folder.path, {"part.bin"}),
                          .content = std::make_shared<const nlohmann::json>(nlohmann::json{{"hole", 7}, {"name", "\xE9"}})});
  }
  TempFolder folder;
  const fs::path file = folder.path / "part.json";
};

TEST_F(ManifestFile, IsReadBackAsItWasWritten) {
  const std::optional<Manifest> read = read_manifest(file);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->fingerprint, "inputs");
  EXPECT_EQ(read->content->at("hole"), 7);
  EXPECT_EQ(read->content->at("name"), "\xE9") << "a Latin-1 file name";
  EXPECT_TRUE(is_confirmed(file, "inputs", folder.path));
}

TEST_F(ManifestFile, ConfirmsNeitherOtherInputsNorChangedFiles) {
  EXPECT_FALSE(is_confirmed(file, "other inputs", folder.path));
  write_file(folder.path / "part.bin", "bytez");
  EXPECT_FALSE(is_confirmed(file, "inputs", folder.path));
  fs::remove(folder.path / "part.bin");
  EXPECT_FALSE(is_confirmed(file, "inputs", folder.path));
}

TEST_F(ManifestFile, SaysNothingIfAnyByteChanged) {
  const std::string bytes = read_file(file);
  for (std::size_t i = 0; i + 1 < bytes.size(); ++i) {  // the last byte is a line break
    std::string damaged = bytes;
    damaged[i] = damaged[i] == 'x' ? 'y' : 'x';
    write_file(file, damaged);
    const std::optional<Manifest> read = read_manifest(file);
    if (!read) continue;
    EXPECT_TRUE(std::isspace(static_cast<unsigned char>(bytes[i]))) << i;  // indentation has no meaning
  }
  write_file(file, bytes.substr(0, bytes.size() / 2));
  EXPECT_FALSE(read_manifest(file));
  fs::remove(file);
  EXPECT_FALSE(read_manifest(file));
}

}  // namespace
}  // namespace dvi::result
