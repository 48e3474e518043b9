#!/usr/bin/env bash
# extras.sh PROGRAM FOLDER VERSION HELP2MAN: man pages and completions, made from the program's own help.
set -euo pipefail
program=$1 folder=$2 version=$3 help2man=$4
rm -rf "$folder"
mkdir -p "$folder"/man "$folder"/share/{bash-completion/completions,zsh/vendor-completions,fish/vendor_completions.d}
"$program" completion bash >"$folder/share/bash-completion/completions/dvi"
"$program" completion zsh >"$folder/share/zsh/vendor-completions/_dvi"
"$program" completion fish >"$folder/share/fish/vendor_completions.d/dvi.fish"

# The same pages on any day.
export SOURCE_DATE_EPOCH=0
page() {  # NAME SUMMARY WORDS: help2man calls WORDS --help; it takes the name of the page from WORDS, which are two for a command
  "$help2man" --no-info --version-string="$version" --manual="dvi" --name="$2" "$3" |
    sed -e "s/^\.TH [^\"]*\"1\"/.TH ${1^^} \"1\"/" -e "/^\.SH NAME/{n;s/^dvi[a-z -]* \\\\- /$1 \\\\- /}" |
    gzip -n9 >"$folder/man/$1.1.gz"
}
page dvi "remove traffic from recorded drives" "$program"
"$program" completion words -- '' |
  while IFS=$'\t' read -r command summary; do page "dvi-$command" "$summary" "$program $command"; done
touch "$folder/made"
