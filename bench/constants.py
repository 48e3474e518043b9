"""The constants of the program's algorithms: lists them, and builds the program with one of them changed.

A constant is a field of a struct of parameters, such as `struct ShadowParams { int blur_px = 3; };`, or a constexpr number.
Its name is `ShadowParams.blur_px` or `kMarginPx`, with `module::` before it where that is ambiguous.
"""
import difflib
import os
import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

# Cases are made and scored by the unchanged program: the constants of other modules have no effect on the figures.
MODULES = ("align", "depth", "diagnostics", "drive", "exposure", "ground", "harmonize", "map", "objects", "odometry",
           "registration", "regularize", "sample", "scan_match", "smooth", "synthesize")
STRUCT = re.compile(r"^struct (\w+Params) \{\n(.*?)^\};", re.DOTALL | re.MULTILINE)
FIELD = re.compile(r"^  [\w:<>, ]+? (?P<name>\w+)(?: = (?P<value>[^;]+)|(?P<list>\{[^;]+\}));(?P<comment>.*)$", re.MULTILINE)
LOOSE = re.compile(r"^ *(?:inline |static )*constexpr [^;\"]*?;(?P<comment>.*)$", re.MULTILINE)
# Only literals. A constant that is computed from another one changes with it.
DECLARATOR = re.compile(r"\b(?P<name>k[A-Z]\w*)(?:\[\])?(?: = (?P<value>(?![^,;]*\bk[A-Z])[-+*/\w.' ]+)"
                        r"|(?: = )?(?P<list>\{[-+*/\w.', ]+\}))(?=[,;])")


class Unknown(ValueError):
    """A constant that does not exist or cannot be changed."""


class NotBuilt(Exception):
    """A changed program does not compile: the compiler's message."""


@dataclass(frozen=True)
class Constant:
    module: str
    name: str  # STRUCT.FIELD or kName
    value: str
    comment: str
    file: Path  # relative to the tree
    line: int
    span: tuple[int, int]  # first and last character of the value in the file

    @property
    def label(self) -> str:
        return f"{self.module}::{self.name}"


@dataclass(frozen=True)
class Change:
    constant: Constant
    value: str

    @property
    def label(self) -> str:
        return f"{self.constant.label}={self.value}"

    def apply(self, text: str) -> str:
        """The text of the constant's file with the new value."""
        begin, end = self.constant.span
        return text[:begin] + self.value + text[end:]


def parse_file(file: Path, text: str) -> list[Constant]:
    """The constants of a file, given relative to the tree."""
    module, found = file.parts[2], []  # src/dvi/MODULE/...

    def add(prefix: str, match: re.Match, offset: int, comment: str) -> None:
        part = "value" if match["value"] else "list"
        begin, end = (offset + position for position in match.span(part))
        line = text.count("\n", 0, begin) + 1
        found.append(Constant(module, prefix + match["name"], match[part], comment.strip(" /<"), file, line, (begin, end)))

    for struct in STRUCT.finditer(text):
        for field in FIELD.finditer(struct[2]):
            add(f"{struct[1]}.", field, struct.start(2), field["comment"])
    for statement in LOOSE.finditer(text):
        for declarator in DECLARATOR.finditer(statement[0]):
            add("", declarator, statement.start(), statement["comment"])
    return found


def find(tree: Path) -> list[Constant]:
    """All constants of the algorithms of a tree, by module and name."""
    files = [file.relative_to(tree) for module in MODULES for kind in ("h", "cpp")
             for file in (tree / "src/dvi" / module).rglob(f"*.{kind}")
             if not file.stem.endswith(("_test", "_bench")) and not file.stem.startswith("test_")]
    found = [constant for file in files for constant in parse_file(file, (tree / file).read_text())]
    return sorted(found, key=lambda constant: (constant.label, constant.file, constant.line))


def parse_change(text: str, constants: list[Constant]) -> Change:
    """[MODULE::]NAME=VALUE. Unknown if this is not exactly one constant, or not a change."""
    name, equals, value = text.partition("=")
    value = value.replace(" ", "")
    if not (name and equals and value) or set(value) & set(";/|\n"):
        raise Unknown(f"--constant {text}: expected [MODULE::]NAME=VALUE, and no ';', '/', or '|' in the value")
    fitting = [constant for constant in constants if name in (constant.name, constant.label)]
    if not fitting:
        labels = {constant.label if "::" in name else constant.name: constant.label for constant in constants}
        near = ", ".join(labels[match] for match in difflib.get_close_matches(name, labels, 3, 0.5)) or "see --list-constants"
        raise Unknown(f"--constant {text}: there is no constant '{name}'; closest: {near}")
    if len(fitting) > 1:
        places = ", ".join(f"{constant.label} ({constant.file}:{constant.line})" for constant in fitting)
        raise Unknown(f"--constant {text}: '{name}' is ambiguous: {places}")
    if value == fitting[0].value.replace(" ", ""):
        raise Unknown(f"--constant {text}: this is the present value")
    return Change(fitting[0], value)


def copy_tree(tree: Path, to: Path, change: Change) -> None:
    """Copies a tree with a change. Files that are equal already keep their times, so that few objects are compiled again."""
    kept = set()
    for top in tree.iterdir():
        if top.name == "build" or top.name.startswith("."):
            continue
        for file in [top] if top.is_file() else top.rglob("*"):
            if not file.is_file() or "__pycache__" in file.parts:
                continue
            target, content = to / (relative := file.relative_to(tree)), file.read_bytes()
            kept.add(target)
            if relative == change.constant.file:
                content = change.apply(content.decode()).encode()
            if not target.is_file() or target.read_bytes() != content:
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_bytes(content)
    for old in to.rglob("*"):
        if old.is_file() and old not in kept and to / "build" not in old.parents:
            old.unlink()


def build(tree: Path, work: Path, change: Change) -> Path:
    """The program with a change. All changes are built in one folder below `work`, one after the other."""
    copy = work / "tree"
    copy_tree(tree, copy, change)
    environment = os.environ | {"CCACHE_BASEDIR": str(tree), "CCACHE_NOHASHDIR": "1"}
    for command in (["cmake", "--preset", "release", "-DDVI_PYTHON=OFF"],
                    ["cmake", "--build", "build/release", "--target", "dvi"]):
        done = subprocess.run(command, cwd=copy, env=environment, capture_output=True, text=True)
        if done.returncode:
            errors = [line for line in (done.stdout + done.stderr).splitlines() if "error" in line]
            raise NotBuilt(f"--constant {change.label} does not compile: {errors[0] if errors else done.stdout[-500:]}")
    program = work / "programs" / change.label / "dvi"
    program.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy2(copy / "build/release/bin/dvi", program)
    return program
