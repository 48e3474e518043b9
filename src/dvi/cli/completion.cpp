#include "dvi/cli/completion.h"

#include <algorithm>

#include <fmt/format.h>

#include "dvi/cli/command.h"
#include "dvi/core/error.h"

namespace dvi::cli {
namespace {

constexpr const char* kBash = R"script(# bash completion for dvi
_dvi() {
  mapfile -t COMPREPLY < <(dvi completion words -- "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null | cut -f1)
}
complete -o default -F _dvi dvi
)script";

constexpr const char* kZsh = R"script(#compdef dvi
_dvi() {
  local -a found=(${${(f)"$(dvi completion words -- "${(@)words[2,CURRENT]}" 2>/dev/null)"}//$'\t'/:})
  if (($#found)); then _describe -o dvi found; else _files; fi
}
if [[ $funcstack[1] == _dvi ]]; then _dvi "$@"; else compdef _dvi dvi; fi
)script";

constexpr const char* kFish = R"script(# fish completion for dvi
complete -c dvi -n __fish_use_subcommand -f
complete -c dvi -a '(dvi completion words -- (commandline -opc)[2..] (commandline -ct) 2>/dev/null)'
)script";

std::string first_clause(const std::string& text) {
  return text.substr(0, std::min({text.find(". "), text.find(": "), text.find("; "), text.find(" ("), text.find('\n')}));
}

}  // namespace

std::vector<Word> complete(const Word& program, const std::vector<std::string>& typed) {
  if (typed.empty()) return program.next;
  const Word* in = &program;
  for (auto word = typed.begin(); word + 1 != typed.end(); ++word) {
    const auto next = std::find_if(in->next.begin(), in->next.end(), [&](const Word& w) { return w.text == *word; });
    if (next != in->next.end() && !word->starts_with('-')) in = &*next;
  }
  std::vector<Word> out;
  for (const Word& word : in->next)
    if (word.text.starts_with(typed.back()) && word.text.starts_with('-') == typed.back().starts_with('-'))
      out.push_back({word.text, first_clause(word.summary)});
  return out;
}

std::string completion_script(const std::string& shell) {
  if (shell == "bash") return kBash;
  if (shell == "zsh") return kZsh;
  if (shell == "fish") return kFish;
  throw UsageError(fmt::format("there is no completion for '{}': there is bash, zsh and fish", shell));
}

void add_completion(Program& program) {
  struct Arguments {
    std::string shell;
    std::vector<std::string> typed;
  };
  const auto a = std::make_shared<Arguments>();
  Command command = program.command("completion", "A script with which bash, zsh or fish completes dvi's command line");
  command.positional("SHELL", a->shell, "bash, zsh, or fish; words: what may follow the words behind --, as the scripts ask");
  command.positional("WORD", a->typed, "Words of a command line, the last of which is being typed");
  command.examples({"source <(dvi completion bash)", "dvi completion fish > ~/.config/fish/completions/dvi.fish"});
  command.run([a, &program] {
    if (a->shell != "words") return fmt::print("{}", completion_script(a->shell));
    for (const Word& word : complete(program.words(), a->typed)) fmt::print("{}\t{}\n", word.text, word.summary);
  });
}

}  // namespace dvi::cli
