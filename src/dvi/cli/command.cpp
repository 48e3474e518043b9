#include "dvi/cli/command.h"

#include <algorithm>
#include <filesystem>
#include <new>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <opencv2/core.hpp>

#include "dvi/cli/completion.h"
#include "dvi/core/error.h"
#include "dvi/core/interrupt.h"
#include "dvi/core/nearest_word.h"
#include "dvi/core/text.h"
#include "dvi/core/version.h"

namespace dvi::cli {
namespace {

constexpr const char* kOutOfMemory =
    "there is not enough memory; use fewer threads (--threads 1), smaller caches (--set job.memory_mb=N), or fewer frames "
    "(--frames A:B). Finished frames of a run are kept";

// An interrupt, with a description of the results that are kept.
class InterruptedCommand : public Interrupted {
 public:
  explicit InterruptedCommand(const std::string& kept) : text_("interrupted; " + kept) {}
  const char* what() const noexcept override { return text_.c_str(); }

 private:
  std::string text_;
};

// An action that a signal interrupts, such as a blocked read, may throw an error of its own.
void run_interruptibly(const std::function<void()>& action) {
  try {
    action();
  } catch (...) {
    throw_if_interrupted();
    throw;
  }
}

std::string ask_for(const std::string& word) { return word.empty() ? "" : fmt::format("; did you mean {}?", word); }

std::vector<std::string> commands_of(const CLI::App& command) {
  std::vector<std::string> out;
  for (const CLI::App* choice : command.get_subcommands([](const CLI::App*) { return true; }))
    out.push_back(choice->get_name());
  return out;
}

Word words_of(const CLI::App& command) {
  Word words{command.get_name(), command.get_description()};
  for (const CLI::App* inner : command.get_subcommands([](const CLI::App*) { return true; }))
    words.next.push_back(words_of(*inner));
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) words.next.push_back({"--" + name, option->get_description()});
  return words;
}

std::vector<std::string> long_names(const CLI::App& command) {
  std::vector<std::string> out;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) out.push_back("--" + name);
  return out;
}

// A command that was understood and the words that name it: none for the program itself, "config", "config dump".
struct Understood {
  const CLI::App* command;
  std::string words;

  std::string behind(const std::string& word) const { return words.empty() ? word : words + " " + word; }
  std::string see_help() const { return fmt::format("See dvi {}.", behind("--help")); }
};

// The program, then each command within the one before.
std::vector<Understood> understood(const CLI::App& program) {
  std::vector<Understood> out = {{&program, ""}};
  for (std::vector<CLI::App*> next = program.get_subcommands(); !next.empty(); next = next.front()->get_subcommands())
    out.push_back({next.front(), out.back().behind(next.front()->get_name())});
  return out;
}

std::optional<std::string> unknown_option(const Understood& in) {
  const bool wants_command = !commands_of(*in.command).empty();
  for (const std::string& word : in.command->remaining()) {
    if (word.size() < 2 || word.front() != '-') {
      if (wants_command) return std::nullopt;  // the words after an unknown command would be its options
      continue;
    }
    const std::string option = word.substr(0, word.find('='));
    return fmt::format("{} has no option {}{}\n{}", in.words.empty() ? "dvi without a command" : in.words, option,
                       ask_for(nearest_word(option, long_names(*in.command))), in.see_help());
  }
  return std::nullopt;
}

// Returns a check of an argument: the problem if it is not a whole number of at least `least`, else an empty text.
std::function<std::string(const std::string&)> whole_number(int least) {
  return [least](const std::string& text) -> std::string {
    const std::optional<int> value = to_integer(text);
    if (!value) return fmt::format("'{}' is not a whole number", text);
    return *value < least ? fmt::format("{} is less than {}", *value, least) : "";
  };
}

// What is wrong with a command line that was not understood. Unknown words come first: CLI11 would name what is missing.
std::string explain(const CLI::App& program, const CLI::ParseError& error) {
  const std::vector<Understood> commands = understood(program);
  for (const Understood& in : commands)
    if (const std::optional<std::string> unknown = unknown_option(in)) return *unknown;
  const Understood& last = commands.back();
  const std::vector<std::string> choices = commands_of(*last.command);
  const std::vector<std::string> rest = last.command->remaining();
  if (choices.empty() && rest.empty()) return fmt::format("{}\n{}", error.what(), last.see_help());
  if (choices.empty()) return fmt::format("{}: '{}' is one argument too many\n{}", last.words, rest.front(), last.see_help());
  if (rest.empty()) return fmt::format("a command is missing: dvi {}\n\n{}", last.behind("COMMAND"), program.help());
  const std::string meant = nearest_word(rest.front(), choices);
  return fmt::format("there is no command '{}'{}\n{}", last.behind(rest.front()),
                     ask_for(meant.empty() ? "" : last.behind(meant)), last.see_help());
}

}  // namespace

struct Command::Impl {
  CLI::App* app;
};

Command::Command(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Command::~Command() = default;
Command::Command(Command&&) noexcept = default;

void Command::positional(const std::string& name, std::string& field, const std::string& doc, bool required) {
  impl_->app->add_option(name, field, doc)->required(required);
}
void Command::positional(const std::string& name, std::vector<std::string>& field, const std::string& doc) {
  impl_->app->add_option(name, field, doc);
}
void Command::positional(const std::string& name, int& field, const std::string& doc) {
  impl_->app->add_option(name, field, doc)->required()->check(whole_number(std::numeric_limits<int>::min()));
}
void Command::option(const std::string& names, std::string& field, const std::string& doc, bool required) {
  impl_->app->add_option(names, field, doc)->required(required);
}
void Command::option(const std::string& names, std::vector<std::string>& field, const std::string& doc) {
  impl_->app->add_option(names, field, doc)->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}
void Command::option(const std::string& names, int& field, const std::string& doc, int least) {
  impl_->app->add_option(names, field, doc)->check(whole_number(least));
}
void Command::flag(const std::string& names, bool& field, const std::string& doc) { impl_->app->add_flag(names, field, doc); }
void Command::options(const OptionTable& table, std::vector<Assignment>& given, const std::vector<std::string>& names) {
  using Strings = std::vector<std::string>;
  for (const Option& option : table.options()) {
    if (option.flag.empty()) continue;
    if (!names.empty() && std::find(names.begin(), names.end(), option.name()) == names.end()) continue;
    const auto give = [&given, flag = option.flag](const OptionValue& value) { given.push_back({flag, value}); };
    if (std::holds_alternative<bool>(option.get()))
      impl_->app->add_flag_callback(option.flag, [give] { give(true); }, option.doc);
    else if (std::holds_alternative<Strings>(option.get()))
      impl_->app->add_option_function<Strings>(option.flag, give, option.doc + " Repeatable.")->expected(1)->take_all();
    else
      impl_->app->add_option_function<std::string>(option.flag, give, option.doc)->default_str(option.plain());
  }
}
void Command::option_file(std::string& config, std::vector<Assignment>& given) {
  option("--config", config, "Reads options from a TOML file, such as the dvi.toml of an earlier result.");
  const auto set = [&given](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) given.push_back(Assignment::parse(text));
  };
  impl_->app
      ->add_option_function<std::vector<std::string>>(
          "--set", set, "Sets section.key=value. Repeatable; dvi config dump --all lists all options.")
      ->expected(1)
      ->take_all();
}
void Command::examples(const std::vector<std::string>& lines) {
  std::string text = "Examples:";
  for (const std::string& line : lines) text += "\n  " + line;
  impl_->app->footer(text);
}
Command Command::subcommand(const std::string& name, const std::string& summary) {
  impl_->app->require_subcommand(1);
  return Command(std::make_unique<Impl>(Impl{impl_->app->add_subcommand(name, summary)}));
}
void Command::run(std::function<void()> action, std::function<std::string()> kept) {
  impl_->app->callback([action = std::move(action), kept = std::move(kept)] {
    try {
      run_interruptibly(action);
    } catch (const Interrupted&) {
      throw InterruptedCommand(kept ? kept() : "nothing is kept, the same command starts again");
    }
  });
}

struct Program::Impl {
  CLI::App app{"dvi: removes traffic from recorded drives, and fills the holes with pixels of other frames.", "dvi"};
  std::string group = "Commands";
};

Program::Program() : impl_(std::make_unique<Impl>()) {
  impl_->app.require_subcommand(1);
  impl_->app.footer(
      "Examples:\n"
      "  dvi demo                     on a synthetic street\n"
      "  dvi check DRIVE              contents of the recording, missing data\n"
      "  dvi run DRIVE -o OUT         the drive without its traffic\n"
      "  dvi export colmap OUT -o DIR for another tool\n"
      "dvi COMMAND --help lists the options of a command.");
  impl_->app.set_version_flag("--version", fmt::format("dvi {}", kVersion));
}
Program::~Program() = default;

void Program::group(const std::string& heading) { impl_->group = heading; }

Command Program::command(const std::string& name, const std::string& summary) {
  CLI::App* const command = impl_->app.add_subcommand(name, summary)->group(impl_->group);
  command->footer("");  // by default, CLI11 repeats the footer of the program
  return Command(std::make_unique<Command::Impl>(Command::Impl{command}));
}

Word Program::words() const { return words_of(impl_->app); }

int Program::main(int argc, char** argv) {
  const auto fail = [](int code, const std::string& message) {
    fmt::print(stderr, "dvi: {}\n", to_printable(message));
    return code;
  };
  const auto fail_for_bug = [&](const std::exception& e) {
    return fail(1, fmt::format("{}\nThis is a bug in dvi {}: please report it with the command line.", e.what(), kVersion));
  };
  try {
    impl_->app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return impl_->app.exit(e);  // --help, --version
    return fail(2, explain(impl_->app, e));
  } catch (const UsageError& e) {
    return fail(2, e.what());
  } catch (const InputError& e) {
    return fail(3, e.what());
  } catch (const std::filesystem::filesystem_error& e) {
    // A folder that may not be read, a loop of links, a name that is too long: the user's, wherever it was met.
    const std::string path = e.path1().empty() ? "an empty path" : e.path1().string();
    return fail(3, fmt::format("{}: cannot be used ({}); check the path and its permissions", path, e.code().message()));
  } catch (const Interrupted& e) {
    return fail(130, e.what());
  } catch (const std::bad_alloc&) {
    return fail(3, kOutOfMemory);
  } catch (const cv::Exception& e) {
    return e.code == cv::Error::StsNoMem ? fail(3, kOutOfMemory) : fail_for_bug(e);
  } catch (const std::exception& e) {
    return fail_for_bug(e);
  }
}

void Common::add_to(Command& command, bool with_json, bool with_seed) {
  command.option("--threads", threads, "Threads to use; 0: all cores", 0);
  if (with_seed) command.option("--seed", seed, "Random seed of streets and virtual traffic; filling uses none");
  command.flag("--quiet", quiet, "No progress, no warnings");
  command.flag("--json-log", json_log, "Progress and warnings as JSON lines on stderr");
  if (with_json) command.flag("--json", json, "The result as one JSON document on stdout");
}

}  // namespace dvi::cli
