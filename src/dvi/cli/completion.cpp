#include "dvi/cli/completion.h"

#include <fmt/format.h>

#include "dvi/cli/command.h"
#include "dvi/core/error.h"

namespace dvi::cli {
namespace {

// Up to the first full stop, colon or line end, without what quotes would end at.
std::string short_text(const std::string& doc) {
  std::string out;
  for (const char c : doc.substr(0, doc.find_first_of(".:;\n"))) {
    if (c == '[' || c == ']') continue;
    out += c == '\'' || c == '"' || c == '`' || c == '\\' || c == '$' ? ' ' : c;
  }
  return out;
}

std::string names(const CommandWords& of) {
  std::string out;
  for (const CommandWords& command : of.commands) out += command.name + " ";
  for (const OptionWords& option : of.options) out += option.name + " ";
  return out;
}

// Calls `write(path, command)` for each command within, with the words that lead to it.
template <class Write>
void for_each_command(const CommandWords& in, const std::string& path, const Write& write) {
  for (const CommandWords& command : in.commands) {
    const std::string inner = path.empty() ? command.name : path + " " + command.name;
    write(inner, command);
    for_each_command(command, inner, write);
  }
}

std::string bash(const CommandWords& program) {
  std::string cases;
  for_each_command(program, "", [&](const std::string& path, const CommandWords& command) {
    cases += fmt::format("    '{}') words='{}' ;;\n", path, names(command));
  });
  return fmt::format(R"(# bash completion for dvi
_dvi() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} path='' words i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    [[ ${{COMP_WORDS[i]}} == -* ]] && break
    path+="${{path:+ }}${{COMP_WORDS[i]}}"
  done
  while :; do
    case $path in
    '') words='{}' ;;
{}    *) words='' ;;
    esac
    [[ -z $words && $path == *' '* ]] || break
    path=${{path% *}}
  done
  COMPREPLY=($(compgen -W "$words" -- "$current"))
  if [[ -n $path && $current != -* ]]; then
    compopt -o filenames 2>/dev/null
    COMPREPLY+=($(compgen -f -- "$current"))
  fi
}}
complete -F _dvi dvi
)",
                     names(program), cases);
}

std::string zsh(const CommandWords& program) {
  std::string commands, cases;
  for (const CommandWords& command : program.commands) {
    commands += fmt::format("    '{}:{}'\n", command.name, short_text(command.summary));
    std::string arguments;
    for (const OptionWords& option : command.options)
      arguments += fmt::format(" '{}[{}]{}'", option.name, short_text(option.doc), option.takes_value ? ":value:_files" : "");
    std::string inner;
    for (const CommandWords& c : command.commands) inner += " " + c.name;
    cases += fmt::format("    {}) _arguments{} {} ;;\n", command.name, arguments,
                         inner.empty() ? "'*:file:_files'" : fmt::format("'1:command:({})' '*:file:_files'", inner.substr(1)));
  }
  return fmt::format(R"(#compdef dvi
_dvi() {{
  local -a commands=(
{}  )
  if ((CURRENT == 2)); then
    _describe command commands
    return
  fi
  local command=$words[2]
  shift words
  ((CURRENT--))
  case $command in
{}  esac
}}
if [[ $funcstack[1] == _dvi ]]; then _dvi "$@"; else compdef _dvi dvi; fi
)",
                     commands, cases);
}

std::string fish(const CommandWords& program) {
  std::string out = "# fish completion for dvi\n";
  for (const CommandWords& command : program.commands) {
    out +=
        fmt::format("complete -c dvi -n __fish_use_subcommand -f -a {} -d '{}'\n", command.name, short_text(command.summary));
    const std::string within = fmt::format("complete -c dvi -n '__fish_seen_subcommand_from {}'", command.name);
    for (const CommandWords& inner : command.commands)
      out += fmt::format("{} -f -a {} -d '{}'\n", within, inner.name, short_text(inner.summary));
    for (const OptionWords& option : command.options)
      out += fmt::format("{} -l {}{} -d '{}'\n", within, option.name.substr(2), option.takes_value ? " -r" : "",
                         short_text(option.doc));
  }
  return out;
}

}  // namespace

std::string completion_script(const CommandWords& program, const std::string& shell) {
  if (shell == "bash") return bash(program);
  if (shell == "zsh") return zsh(program);
  if (shell == "fish") return fish(program);
  throw UsageError(fmt::format("there is no completion for '{}': there is bash, zsh and fish", shell));
}

void add_completion(Program& program) {
  struct Arguments {
    std::string shell;
  };
  const auto a = std::make_shared<Arguments>();
  Command command = program.command("completion", "A script with which bash, zsh or fish completes dvi's command line");
  command.positional("SHELL", a->shell, "bash, zsh or fish");
  command.examples({"source <(dvi completion bash)", "dvi completion fish > ~/.config/fish/completions/dvi.fish"});
  command.run([a, &program] { fmt::print("{}", completion_script(program.words(), a->shell)); });
}

}  // namespace dvi::cli
