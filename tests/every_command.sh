#!/usr/bin/env bash
# every_command.sh PROGRAM [--once]: runs every command and method on drives of some hundred pixels, for the sanitizers. Each must
# succeed. --once: only one run of two drives, with threads. Writes to a folder in $TMPDIR.
set -euo pipefail
program=$(realpath "$1") only=${2:-}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

dvi() {
  local code=0
  "$program" "$@" --quiet >stdout 2>stderr || code=$?
  ((code == 0)) && return
  printf 'exit %d: dvi %s\n' "$code" "$*"
  cat stdout stderr
  exit 1
}
street() { dvi synth --frames 6 --width 160 --height 96 --beams 24 --columns 500 --truck "$@"; }

street -o one
street -o two --day 2
dvi run one two -o both --threads 4 --set stages.regularize=true
[[ $only != --once ]] || exit 0

dvi synth -o room --room --frames 6 --width 160 --height 120
dvi run room -o tidy
street -o rig --side-cameras --walker --wet --changes --reverse
dvi run rig -o filled
dvi audit filled rig
dvi run one -o own --poses loam --remove all
rm own/frames/000003.png
dvi run one -o own --poses loam --remove all   # resumes
for method in paper flow telea ns; do dvi run one -o "$method" --method "$method"; done
dvi run one -o labels --masks labels --remove moving --set align.method=paper
dvi check one --coverage --json -o pictures
dvi plan one two -o pieces
dvi fill pieces --frames 0:1
dvi fill pieces
dvi finish pieces
for section in 1/2 2/2; do dvi plan one two -o sections --section $section; done
dvi join sections
dvi fill sections
dvi finish sections
dvi audit sections one two
dvi convert rig -o converted
mkdir mine && cp -r one/images one/lidar mine && "$program" init mine >stdout
dvi forecast one two -o forecast
dvi map one -o map --poses loam --trajectory kitti
dvi run one -o filed --poses map/poses.txt
dvi audit own one
dvi audit both one two
for format in colmap nerfstudio ply las mcap video holes labels folder; do dvi export $format both -o "export-$format"; done
dvi run export-folder -o again
dvi eval own --truth one/truth --external other=flow/frames --json
dvi eval own --labels one/boxes.json
dvi eval own --points one/truth_points
dvi import-fill own flow/frames
dvi audit own one
dvi import-fill own --undo
dvi report own --truth one/truth
dvi inspect own 0 20 20 --json -o crops
dvi holdout one -o case
dvi holdout one -o missed --mask-errors miss
dvi selfcheck one -o selfcheck --scenario parked
dvi demo two -o demo
echo "every command succeeded"
