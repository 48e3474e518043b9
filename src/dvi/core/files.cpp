#include "dvi/core/files.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <functional>
#include <ios>
#include <sstream>

#include "dvi/core/draft.h"
#include "dvi/core/error.h"
#include "dvi/core/natural_order.h"
#include "dvi/core/text_file.h"

namespace dvi {
namespace {

std::string describe_errno() { return std::strerror(errno); }

/// Returns digits that are unique to the process, also among machines that share a folder.
std::string make_process_digits() {
  std::array<char, 256> host{};
  if (gethostname(host.data(), host.size() - 1) != 0) host[0] = '\0';
  return std::to_string(std::hash<std::string>{}(host.data()) % 1'000'000) + std::to_string(getpid());
}

/// Returns whether a name has the form of temporary_beside(): .NAME.partDIGITS.EXTENSION.
bool is_temporary(const fs::path& path) {
  const std::string stem = path.stem().string();
  const std::size_t mark = stem.rfind(".part");
  return stem.starts_with('.') && mark != std::string::npos && mark + 5 < stem.size() &&
         stem.find_first_not_of("0123456789", mark + 5) == std::string::npos;
}

std::string get_lower_case_ending(const fs::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return ending;
}

void sync_file(const fs::path& path) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = descriptor >= 0 && fsync(descriptor) == 0;
  const std::string why = describe_errno();
  if (descriptor >= 0) close(descriptor);
  if (!synced) throw InputError(path, "cannot be written (" + why + ")", "free space or choose another folder");
}

// Writes the file `part`, which will be renamed to `path`.
void write_closed(const fs::path& path, const fs::path& part, const std::function<void(std::ostream&)>& write) {
  std::ofstream out(part, std::ios::binary);
  if (out) write(out);
  out.close();
  if (!out) throw InputError(path, "cannot be written (" + describe_errno() + ")", "free space or choose another folder");
}

}  // namespace

fs::path temporary_beside(const fs::path& path) {
  return path.parent_path() / ("." + path.stem().string() + ".part" + make_process_digits() + path.extension().string());
}

void remove_temporaries(const fs::path& folder) {
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (!entry.is_symlink() && entry.is_regular_file() && is_temporary(entry.path())) found.push_back(entry.path());
  for (const fs::path& file : found) fs::remove(file);
}

void require_regular_file(const fs::path& path, std::uintmax_t most) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::status_known(status) || !fs::exists(status)) throw InputError(path, "cannot be read (" + error.message() + ")");
  if (fs::is_directory(status)) throw InputError(path, "is a folder", "give a file");
  if (!fs::is_regular_file(status)) throw InputError(path, "is a pipe or a device", "give a regular file");
  const std::uintmax_t size = fs::file_size(path, error);
  if (!error && size > most)
    throw InputError(path, "has " + std::to_string(size) + " bytes, but at most " + std::to_string(most) + " are supported");
}

std::string read_file(const fs::path& path, std::uintmax_t most) {
  require_regular_file(path, most);
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path, "cannot be read (" + describe_errno() + ")");
  std::string bytes(fs::file_size(path), '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!in) throw InputError(path, "cannot be read completely");
  return bytes;
}

fs::path find_own_binary() {
  const auto here = reinterpret_cast<std::uintptr_t>(&find_own_binary);
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    std::uintptr_t begin = 0, end = 0;
    char dash = 0;
    std::istringstream fields(line);
    fields >> std::hex >> begin >> dash >> end;
    if (here < begin || here >= end || line.find('/') == std::string::npos) continue;
    // The link leads to the running program even if its file was replaced.
    const fs::path file = line.substr(line.find('/'));
    return fs::is_symlink("/proc/self/exe") && fs::read_symlink("/proc/self/exe") == file ? "/proc/self/exe" : file;
  }
  return "/proc/self/exe";
}

std::string read_settings(const fs::path& path) {
  constexpr std::size_t kMaxSettingsLineBytes = 10'000;
  std::string text = read_text(path, std::uintmax_t{1} << 20);
  std::size_t number = 1;
  for (std::size_t begin = 0; begin < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    if (end - begin > kMaxSettingsLineBytes)
      throw InputError(path.string() + ":" + std::to_string(number),
                       "the line has " + std::to_string(end - begin) + " bytes, but at most " +
                           std::to_string(kMaxSettingsLineBytes) + " are supported");
    begin = end + 1;
  }
  return text;
}

std::string read_text(const fs::path& path, std::uintmax_t most) {
  std::string text = read_file(path, most);
  const bool marked = text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF");
  if (marked || (text.size() > 1 && (text[0] == '\0') != (text[1] == '\0')))
    throw InputError(path, "is UTF-16 text", "save it as UTF-8");
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  return text;
}

std::vector<std::string> read_lines(const fs::path& path) {
  const std::string text = read_text(path);
  const char line_end = text.find('\n') == std::string::npos ? '\r' : '\n';
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line, line_end);) {
    while (!line.empty() && line.back() == '\r') line.pop_back();
    lines.push_back(line);
  }
  return lines;
}

void write_beside(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  Draft draft(path, temporary_beside(path));
  write(draft.path());
  draft.finish();
}

void write_file(const fs::path& path, const std::string& bytes) {
  write_beside(path, [&](const fs::path& part) {
    write_closed(path, part, [&](std::ostream& out) { out.write(bytes.data(), static_cast<std::streamsize>(bytes.size())); });
    sync_file(part);
  });
}

void write_stream(const fs::path& path, const std::function<void(std::ostream&)>& write) {
  write_beside(path, [&](const fs::path& part) { write_closed(path, part, write); });
}

void make_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error || !fs::is_directory(path))
    throw InputError(path, "cannot be created (" + error.message() + ")", "choose a writable folder");
}

void require_empty(const fs::path& folder, const std::string& what) {
  if (fs::exists(folder) && !(fs::is_directory(folder) && fs::is_empty(folder)))
    throw InputError(folder, "is not an empty folder", "choose a new folder for the " + what);
}

std::vector<fs::path> list_files(const fs::path& folder, const std::vector<std::string>& endings) {
  std::vector<fs::path> files;
  if (!fs::is_directory(folder)) return files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string ending = get_lower_case_ending(entry.path());
    const bool hidden = entry.path().filename().string().starts_with('.');
    if (!hidden && entry.is_regular_file() && std::find(endings.begin(), endings.end(), ending) != endings.end())
      files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end(),
            [](const fs::path& a, const fs::path& b) { return natural_less(a.filename().string(), b.filename().string()); });
  return files;
}

}  // namespace dvi
