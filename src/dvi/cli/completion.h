#pragma once

#include <string>
#include <vector>

namespace dvi::cli {

struct OptionWords {
  std::string name, doc;  ///< "--frames"
  bool takes_value = false;
};

/// The words of a command line: a command, its options, the commands within it.
struct CommandWords {
  std::string name, summary;
  std::vector<OptionWords> options;
  std::vector<CommandWords> commands;
};

/// A script with which the shell completes commands, options and files. `shell`: bash, zsh or fish. UsageError otherwise.
std::string completion_script(const CommandWords& program, const std::string& shell);

}  // namespace dvi::cli
