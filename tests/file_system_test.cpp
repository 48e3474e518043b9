// If the file system refuses an operation, every command ends with exit code 3 and a message with the path.

#include <sys/mount.h>

#include <gmock/gmock.h>

#include "program.h"

namespace dvi {
namespace {

using testing::HasSubstr;

class FileSystem : public ProgramTest {
 protected:
  FileSystem() {
    small_drive();
    fs::create_symlink("loop", folder / "loop");
    write_file(folder / "file", "no folder");
  }

  void expect_refused(const std::string& arguments, const std::string& path) const {
    const Result result = dvi(arguments + " --quiet");
    EXPECT_EQ(result.code, 3) << arguments << ": " << result.err;
    EXPECT_THAT(result.err, testing::StartsWith("dvi: ")) << arguments;
    EXPECT_THAT(result.err, HasSubstr(path)) << arguments;
    EXPECT_FALSE(fs::exists(folder / "out")) << arguments << ": no result is left";
  }
};

TEST_F(FileSystem, RefusesInvalidPaths) {
  std::string deep;  // more than PATH_MAX
  for (int i = 0; i < 500; ++i) deep += "a_folder/";
  for (const std::string& path : {std::string("loop"), std::string("file/x"), std::string(300, 'a'), deep}) {
    const std::string begin = path.substr(0, path.find('/'));
    for (const char* before : {"check ", "run drive -o ", "run drive -o out --masks ", "run drive -o out --poses ",
                               "map drive -o ", "mask drive -o ", "synth --frames 1 -o ", "holdout drive -o ", "selfcheck "})
      expect_refused(before + path, begin);
    expect_refused("run " + path + " -o out", begin);
    expect_refused("eval " + path + " --truth drive/truth", begin);
    expect_refused("audit " + path + " drive", begin);
  }
}

TEST_F(FileSystem, RefusesDrivesWithBrokenLinks) {
  for (const char* part : {"dvi.toml", "poses.txt", "images", "images/front", "images/front/000002.png",
                           "masks/front/000002.png", "lidar", "lidar/000002.bin", "times", "times/lidar.txt"})
    for (const std::string& target : {fs::path(part).filename().string(), std::string(300, 'a')}) {
      const fs::path at = folder / "drive" / part, aside = folder / "aside";
      fs::rename(at, aside);
      fs::create_symlink(target, at);
      expect_refused("run drive -o out", fs::path(part).begin()->string());
      fs::remove(at);
      fs::rename(aside, at);
    }
}

TEST_F(FileSystem, RefusesAReadOnlyMount) {
  make_folder(folder / "disk");
  if (mount("tmpfs", (folder / "disk").c_str(), "tmpfs", MS_RDONLY, "size=64k") != 0)
    GTEST_SKIP() << "needs the right to mount a tmpfs";
  for (const char* before : {"run drive -o ", "map drive -o ", "mask drive -o ", "synth --frames 1 -o ", "holdout drive -o "})
    expect_refused(std::string(before) + "disk/new", "disk");
  umount((folder / "disk").c_str());
}

}  // namespace
}  // namespace dvi
