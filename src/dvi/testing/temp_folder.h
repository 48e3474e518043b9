#pragma once

#include <unistd.h>

#include <cstdlib>
#include <map>
#include <string>
#include <system_error>

#include <gtest/gtest.h>

#include "dvi/core/error.h"
#include "dvi/core/files.h"

namespace dvi {

/// A temporary folder, which is removed with this object.
class TempFolder {
 public:
  TempFolder() {
    std::string name = (fs::path(testing::TempDir()) / "dvi-test-XXXXXX").string();
    path = mkdtemp(name.data());
  }
  ~TempFolder() {
    std::error_code ignored;
    fs::permissions(path, fs::perms::owner_all, ignored);  // a test may have made it read-only
    fs::remove_all(path, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  /// Writes a file, creates its folders, and returns its path.
  fs::path write(const fs::path& name, const std::string& bytes) const {
    make_folder((path / name).parent_path());
    write_file(path / name, bytes);
    return path / name;
  }

  fs::path path;
};

/// Returns the contents of every file below a folder, by relative path.
inline std::map<std::string, std::string> contents(const fs::path& root) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(root))
    if (entry.is_regular_file()) files[fs::relative(entry.path(), root).string()] = read_file(entry.path());
  return files;
}

/// Returns the message of the InputError that `body` throws. If it throws none, the test fails.
template <class Body>
std::string input_error(const Body& body) {
  try {
    body();
  } catch (const InputError& e) {
    return e.what();
  }
  ADD_FAILURE() << "no InputError was thrown";
  return {};
}

}  // namespace dvi
