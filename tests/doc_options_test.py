#!/usr/bin/env python3
"""Checks that the options, commands, and source files named in the documents and on the report page exist.

    doc_options_test.py ROOT PROGRAM            prints each that does not exist, and whether the table of options in
                                                docs/reference.md is not current; exit code 1 if there is any
    doc_options_test.py ROOT PROGRAM --write    writes the table: ./dev docs
"""
import re
import subprocess
import sys
from pathlib import Path

# CHANGELOG.md and docs/experiments are left out, because they contain names of earlier options.
PAST = ("CHANGELOG.md", "docs/experiments/")
OTHERS = {"--imgsz"}  # options of other programs that pages explain
# `map.ply` is a file, not an option of the section [map].
ENDINGS = ("md", "ply", "pcd", "las", "json", "csv", "mp4", "mkv", "txt", "png", "jpg", "h", "cpp", "js", "toml", "bin", "tif", "sparse")
OPTION = r"(?<![\w-])--[a-z][a-z-]+(?!\w)"


def options(program):
    """Returns the names of all options, as `section.key`."""
    names, section = set(), ""
    for line in subprocess.check_output([program, "config", "dump", "--all"], text=True).splitlines():
        if found := re.match(r"\[(\w+)\]", line):
            section = found[1]
        elif found := re.match(r"(\w+) =", line):
            names.add(f"{section}.{found[1]}")
    return names


def commands(program):
    """The options of each command line, by its command."""
    def complete(*typed):
        lines = subprocess.check_output([program, "completion", "words", "--", *typed], text=True).splitlines()
        return [line.split("\t")[0] for line in lines]
    typed = [[command] for command in complete("")]
    typed += [[command, inner] for command, in typed for inner in complete(command, "")]
    return {" ".join(command): set(complete(*command, "--")) for command in typed}


def with_table(page, program):
    """The page with the current table of options."""
    table = subprocess.check_output([program, "config", "dump", "--markdown"], text=True)
    return re.sub(r"(<!-- options: [^\n]*\n).*(?=<!-- end of options)", lambda found: found[1] + table, page, flags=re.S)


def code_of(page, text):
    """Returns the parts of a page that may be command lines: code spans, lines of code blocks and comments, strings of scripts."""
    if page.suffix != ".md":
        return [piece for piece in re.findall(r'"((?:[^"\\\n]|\\.)* (?:[^"\\\n]|\\.)*)"', text)]
    blocks = re.findall(r"^```.*?^```|<!--.*?-->|^    .*?$", text, re.M | re.S)
    spans = re.findall(r"`([^`]+)`", re.sub(r"^```.*?^```", "", text, flags=re.M | re.S))
    lines = [line.split("#")[0] for block in blocks for line in re.split(r"(?<!\\)\n|;|`|&&", block)]
    return lines + [span.replace("\n", " ") for span in spans]


def sentence(command):
    """Whether "dvi WORD" is a part of a sentence, as in "so that dvi takes it"."""
    return not re.match(r" *(?:\[|-|[A-Z]|$|[.,:)|])", command)


def missing(page, text, known, known_commands, others):
    sections = {name.split(".")[0] for name in known}
    every = set().union(others, *known_commands.values())
    code = code_of(page, text)
    for section, key in re.findall(r"(?<![\w/.-])([a-z]\w*)\.([a-z]\w*)(?![\w(])", text if page.suffix == ".md" else "\n".join(code)):
        if section in sections and key not in ENDINGS and f"{section}.{key}" not in known:
            yield f"there is no option {section}.{key}"
    for piece in code:
        for name, rest in re.findall(r"(?<![\w/.-])dvi ([a-z]+(?:-[a-z]+)*(?: dump)?)([^|]*)", piece):
            if name not in known_commands:
                if not sentence(rest):
                    yield f"there is no command dvi {name}"
            else:
                yield from (f"dvi {name} has no option {option}" for option in re.findall(OPTION, rest) if option not in known_commands[name])
        if piece.startswith("--") or page.suffix != ".md":
            yield from (f"there is no option {option}" for option in re.findall(OPTION, piece) if option not in every)


def missing_files(text, sources):
    for name in re.findall(r"`((?:\w+/)*\w+\.(?:h|cpp))`", text):
        if not any(str(path).endswith("/" + name) for path in sources):
            yield f"there is no file {name}"


def main():
    root, program = Path(sys.argv[1]).resolve(), sys.argv[2]
    sources = [*root.glob("src/**/*.h"), *root.glob("src/**/*.cpp")]
    reference = root / "docs/reference.md"
    current = with_table(reference.read_text(encoding="utf-8"), program)
    if "--write" in sys.argv:
        reference.write_text(current, encoding="utf-8")
    known, known_commands = options(program), commands(program)
    of_dev = {option for file in (root / "dev", *root.glob("bench/*.py")) for option in re.findall(OPTION, file.read_text(encoding="utf-8"))}
    pages = [*root.glob("*.md"), *root.glob("docs/**/*.md"), *root.glob("src/dvi/report/page/*.js"), *root.glob("src/dvi/report/page/*.html")]
    pages = [page for page in sorted(pages) if not str(page.relative_to(root)).startswith(PAST)]
    assert known and "run" in known_commands and len(pages) > 30, f"{len(known)} options, {len(known_commands)} commands, {len(pages)} pages"
    found = [f"{page.relative_to(root)}: {error}" for page in pages
             for error in dict.fromkeys(missing(page, page.read_text(encoding="utf-8"), known, known_commands, OTHERS | of_dev))]
    if current != reference.read_text(encoding="utf-8"):
        found.append("docs/reference.md: the table of options is not current: ./dev docs")
    found += [f"{page.relative_to(root)}: {error}" for page in sorted(root.glob("docs/algorithms/*.md"))
              for error in missing_files(page.read_text(encoding="utf-8"), sources)]
    print(*found, sep="\n", end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
