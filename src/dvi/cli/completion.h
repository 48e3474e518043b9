#pragma once

#include <string>
#include <vector>

namespace dvi::cli {

/// A word of the command line: a command, with the words that may follow it, or an option ("--frames").
struct Word {
  std::string text, summary;
  std::vector<Word> next = {};
};

/// Returns the words that may replace the last of `typed`, the words after the name of the program: options if it begins with
/// "-", else commands. Returns nothing where a value or a file is expected.
std::vector<Word> complete(const Word& program, const std::vector<std::string>& typed);

/// Returns the script with which a shell completes commands, options, and files. It calls `dvi completion words`. `shell` is
/// bash, zsh, or fish; throws UsageError for others.
std::string completion_script(const std::string& shell);

}  // namespace dvi::cli
