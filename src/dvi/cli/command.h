#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dvi/core/options.h"
#include "dvi/core/progress.h"

namespace dvi::cli {

/// One command of the program: its arguments and its action. Wraps CLI11, whose header is slow to compile.
/// Fields that the command line does not name keep their values.
class Command {
 public:
  struct Impl;
  explicit Command(std::unique_ptr<Impl> impl);
  ~Command();
  Command(Command&&) noexcept;
  Command& operator=(Command&&) = delete;

  void positional(const std::string& name, std::string& field, const std::string& doc, bool required = true);
  void positional(const std::string& name, std::vector<std::string>& field, const std::string& doc);
  void positional(const std::string& name, int& field, const std::string& doc);
  void option(const std::string& names, std::string& field, const std::string& doc, bool required = false);
  void option(const std::string& names, std::vector<std::string>& field, const std::string& doc);
  /// The least value is -2147483648 unless `least` is given.
  void option(const std::string& names, int& field, const std::string& doc, int least = std::numeric_limits<int>::min());
  void flag(const std::string& names, bool& field, const std::string& doc);
  /// Adds the options of the table that have a flag, or those of them that `names` lists (section.key). The values that the
  /// command line assigns to them are appended to `given`.
  void options(const OptionTable& table, std::vector<Assignment>& given, const std::vector<std::string>& names = {});
  /// Adds --config FILE and --set section.key=value. The assignments of the latter are appended to `given`.
  void option_file(std::string& config, std::vector<Assignment>& given);
  /// Adds lines to the end of the command's help, such as "dvi run DRIVE -o OUT   the usual case".
  void examples(const std::vector<std::string>& lines);
  Command subcommand(const std::string& name, const std::string& summary);
  /// Sets the action, which runs once the whole command line is parsed. After an interrupt, `kept` names the results that the
  /// next call will use ("3 frames are kept"); without it, there are none.
  void run(std::function<void()> action, std::function<std::string()> kept = {});

 private:
  std::unique_ptr<Impl> impl_;
};

struct Word;

/// The program, which parses the command line and runs its command. main() returns the exit code: 0, 1 for a bug, 2 for the
/// usage, 3 for the user's data, 130 after an interrupt.
class Program {
 public:
  Program();
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  /// Sets the heading in the help for the commands that are added next.
  void group(const std::string& heading);
  Command command(const std::string& name, const std::string& summary);
  /// Returns the words of the command line, its commands and their options, for completion.h.
  Word words() const;
  int main(int argc, char** argv);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The options of every command that works on data.
struct Common {
  int threads = 0, seed = 1;
  bool quiet = false, json_log = false, json = false;

  void add_to(Command& command, bool with_json, bool with_seed = true);
  ProgressStyle style() const {
    return quiet ? ProgressStyle::quiet : json_log ? ProgressStyle::json : ProgressStyle::automatic;
  }
};

/// Each function adds one command. The fields that it parses into exist as long as the program.
void add_run(Program& program);
void add_plan(Program& program);
void add_join(Program& program);
void add_fill(Program& program);
void add_finish(Program& program);
void add_report(Program& program);
void add_inspect(Program& program);
void add_map(Program& program);
void add_mask(Program& program);
void add_eval(Program& program);
void add_audit(Program& program);
void add_check(Program& program);
void add_forecast(Program& program);
void add_holdout(Program& program);
void add_selfcheck(Program& program);
void add_synth(Program& program);
void add_demo(Program& program);
void add_export(Program& program);
void add_import_fill(Program& program);
void add_completion(Program& program);
void add_init(Program& program);
void add_convert(Program& program);
void add_config(Program& program);
void add_formats(Program& program);
void add_version(Program& program);

}  // namespace dvi::cli
