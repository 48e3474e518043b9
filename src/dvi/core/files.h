#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

namespace dvi {

namespace fs = std::filesystem;

/// The maximum size in bytes of a file that is read as a whole.
inline constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{1} << 30;

/// Throws InputError if a file cannot be read, is not a regular file (a pipe or device may never end) or exceeds `most` bytes.
void require_regular_file(const fs::path& path, std::uintmax_t most = kMaxFileBytes);

/// Reads a whole file. Throws InputError like require_regular_file().
std::string read_file(const fs::path& path, std::uintmax_t most = kMaxFileBytes);

/// Returns the file that holds this code: the program, or the library from which it was loaded.
fs::path find_own_binary();

/// Reads a file of settings. Throws InputError like read_file(), and if the file exceeds 1 MiB or has lines of more than 10,000
/// bytes, since parsers recurse over the parts of a key.
std::string read_settings(const fs::path& path);

/// Reads the lines of a text file without line ends (LF, CRLF, or CR alone). Throws InputError like read_text().
std::vector<std::string> read_lines(const fs::path& path);

/// Returns the temporary path from which a file is renamed to `path`: a hidden file in the same folder with the same extension.
fs::path temporary_beside(const fs::path& path);

/// Removes the temporary files of killed processes from a folder, but not from its subfolders.
void remove_temporaries(const fs::path& folder);

/// Writes a temporary file, syncs it and renames it to `path`, so that `path` is complete or unchanged even after a power
/// failure. Throws InputError on a full or read-only disk.
void write_file(const fs::path& path, const std::string& bytes);

/// Does the same for a file that `write` makes at the given temporary path, which has the extension of `path`.
void write_beside(const fs::path& path, const std::function<void(const fs::path&)>& write);

/// Does the same for a file that `write` writes to a stream. Throws InputError if a part of it could not be written.
void write_stream(const fs::path& path, const std::function<void(std::ostream&)>& write);

/// Creates a folder and its parents. Throws InputError if that fails.
void make_folder(const fs::path& path);

/// Throws InputError unless a folder is empty or absent; `what` is its intended content, for the message.
void require_empty(const fs::path& folder, const std::string& what);

/// Lists the regular files of a folder with one of the endings (".png", in upper or lower case) in natural order; none if the
/// folder does not exist.
std::vector<fs::path> list_files(const fs::path& folder, const std::vector<std::string>& endings);

}  // namespace dvi
