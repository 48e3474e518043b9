#include "parser.h"

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "dvi/core/error.h"

namespace dvi::fuzz {
namespace {

constexpr std::size_t kLongestMessage = 4000;  // what classify.py allows

// Removed as the process ends; after a finding it stays, within the runner's own $TMPDIR.
struct Folder {
  Folder() {
    std::string name = (fs::temp_directory_path() / "dvi-parser-XXXXXX").string();
    require(mkdtemp(name.data()) != nullptr, "a temporary folder can be made");
    path = name;
  }
  ~Folder() { fs::remove_all(path); }
  fs::path path;
};

void judge(const std::string& message, const fs::path& folder) {
  require(message.find(folder.string()) != std::string::npos, "the message names the file");
  require(to_printable(message).size() <= kLongestMessage, "the message is short");
}

}  // namespace

fs::path put(const fs::path& file, const std::string& bytes) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << bytes;
  return file;
}

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "dvi: does not hold: %s\n", what);
  std::abort();
}

void put_two_frames(const fs::path& images, const fs::path& scans) {
  using namespace std::string_literals;
  if (fs::exists(images)) return;
  for (const std::string name : {"1", "2"}) {
    put(images / (name + ".png"), "\x89PNG\r\n\x1A\n\0\0\0\rIHDR\0\0\0\x08\0\0\0\x06\x08\x02\0\0\0"s);
    put(scans / (name + ".bin"), std::string(16, '\0'));
  }
}

}  // namespace dvi::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const dvi::fuzz::Folder folder;
  try {
    dvi::fuzz::parse(folder.path, std::string(reinterpret_cast<const char*>(data), size));
  } catch (const dvi::InputError& e) {
    dvi::fuzz::judge(e.what(), folder.path);
  } catch (const dvi::UsageError& e) {
    dvi::fuzz::judge(e.what(), folder.path);
  }
  return 0;
}
