#!/usr/bin/env bash
# trial.sh program|python|library: uses the installed packages, as a user, in a system without the sources.
set -euo pipefail
cd

program() {
  dvi version
  dvi demo
  test -s dvi-demo/result/report.html
  local page
  for page in dvi dvi-run dvi-check dvi-demo; do gzip -t "/usr/share/man/man1/$page.1.gz"; done
  dpkg -S /usr/share/man/man1/dvi.1.gz /usr/share/bash-completion/completions/dvi
  test -s /usr/share/zsh/vendor-completions/_dvi
  test -s /usr/share/fish/vendor_completions.d/dvi.fish
  bash -c 'source /usr/share/bash-completion/completions/dvi; complete -p dvi'
}

python() {
  dvi synth -o street --frames 3 --width 160 --height 96 --beams 16 --columns 500 --quiet
  python3 - <<'END'
import dvi

frames = list(dvi.run("street"))
assert [frame.image.shape for frame in frames] == [(96, 160, 3)] * 3, frames
assert all((frame.kind > 0).any() for frame in frames), "no pixel was filled"
print(len(frames), "frames from Python")
END
}

library() {
  cmake -S examples -B example -DCMAKE_BUILD_TYPE=Release
  cmake --build example
  example/fill_drive street filled
  test "$(find filled/frames -name '*.png' | wc -l)" = 3
}

"$1"
