#!/usr/bin/env python3
"""Holds the includes of src/dvi to the layer table of ARCHITECTURE.md.

    check_layers.py [ROOT]      prints each breach as FILE:LINE: what and why; exit code 1 if there is any

The table has a row per layer: number, modules, and the layers that they may include. "types" allows the headers that the text
below the table names.
"""
import re
import sys
from pathlib import Path

# Seconds of compile time an include: these stay in .cpp files.
HEAVY = re.compile(
    r"CLI/|toml\+\+/|nlohmann/json\.hpp|pugixml\.hpp|boost/|lib(av|sw)\w+/"
    r"|opencv2/(?!core\.hpp|core/)|opencv2/opencv\.hpp|fmt/|tbb/parallel_|regex$|iostream$"
)
HEAVY_HEADERS = ["core/json_optional.h"]  # for .cpp files only
TEST_ONLY = ["testing", "synth", "datasets"]  # what tests may include, too
SHARED_TYPE = "map/static_map.h"  # also of the stages before it
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^">]+)[">]')


def includes(file):
    for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
        if match := INCLUDE.match(line):
            yield number, match.group(1)


class Layers:
    """The layer table of ARCHITECTURE.md."""

    def __init__(self, text):
        section = text.split("## Layers\n", 1)[1].split("\n## ", 1)[0]
        self.layer, self.allowed, self.order = {}, {}, []
        for number, modules, allowed in re.findall(r"^\| (\d+) \| ([^|]+) \| ([^|]+) \|$", section, re.M):
            layers = set()
            for first, last in re.findall(r"(\d+)(?:-(\d+))?", allowed):
                layers |= set(range(int(first), int(last or first) + 1))
            for module in modules.split(", "):
                self.layer[module] = int(number)
                self.allowed[module] = (layers, "types" in allowed)
                self.order.append(module)
        self.types = re.findall(r"`(\w+/\w+\.h)`", section)

    def problem(self, module, target, is_test):
        """Why a file of `module` must not include dvi/`target`, or None."""
        other = target.split("/")[0]
        if other == module:
            return None
        if is_test and other in TEST_ONLY:
            return None
        if other not in self.layer:
            return f"there is no module '{other}'"
        layers, with_types = self.allowed[module]
        if self.layer[other] in layers:
            return None
        if with_types and self.layer[other] == self.layer[module]:
            if target not in self.types:
                return f"of another stage only its types may be included ({', '.join(self.types)})"
            if target != SHARED_TYPE and self.order.index(other) > self.order.index(module):
                return f"the stage {other} runs after {module}"
            return None
        return f"{module} may include layers {sorted(layers)}, and {other} is in layer {self.layer[other]}"


def links(file):
    """(line, module) of the modules that a CMakeLists.txt links to its library."""
    for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
        if line.startswith("dvi_module("):
            for module in re.findall(r"dvi::(\w+)", line):
                yield number, module


def breaches(root):
    source = root / "src" / "dvi"
    table = Layers((root / "ARCHITECTURE.md").read_text(encoding="utf-8"))
    for file in sorted([*source.rglob("*.h"), *source.rglob("*.cpp")]):
        is_test = file.stem.endswith(("_test", "_bench")) or file.stem.startswith("test_")
        module = file.relative_to(source).parts[0]
        where = file.relative_to(root)
        if module == "testing":
            continue
        if module not in table.layer:
            yield f"{where}:1: '{module}' has no place in the layer table"
            continue
        for number, name in includes(file):
            if name.startswith("dvi/"):
                if problem := table.problem(module, name.removeprefix("dvi/"), is_test):
                    yield f"{where}:{number}: must not include \"{name}\": {problem}"
                elif not (root / "src" / name).exists():
                    yield f"{where}:{number}: \"{name}\" does not exist"
            elif file.suffix == ".h" and not is_test and HEAVY.match(name) and str(file.relative_to(source)) not in HEAVY_HEADERS:
                yield f"{where}:{number}: <{name}> is heavy: include it in .cpp files only"
    for file in sorted(source.glob("*/CMakeLists.txt")):
        module = file.parent.name
        for number, other in links(file):
            if other == module or other not in table.layer or module not in table.layer:
                continue
            layers, with_types = table.allowed[module]
            if table.layer[other] not in layers and not (with_types and table.layer[other] == table.layer[module]):
                yield f"{file.relative_to(root)}:{number}: must not link dvi::{other}: it is in layer {table.layer[other]}"


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent).resolve()
    found = list(breaches(root))
    print(*found, sep="\n", end="\n" if found else "")
    print(f"layers: {len(found)} breaches" if found else "layers: all includes point down")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
