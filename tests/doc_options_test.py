#!/usr/bin/env python3
"""Options and commands that the docs and the report name must exist, and the table of options in reference.md must be current.

    doc_options_test.py DOCS PROGRAM             exit code 1 with each that does not exist, or if the table is not current
    doc_options_test.py DOCS PROGRAM --write     writes the table: ./dev docs
"""
import re
import subprocess
import sys
from pathlib import Path

FILE_ENDINGS = ("md", "ply", "pcd", "json", "las", "mp4", "txt", "png", "cpp")


def options(program):
    names, section = set(), ""
    for line in subprocess.check_output([program, "config", "dump", "--all"], text=True).splitlines():
        if found := re.match(r"\[(\w+)\]", line):
            section = found[1]
        elif found := re.match(r"(\w+) =", line):
            names.add(f"{section}.{found[1]}")
    return names


def words(program):
    """What the program completes: its commands, and the options of each."""
    def complete(*typed):
        lines = subprocess.check_output([program, "completion", "words", "--", *typed], text=True).splitlines()
        return [line.split("\t")[0] for line in lines]
    commands = complete("")
    typed = [[command] for command in commands] + [[command, inner] for command in commands for inner in complete(command, "")]
    return set(commands), {option for command in typed for option in complete(*command, "--")}


def with_table(page, program):
    """The page with the current table of options."""
    table = subprocess.check_output([program, "config", "dump", "--markdown"], text=True)
    return re.sub(r"(<!-- options: [^\n]*\n).*(?=<!-- end of options)", lambda found: found[1] + table, page, flags=re.S)


def main():
    docs, program = Path(sys.argv[1]), sys.argv[2]
    reference = docs / "reference.md"
    current = with_table(reference.read_text(), program)
    if "--write" in sys.argv:
        reference.write_text(current)
    known = options(program)
    sections = {name.split(".")[0] for name in known}
    commands, flags = words(program)
    missing = [] if current == reference.read_text() else ["reference.md: the table of options is not current: ./dev docs"]
    root = docs.parent
    texts = [root / name for name in ("README.md", "SECURITY.md", "ARCHITECTURE.md", "src/dvi/report/page/texts.js")]
    for page in [*sorted(docs.rglob("*.md")), *texts]:
        text = page.read_text()
        for section, key in re.findall(r"[`\"](?:--set )?(\w+)\.(\w+)", text):
            if section in sections and key not in FILE_ENDINGS and f"{section}.{key}" not in known:
                missing.append(f"{page.name}: there is no option {section}.{key}")
        for command in re.findall(r"`dvi ([a-z]+)", text):
            if command not in commands:
                missing.append(f"{page.name}: there is no command dvi {command}")
        typed = [text] if page.suffix == ".js" else re.findall(r"`(?:dvi |--)[^`\n]+`|^dvi .*$", text, re.M)
        for option in re.findall(r"(?<![^\s`(\"])--[a-z][a-z-]+", "\n".join(typed)):
            if option not in flags | {"--imgsz"}:  # of a program that exports networks
                missing.append(f"{page.name}: there is no option {option}")
    print(*missing, sep="\n", end="\n" if missing else "")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
