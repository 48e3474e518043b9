#!/usr/bin/env python3
"""Holds the tree to American spelling.

    check_language.py [ROOT]    prints each breach as FILE:LINE: what was found and what to write; exit code 1 if there is any

Files of other programs, and words that other programs use as names, are left alone.
"""
import re
import subprocess
import sys
from pathlib import Path

# What to write instead, by the British form. Any part of a word counts: `edge_colour`, `kGreyLevels`.
SPELLINGS = {
    "colour": "color", "grey": "gray", "centre": "center", "metre": "meter", "neighbour": "neighbor", "behaviour": "behavior",
    "favour": "favor", "labelled": "labeled", "labelling": "labeling", "modelled": "modeled", "modelling": "modeling",
    "levelled": "leveled", "levelling": "leveling", "travelled": "traveled", "travelling": "traveling", "cancelled": "canceled",
    "cancelling": "canceling", "artefact": "artifact", "catalogue": "catalog", "licence": "license", "defence": "defense",
    "judgement": "judgment", "kerb": "curb", "tyre": "tire", "storey": "story", "lorry": "truck", "bonnet": "hood",
    "towards": "toward", "afterwards": "afterward", "whilst": "while", "aluminium": "aluminum",
    "harmonis": "harmoniz", "recognis": "recogniz", "synthesise": "synthesize", "synthesising": "synthesizing",
    "minimis": "minimiz", "maximis": "maximiz", "optimis": "optimiz", "normalis": "normaliz", "serialis": "serializ",
    "quantis": "quantiz", "initialis": "initializ", "visualis": "visualiz", "synchronis": "synchroniz", "vectoris": "vectoriz",
}  # fmt: skip
PATTERN = re.compile("|".join(sorted(SPELLINGS, key=len, reverse=True)), re.I)
EXCLUDED = ("tests/foreign/", "tests/layouts/bags/", "tests/fuzz/parsers/corpus/", "tools/check_language", "LICENSE")
# Lines that hold a name of someone else: (file, part of the line).
NAMES = [("src/dvi/drive/traffic_classes.cpp", '"lorry"'), ("src/dvi/job/", '"labelled"')]


def files_of(root):
    done = subprocess.run(["git", "ls-files"], cwd=root, capture_output=True, text=True)
    listed = done.stdout.splitlines() if done.returncode == 0 else [str(p.relative_to(root)) for p in root.rglob("*")]
    return [name for name in sorted(listed) if not name.startswith(EXCLUDED) and (root / name).is_file()]


def breaches(root):
    for name in files_of(root):
        for found in PATTERN.findall(name):
            yield f"{name}: the name has '{found}': write '{SPELLINGS[found.lower()]}'"
        try:
            text = (root / name).read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue  # a picture
        for number, line in enumerate(text.splitlines(), 1):
            if any(name.startswith(file) and part in line for file, part in NAMES):
                continue
            for found in PATTERN.findall(line):
                yield f"{name}:{number}: '{found}': write '{SPELLINGS[found.lower()]}'"


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent).resolve()
    found = list(breaches(root))
    print(*found, sep="\n", end="\n" if found else "")
    print(f"language: {len(found)} breaches" if found else "language: all spelling is American")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
