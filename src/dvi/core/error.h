#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace dvi {

/// An error in the user's data: file, problem, and remedy. Exit code 3.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
  InputError(const std::filesystem::path& path, const std::string& problem, const std::string& remedy = {});
};

/// An error in the command line or an option. Exit code 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reports SIGINT or SIGTERM. Exit code 130.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

/// Returns a message that is safe to print on a terminal: control characters other than line ends become \xNN, and very long
/// messages are shortened. File names and contents can hold any byte, and many of them.
std::string to_printable(std::string_view message);

}  // namespace dvi
