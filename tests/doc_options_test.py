#!/usr/bin/env python3
"""Options, commands, and source files that the docs name must exist.

    doc_options_test.py DOCS PROGRAM      exit code 1 with each that does not
"""
import re
import subprocess
import sys
from pathlib import Path


def options(program):
    names, section = set(), ""
    for line in subprocess.check_output([program, "config", "dump", "--all"], text=True).splitlines():
        if found := re.match(r"\[(\w+)\]", line):
            section = found[1]
        elif found := re.match(r"(\w+) =", line):
            names.add(f"{section}.{found[1]}")
    return names


def main():
    docs, program = Path(sys.argv[1]).resolve(), sys.argv[2]
    known = options(program)
    sections = {name.split(".")[0] for name in known}
    words = subprocess.check_output([program, "completion", "bash"], text=True)
    sources = [*(docs.parent / "src").rglob("*.h"), *(docs.parent / "src").rglob("*.cpp")]
    missing = []
    pages = [docs / name for name in ("tutorial.md", "troubleshooting.md", "faq.md", "exports.md", "which_format.md", "python.md")]
    pages += [*sorted(docs.glob("algorithms/*.md")), *sorted(docs.glob("experiments/*.md"))]
    for page in pages:
        text = page.read_text()
        for section, key in re.findall(r"[`\"](?:--set )?(\w+)\.(\w+)", text):
            if section in sections and key not in ("md", "ply", "json", "las", "mp4", "txt") and f"{section}.{key}" not in known:
                missing.append(f"{page.name}: there is no option {section}.{key}")
        for command in re.findall(r"`dvi ([a-z]+)", text):
            if f"'{command}')" not in words:
                missing.append(f"{page.name}: there is no command dvi {command}")
        for option in re.findall(r"`[^`|\n]*?(--[a-z][a-z-]+)", text):
            if option not in words and "colmap" not in text[max(0, text.find(option) - 300):text.find(option)]:
                missing.append(f"{page.name}: there is no option {option}")
        for name in re.findall(r"`((?:[\w]+/)*\w+\.(?:h|cpp))`", text):
            if not any(str(path).endswith("/" + name) for path in sources):
                missing.append(f"{page.name}: there is no file {name}")
    print(*missing, sep="\n", end="\n" if missing else "")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
