#include <algorithm>
#include <cstdlib>
#include <set>
#include <string>

#include <fmt/format.h>

#include "dvi/core/text.h"
#include "dvi/objects/detect/onnx_runtime.h"

namespace dvi::objects {
namespace {

// Returns the value of an environment variable, or an empty text.
std::string read_variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string() : std::string(value);
}

// Lists the folders that hold lib/python3.*: active environments, those of programs on the PATH, of the user, and of the
// system.
std::vector<fs::path> list_prefixes() {
  std::vector<fs::path> prefixes;
  for (const char* variable : {"VIRTUAL_ENV", "CONDA_PREFIX"})
    if (const std::string value = read_variable(variable); !value.empty()) prefixes.emplace_back(value);
  std::string path = read_variable("PATH");
  for (std::size_t begin = 0; begin < path.size();) {
    const std::size_t end = std::min(path.find(':', begin), path.size());
    const fs::path folder = path.substr(begin, end - begin);
    begin = end + 1;
    std::error_code error;
    const fs::path python = fs::canonical(folder / "python3", error);
    if (error) continue;
    prefixes.push_back(folder.parent_path());  // a virtual environment
    prefixes.push_back(python.parent_path().parent_path());
  }
  if (const std::string home = read_variable("HOME"); !home.empty()) prefixes.push_back(fs::path(home) / ".local");
  prefixes.insert(prefixes.end(), {"/usr/local", "/usr"});
  return prefixes;
}

// Lists the entries of a folder, sorted; empty if it cannot be read.
std::vector<fs::path> list_entries(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    entries.push_back(entry->path());
  std::sort(entries.begin(), entries.end());
  return entries;
}

}  // namespace

std::vector<fs::path> find_onnx_runtime_libraries() {
  std::vector<fs::path> libraries;
  std::set<fs::path> known;
  for (const fs::path& prefix : list_prefixes())
    for (const fs::path& python : list_entries(prefix / "lib")) {
      if (!python.filename().string().starts_with("python3")) continue;
      for (const char* packages : {"site-packages", "dist-packages"})
        for (const fs::path& file : list_entries(python / packages / "onnxruntime/capi"))
          if (file.filename().string().starts_with("libonnxruntime.so") && known.insert(file).second) libraries.push_back(file);
    }
  return libraries;
}

}  // namespace dvi::objects
