#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dvi/core/options.h"
#include "dvi/core/progress.h"

namespace dvi::cli {

/// One command of the program: its arguments and its action. Wraps CLI11, whose header is slow to compile.
/// Fields are left as they are where the command line does not name them.
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
  void option(const std::string& names, int& field, const std::string& doc);
  void flag(const std::string& names, bool& field, const std::string& doc);
  /// The options of the table that have a flag, or those of them that are named (section.key). Values that the command
  /// line assigns to them are appended to `given`.
  void options(const OptionTable& table, std::vector<Assignment>& given, const std::vector<std::string>& names = {});
  /// --config FILE, and --set section.key=value, which is appended to `given`.
  void option_file(std::string& config, std::vector<Assignment>& given);
  /// Lines for the end of the command's help, such as "dvi run DRIVE -o OUT   the usual case".
  void examples(const std::vector<std::string>& lines);
  Command subcommand(const std::string& name, const std::string& summary);
  /// Sets the action, which runs once the whole command line is parsed. After an interrupt, `kept` names the results that the
  /// next call will use ("3 frames are kept"); without it, there are none.
  void run(std::function<void()> action, std::function<std::string()> kept = {});

 private:
  std::unique_ptr<Impl> impl_;
};

struct Word;

/// The program: reads the command line and runs the command it names. Returns the exit code: 0, 1 our bug, 2 usage, 3 the
/// user's data, 130 interrupted.
class Program {
 public:
  Program();
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  /// Commands added from now on are listed below this heading in the help.
  void group(const std::string& heading);
  Command command(const std::string& name, const std::string& summary);
  /// The words of the command line, its commands and their options, for completion.h.
  Word words() const;
  int main(int argc, char** argv);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Options that every working command has.
struct Common {
  int threads = 0, seed = 1;
  bool quiet = false, json_log = false, json = false;

  void add_to(Command& command, bool with_json, bool with_seed = true);
  ProgressStyle style() const {
    return quiet ? ProgressStyle::quiet : json_log ? ProgressStyle::json : ProgressStyle::automatic;
  }
};

/// Each adds its command; the fields it parses into live as long as the program.
void add_run(Program& program);
void add_plan(Program& program);
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
void add_completion(Program& program);
void add_init(Program& program);
void add_convert(Program& program);
void add_config(Program& program);
void add_formats(Program& program);
void add_version(Program& program);

}  // namespace dvi::cli
