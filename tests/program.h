#pragma once

#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <system_error>

#include <gtest/gtest.h>
#include <opencv2/core/types.hpp>

#include "dvi/testing/temp_folder.h"

namespace dvi {

/// Runs the program in a temporary folder of the test.
class ProgramTest : public testing::Test {
 protected:
  /// The image size of a small drive.
  inline static const cv::Size kSize{240, 136};

  struct Result {
    int code = -1;
    std::string out, err;
  };

  /// Runs `dvi ARGUMENTS` in the test's folder.
  Result dvi(const std::string& arguments) const { return shell(std::string(DVI_PROGRAM) + " " + arguments); }

  Result shell(const std::string& command) const {
    const fs::path out = folder / ".stdout", err = folder / ".stderr";
    const std::string line = "cd " + folder.string() + " && " + command + " >" + out.string() + " 2>" + err.string();
    const int status = std::system(line.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read_file(out), read_file(err)};
  }

  /// Makes a small synthetic drive in the test's folder. It is a copy of one that is made once per run of ctest, or once per
  /// process without ctest.
  fs::path small_drive(const std::string& name = "drive", const std::string& options = "", int frames = 6) const {
    static const TempFolder own;
    const char* shared = std::getenv("DVI_TEST_DRIVES");
    std::string drive = std::to_string(frames) + options;
    std::replace(drive.begin(), drive.end(), ' ', '_');
    const fs::path original = (shared != nullptr ? fs::path(shared) : own.path) / drive;
    if (!fs::exists(original)) {
      fs::create_directories(original.parent_path());
      const fs::path draft =
          original.string() + "-" + folder.filename().string();  // another process may make it at the same time
      const Result result = dvi("synth -o " + draft.string() + " --frames " + std::to_string(frames) +
                                " --width 240 --height 136 --beams 32 --columns 900 --quiet " + options);
      EXPECT_EQ(result.code, 0) << result.err;
      std::error_code made_by_another;
      fs::rename(draft, original, made_by_another);
      if (made_by_another) fs::remove_all(draft);
    }
    fs::copy(original, folder / name, fs::copy_options::recursive);
    return folder / name;
  }

  /// Returns the contents of every file below a folder by relative path, without files that contain times.
  std::map<std::string, std::string> contents(const fs::path& root) const {
    std::map<std::string, std::string> files = ::dvi::contents(root);
    for (const char* timed : {"report.json", "dvi.toml", "report/index.js", ".dvi/report.json"}) files.erase(timed);
    return files;
  }

  const TempFolder temporary;
  const fs::path folder = temporary.path;
};

}  // namespace dvi
