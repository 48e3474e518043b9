#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "dvi/core/files.h"

namespace dvi {

/// A folder of its own for each test, gone after it.
class ProgramTest : public testing::Test {
 protected:
  struct Result {
    int code = -1;
    std::string out, err;
  };

  ProgramTest() {
    std::string name = (fs::temp_directory_path() / "dvi-test-XXXXXX").string();
    folder = mkdtemp(name.data());
  }
  ~ProgramTest() override {
    std::error_code ignored;
    fs::permissions(folder, fs::perms::owner_all, ignored);
    fs::remove_all(folder, ignored);
  }

  /// Runs `dvi ARGUMENTS` in the test's folder.
  Result dvi(const std::string& arguments) const { return shell(std::string(DVI_PROGRAM) + " " + arguments); }

  Result shell(const std::string& command) const {
    const fs::path out = folder / ".stdout", err = folder / ".stderr";
    const std::string line = "cd " + folder.string() + " && " + command + " >" + out.string() + " 2>" + err.string();
    const int status = std::system(line.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read_file(out), read_file(err)};
  }

  /// A small synthetic drive, made once for all tests of the process and copied.
  fs::path small_drive(const std::string& name = "drive", const std::string& options = "") const {
    static std::map<std::string, fs::path> made;
    fs::path& original = made[options];
    if (original.empty()) {
      std::string keep = (fs::temp_directory_path() / "dvi-test-drive-XXXXXX").string();
      original = fs::path(mkdtemp(keep.data())) / "drive";
      const Result result = dvi("synth -o " + original.string() +
                                " --frames 6 --width 240 --height 136 --beams 32 --columns 900 --quiet " + options);
      EXPECT_EQ(result.code, 0) << result.err;
    }
    fs::copy(original, folder / name, fs::copy_options::recursive);
    return folder / name;
  }

  /// Every file below a folder by its relative path, but for what tells times.
  std::map<std::string, std::string> contents(const fs::path& root) const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(root)) {
      const std::string name = fs::relative(entry.path(), root).string();
      if (entry.is_regular_file() && name != "report.json" && name != ".dvi/job.json" && name != "dvi.toml")
        files[name] = read_file(entry.path());
    }
    return files;
  }

  fs::path folder;
};

}  // namespace dvi
