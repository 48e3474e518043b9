#!/usr/bin/env python3
"""Holds src/dvi to one meaning per name, which compilers do not check across files (the one definition rule).

    check_names.py [ROOT]       prints each breach as FILE:LINE: what and why; exit code 1 if there is any

The declarations of a module lie in its own namespace, dvi::MODULE, or in dvi itself if all modules use it. A type outside anonymous
namespaces has a name that no other type has, whatever its namespace, and is defined in one file only. No two headers have one name.
"""
import re
import sys
from collections import defaultdict
from pathlib import Path

SHARED = ["core", "geometry", "image", "drive", "testing"]  # all modules use their names, which are in dvi itself

NOT_CODE = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])\'(?:\\.|[^\'\\\n])+\'|^[ \t]*#[^\n]*', re.S | re.M
)
NAMESPACE = re.compile(r"\b(?:inline\s+)?namespace\s*([\w:]*)\s*$")
TYPE = re.compile(r"(?:^|>)\s*(?:struct|class|union|enum(?:\s+(?:class|struct))?)\s+(\w+)(?:\s+final)?\s*(?::[^:].*)?$", re.S)


def code_of(text):
    """Comments, strings and directives as blanks: offsets stay."""
    return NOT_CODE.sub(lambda m: re.sub(r"[^\n]", " ", m[0]), text)


def definitions(text):
    """(offset, namespace, type) of the definitions at namespace scope; type is None where a namespace begins."""
    code = code_of(text)
    scopes, begun = [], 0  # a scope: the name of a namespace, or None for any other block
    for at, c in enumerate(code):
        if c == "{":
            head = code[begun:at]
            if match := NAMESPACE.search(head):
                scopes.append(match[1] or "(anonymous)")
                yield at, "::".join(scopes), None
            else:
                if None not in scopes and (match := TYPE.search(head)):
                    yield at, "::".join(scopes), match[1]
                scopes.append(None)
            begun = at + 1
        elif c == "}":
            if scopes:
                scopes.pop()
            begun = at + 1
        elif c == ";":
            begun = at + 1


def breaches(root):
    source = root / "src" / "dvi"
    defined, headers = defaultdict(list), defaultdict(list)
    for file in sorted([*source.rglob("*.h"), *source.rglob("*.cpp")]):
        module = file.relative_to(source).parts[0]
        home = "dvi" if module in SHARED else f"dvi::{module}"
        text = file.read_text(encoding="utf-8")
        for offset, namespace, name in definitions(text):
            where = f"{file.relative_to(root)}:{text.count(chr(10), 0, offset) + 1}"
            if name is None:
                ours = namespace.split("::(anonymous)")[0]
                inside = module not in SHARED and ours.startswith(home + "::")
                if ours.split("::")[0] == "dvi" and ours != home and not inside:
                    yield f"{where}: namespace {ours}: what {module}/ declares lies in {home}"
            elif "(anonymous)" not in namespace and namespace.split("::")[0] == "dvi":
                defined[name].append(where)
        if file.suffix == ".h":
            headers[file.name].append(str(file.relative_to(root)))
    for name, places in sorted(defined.items()):
        for again in places[1:]:
            yield f"{again}: {name} is defined a second time (the first: {places[0]}): use another name, or an anonymous namespace"
    for name, places in sorted(headers.items()):
        for again in places[1:]:
            yield f"{again}:1: {places[0]} has the same name"


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent).resolve()
    found = list(breaches(root))
    print(*found, sep="\n", end="\n" if found else "")
    print(f"names: {len(found)} breaches" if found else "names: each has one meaning")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
