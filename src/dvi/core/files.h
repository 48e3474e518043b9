#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace dvi {

namespace fs = std::filesystem;

/// The largest file that is read as a whole, in bytes.
inline constexpr std::uintmax_t kLargestFile = std::uintmax_t{1} << 30;

/// InputError where it cannot be read, is no regular file (a pipe or device may never end) or is larger than `most` bytes.
void require_regular_file(const fs::path& path, std::uintmax_t most = kLargestFile);

/// The whole file. InputError as require_regular_file().
std::string read_file(const fs::path& path, std::uintmax_t most = kLargestFile);

/// The file that holds this code: the program, or the library it was loaded from.
fs::path own_binary();

/// The text of a file of settings. InputError as read_file, and where it has more than 1 MiB or lines of more than 10,000
/// bytes: parsers recurse by the parts of a key.
std::string read_settings(const fs::path& path);

/// The lines of a text file without line ends (LF, CRLF, or CR alone). Throws InputError as read_text() does.
std::vector<std::string> read_lines(const fs::path& path);

/// Where `path` is written before it is renamed: a hidden file beside it, of the same extension.
fs::path temporary_beside(const fs::path& path);

/// Removes such files from a folder, not from those below it: what a killed process was writing.
void remove_temporaries(const fs::path& folder);

/// Writes beside `path`, syncs and renames, so that `path` is whole or as before, after a power cut too. InputError on a full
/// or read-only disk.
void write_file(const fs::path& path, const std::string& bytes);

/// The same for a file that `write` makes at the temporary path it is given (which keeps the extension of `path`).
void write_beside(const fs::path& path, const std::function<void(const fs::path&)>& write);

/// Creates the folder and its parents. InputError where that is impossible.
void make_folder(const fs::path& path);

/// InputError unless the folder is empty or not there; `what` is to go into it, for the message.
void require_empty(const fs::path& folder, const std::string& what);

/// The regular files of a folder with one of the endings (".png", in either case), in natural order; none if it does not exist.
std::vector<fs::path> list_files(const fs::path& folder, const std::vector<std::string>& endings);

}  // namespace dvi
