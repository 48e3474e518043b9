#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace dvi {

/// The user's data are not as they must be: which file, what is wrong, what would be right. Exit code 3.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
  InputError(const std::filesystem::path& path, const std::string& problem, const std::string& remedy = {});
};

/// The command line or an option is not as it must be. Exit code 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// SIGINT or SIGTERM arrived. Exit code 130.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

/// A message as a terminal may show it: control characters but line ends as \xNN, and cut where it is very long. File names
/// and contents can hold any byte, and many.
std::string printable(std::string_view message);

}  // namespace dvi
