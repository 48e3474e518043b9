#include "dvi/cli/command.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "dvi/core/error.h"
#include "dvi/core/version.h"

namespace dvi::cli {

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
void Command::option(const std::string& names, std::string& field, const std::string& doc, bool required) {
  impl_->app->add_option(names, field, doc)->required(required);
}
void Command::option(const std::string& names, std::optional<std::string>& field, const std::string& doc) {
  impl_->app->add_option(names, field, doc);
}
void Command::option(const std::string& names, std::vector<std::string>& field, const std::string& doc) {
  impl_->app->add_option(names, field, doc)->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}
void Command::option(const std::string& names, int& field, const std::string& doc) {
  impl_->app->add_option(names, field, doc);
}
void Command::flag(const std::string& names, bool& field, const std::string& doc) { impl_->app->add_flag(names, field, doc); }
void Command::options(OptionTable& table) {
  for (const Option& option : table.options()) {
    std::string name = "--" + option.key;
    std::replace(name.begin(), name.end(), '_', '-');
    if (impl_->app->get_option_no_throw(name) != nullptr) continue;
    const auto assign = [&table, full = option.name()](const std::string& value) { table.set(full + "=" + value); };
    if (std::holds_alternative<bool>(option.get()))
      impl_->app->add_flag_callback(name, [assign] { assign("true"); }, option.doc);
    else
      impl_->app->add_option_function<std::string>(name, assign, option.doc)->default_str(option.text());
  }
}
Command Command::subcommand(const std::string& name, const std::string& summary) {
  return Command(std::make_unique<Impl>(Impl{impl_->app->add_subcommand(name, summary)}));
}
void Command::run(std::function<void()> action) { impl_->app->callback(std::move(action)); }

struct Program::Impl {
  CLI::App app{"dvi: removes traffic from recorded drives.", "dvi"};
};

Program::Program() : impl_(std::make_unique<Impl>()) {
  impl_->app.require_subcommand(1);
  impl_->app.set_version_flag("--version", fmt::format("dvi {}", kVersion));
}
Program::~Program() = default;

Command Program::command(const std::string& name, const std::string& summary) {
  return Command(std::make_unique<Command::Impl>(Command::Impl{impl_->app.add_subcommand(name, summary)}));
}

int Program::main(int argc, char** argv) {
  const auto fail = [](int code, const std::string& message) {
    fmt::print(stderr, "dvi: {}\n", message);
    return code;
  };
  try {
    impl_->app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return impl_->app.exit(e);  // --help, --version
    return fail(2, fmt::format("{}\nSee dvi --help, or dvi COMMAND --help.", e.what()));
  } catch (const UsageError& e) {
    return fail(2, e.what());
  } catch (const InputError& e) {
    return fail(3, e.what());
  } catch (const std::filesystem::filesystem_error& e) {
    // A folder that may not be read, a loop of links, a name that is too long: the user's, wherever it was met.
    const std::string path = e.path1().empty() ? "an empty path" : e.path1().string();
    return fail(3, fmt::format("{}: cannot be used ({}); check the path and its permissions", path, e.code().message()));
  } catch (const Interrupted&) {
    return fail(130, "interrupted; call the same command again to resume");
  } catch (const std::exception& e) {
    return fail(1, fmt::format("{}\nThis is a bug in dvi {}: please report it with the command line.", e.what(), kVersion));
  }
}

void Common::add_to(Command& command, bool with_json, bool with_seed) {
  command.option("--threads", threads, "Threads to use; 0: all cores");
  if (with_seed) command.option("--seed", seed, "Random seed of streets and virtual traffic; filling uses none");
  command.flag("--quiet", quiet, "No progress, no warnings");
  command.flag("--json-log", json_log, "Progress and warnings as JSON lines on stderr");
  if (with_json) command.flag("--json", json, "The result as one JSON document on stdout");
}

}  // namespace dvi::cli
