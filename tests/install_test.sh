#!/usr/bin/env bash
# install_test.sh SOURCE BUILD COMPILER SANITIZERS: installs the build into a temporary folder, builds the example with it, and runs both.
set -euo pipefail
source=$1 build=$2 compiler=$3 sanitizers=$4
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cmake --install "$build" --prefix "$work/prefix" >/dev/null
flags=${sanitizers:+-fsanitize=$sanitizers}
cmake -S "$source/examples" -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$work/prefix" \
  -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_CXX_FLAGS="$flags" >/dev/null
cmake --build "$work/build"

"$work/prefix/bin/dvi" synth -o "$work/drive" --frames 3 --width 160 --height 90 --beams 16 --columns 600 --quiet
"$work/build/fill_drive" "$work/drive" "$work/out" | tee "$work/brief"
grep -q "3 frames" "$work/brief"
test "$(find "$work/out/frames" -name '*.png' | wc -l)" = 3
echo "installed, built and run"
