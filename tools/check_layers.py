#!/usr/bin/env python3
"""Holds the includes of src/dvi to the layer table of ARCHITECTURE.md.

    check_layers.py [ROOT]      prints each breach as FILE:LINE: what and why; exit code 1 if there is any
"""
import re
import sys
from pathlib import Path

# In the order they run.
STAGES = [
    "masks", "odometry", "registration", "traffic", "detect", "map", "exposure", "align", "depth", "plane_sweep", "sample", "regularize", "harmonize", "synthesize", "smooth"
]
NOUNS = ["core", "geometry", "image", "drive"]
SERVICES = ["io", "scan_match"]
MEASURES = ["metrics", "holdout", "baselines", "audit", "plausibility", "exports", "report"]

# What each module may include besides its own folder.
ALLOWED = {
    "core": [],
    "geometry": ["core"],
    "image": ["core"],
    "drive": ["core", "geometry", "image"],
    "io": NOUNS,
    "scan_match": NOUNS,
    **{stage: NOUNS + SERVICES for stage in STAGES},
    "synth": NOUNS + SERVICES + STAGES,
    **{measure: NOUNS + SERVICES + STAGES for measure in MEASURES},
    "pipeline": NOUNS + SERVICES + STAGES + ["synth"] + MEASURES,
    "cli": NOUNS + SERVICES + STAGES + ["synth"] + MEASURES + ["pipeline"],
    "dvi.h": NOUNS + MEASURES + ["pipeline"],  # the library in one header
}

# The data that stages hand on, and the one way to look at the static map: all that a stage may know of an earlier one.
TYPES = [
    "map/static_map.h",
    "map/ground.h",
    "map/road.h",
    "map/visible_points.h",
    "depth/depth_map.h",
    "depth/visibility_map.h",
    "sample/candidates.h",
    "regularize/labelling.h",
    "harmonize/filled_frame.h",
    "harmonize/surface_class.h",
]

# Seconds of compile time an include: these stay in .cpp files.
HEAVY = re.compile(
    r"CLI/|toml\+\+/|nlohmann/json\.hpp|pugixml\.hpp|boost/|lib(av|sw)\w+/"
    r"|opencv2/(?!core\.hpp|core/)|opencv2/opencv\.hpp|fmt/|tbb/parallel_|regex$|iostream$"
)
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^">]+)[">]')


def includes(file):
    for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
        if match := INCLUDE.match(line):
            yield number, match.group(1)


def layer_problem(module, target, is_test):
    """Why a file of `module` must not include dvi/`target`, or None."""
    other = target.split("/")[0]
    if other == module:
        return None
    if other not in ALLOWED:
        return f"there is no module '{other}'"
    if other in ALLOWED[module]:
        return None
    if module in STAGES and other in STAGES:
        if STAGES.index(other) > STAGES.index(module):
            return f"the stage {other} runs after {module}"
        if target not in TYPES:
            return f"of an earlier stage only its types may be included ({', '.join(TYPES)})"
        return None
    if module in [*STAGES, *MEASURES] and other == "synth" and is_test:
        return None
    return f"{module} may include {', '.join(ALLOWED[module]) or 'nothing of dvi'}"


def breaches(root):
    source = root / "src" / "dvi"
    for file in sorted([*source.rglob("*.h"), *source.rglob("*.cpp")]):
        is_test = file.stem.endswith("_test") or file.stem.startswith("test_")
        module = file.relative_to(source).parts[0]
        where = file.relative_to(root)
        if module not in ALLOWED:
            yield f"{where}:1: '{module}' has no place in the layer table"
            continue
        for number, name in includes(file):
            if name.startswith("dvi/"):
                if problem := layer_problem(module, name.removeprefix("dvi/"), is_test):
                    yield f"{where}:{number}: must not include \"{name}\": {problem}"
                elif not (root / "src" / name).exists():
                    yield f"{where}:{number}: \"{name}\" does not exist"
            elif file.suffix == ".h" and not is_test and HEAVY.match(name):
                yield f"{where}:{number}: <{name}> is heavy: include it in .cpp files only"


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent).resolve()
    found = list(breaches(root))
    print(*found, sep="\n", end="\n" if found else "")
    print(f"layers: {len(found)} breaches" if found else "layers: all includes point down")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
