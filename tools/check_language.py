#!/usr/bin/env python3
"""Checks that the tree uses American spelling and the project's terms.

    check_language.py [ROOT]            prints each breach as FILE:LINE: the text found and the text to write; exit code 1 if any
    check_language.py --count [ROOT]    counts the phrases to avoid in all files, not only in PHRASE_FILES

Files of other programs, and words that other programs use as names, are left alone.
"""
import re
import subprocess
import sys
from collections import Counter
from dataclasses import dataclass
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
NAMES = [("src/dvi/drive/traffic_classes.cpp", '"lorry"'), ("docs/detector.md", "van, truck, lorry"), ("src/dvi/job/", '"labelled"')]

# The files whose phrases are checked. Spelling is checked everywhere.
PHRASE_FILES = re.compile(r"[A-Z]+\.(?:md|cff)|docs/.*\.md|(?:\.ci|bench|cmake|deploy|examples|python|src|tests|tools)/.*|"
                          r"CMakeLists\.txt|dev|setup\.py")


@dataclass(frozen=True)
class Phrase:
    """Text to avoid, as a regular expression in which a blank also matches a line break, and the text to write instead."""
    pattern: str
    write: str
    allowed: tuple[tuple[str, str], ...] = ()  # (start of the file's name, part of the line)


def _names(word, *files):
    """Allows a word in files in which it is a name: of a variable, type, function, key, command, or file."""
    return tuple((file, word) for file in files)


_EACH = "frame|point|pixel|second|image|scan|hole|channel|drive|minute|hour|camera|step|voxel|return|line|stage|thread|process"
PHRASES = (
    # Grammar.
    Phrase(r"(?<!\bthere) (?:is|are|was|were) no (?!longer\b|more\b|less\b|fewer\b|other\b|better\b|worse\b)", "is not a"),
    Phrase(r"\b(?:tells?|told|telling)\b", "show, report, state, determine, distinguish", _names("told", "src/dvi/media/video_reader.cpp")),
    Phrase(r"\bround (?:the|an?|each|it|its|them|their|this|that|these|those|all|both|every|holes?)\b", "around",
           (("docs/metrics.md", "of the scene round the holes"),)),  # quoted output
    Phrase(r"(?<!same\s)(?<!this\s)(?<!that\s)(?<!other\s)(?<!either\s)(?<!any\s)(?<!no\s)(?<!a\s)(?<!each\s)(?<!which\s)\bway\b", "path length, distance",
           _names("way", "src/dvi/geometry/earth_place_test.cpp")),
    Phrase(r"\b(?:stands?|(?<!free-)standing|stood)\b", "is static, is stationary, is",
           (*_names("stand(", "src/dvi/synth/static_world.cpp"), *_names("standing", "src/dvi/report/page/overview.js"),
            *_names('"stand"', "src/dvi/holdout/holdout_files.cpp", "tests/holdout_test.cpp"), ("src/dvi/synth/room.cpp", "The stand is"))),  # a coat stand
    Phrase(r"\b(?:nobody|somebody)\b", "no source, the user"),
    Phrase(rf"(?:\b\d(?:[\d.,]*\d)?|\b(?:bytes?|[KMG]i?B|ms|px|dB|m|s|seconds?|CPU|gain|times?|pixels?|lines?|million)) an? (?:{_EACH})\b",
           "per"),
    Phrase(r"\bwhat (?:goes|stays|moves?|stands|lies|shows|hides|changes|remains|follows|comes|takes|has|was|no|others?|the|an?|it|"
           r"they|that|is (?!missing|wrong|new|right|expected))\b", "a noun instead of a clause with 'what'",
           (("docs/faq.md", "we cannot"),)),
    Phrase(r"(?://|#) of ", "a comment that begins with its noun"),
    # Terms.
    Phrase(r"\breceipts?\b", "provenance",
           (("docs/report.md", "dvi-receipt/1"), *_names("receipt", "src/dvi/audit/audit.h", "tests/audit_test.cpp"),
            *_names("eceipt", "src/dvi/report/", "tests/report/"))),  # a schema, a key, and names of the page
    Phrase(r"\b(?:lend(?:s|ing|ers?)?|lent)\b", "is used as a source; source frame, source camera"),
    Phrase(r"\b(?:saw|sees|seen(?! from))\b", "observed",
           (*_names("seen", "src/dvi/align/pair_store_test.cpp", "src/dvi/diagnostics/camera_fit.cpp", "src/dvi/exports/export_colmap.cpp",
                    "src/dvi/exports/export_ortho.cpp", "src/dvi/labels/image_labels.cpp", "src/dvi/map/carve",
                    "src/dvi/media/video_reader.cpp", "src/dvi/odometry/direct_alignment.cpp", "src/dvi/odometry/rgbd_image.cpp",
                    "src/dvi/registration/ray_votes.cpp", "src/dvi/report/page/overview.js", "src/dvi/synth/"),
            *_names("Seen", "src/dvi/drive/free_space", "src/dvi/map/carve", "src/dvi/objects/", "src/dvi/registration/ray_votes.cpp",
                    "src/dvi/synth/"), ("src/dvi/exports/export_ortho.cpp", "where the camera saw it itself"))),  # a description in files
    Phrase(r"\bnever[- ]seen\b", "unobserved"),
    Phrase(r"(?<!dvi\s)(?<!--)\bforecasts?\b", "coverage",
           _names("forecast", "src/dvi/cli/", "src/dvi/commands/estimate_coverage", "tests/")),
    Phrase(r"\bcarried (?:over|masks?)\b|\bcarr(?:y|ies|ied) \w+ masks?\b", "reprojected"),
    Phrase(r"\b(?:laid|lays|laying) (?:\w+ ){0,3}?(?:on|onto|over)\b", "align, overlay"),
    Phrase(r"\b(?:bent|suited)\b", "deform, adapt", (("src/dvi/synth/walker.cpp", "knee is bent"),)),
    Phrase(r"\brims?\b", "boundary"),
    Phrase(r"\btrusts?\b", "score, weight"),
    Phrase(r"\bmisplaced\b", "position error", (("docs/metrics.md", ""), ("docs/benchmarks.md", ""), ("bench/page.py", ""))),  # a figure
    Phrase(r"(?:\b(?:the|its|their)|'s) reach\b|\breach_frames\b", "range, max_frame_gap"),
    Phrase(r"\bof (?:itself|themselves)\b", "moves, is moving"),
    Phrase(r"\btraffic that goes\b", "removed objects"),
    Phrase(r"\bothers see\b", "that sources observe"),
    Phrase(r"\bwas not taken after\b", "is not increasing"),
    Phrase(r"\bgrain\b", "noise texture"),
    Phrase(r"\bday[- ]?light\b|\banother (?:sun|light)\b|\blight of (?:another|the other) day\b", "illumination change"),
    Phrase(r"\b(?:rivals?|single things?|things agree)\b", "second-best candidate, landmark, inliers"),
    Phrase(r"\bfound masks\b|(?<!--)\bmasks (?:that (?:are|were) )?found\b", "motion segmentation"),
    Phrase(r"\bwitness(?:es)?\b", "visibility vote"),
    Phrase(r"\b(?:doubts?|in doubt)\b", "diagnostics, uncertain"),
    Phrase(r"\bkept stages?\b", "stage cache"),
    Phrase(r"\b(?:is|was|are|were) cut\b", "truncated"),
    Phrase(r"\b(?:is|are|of) (?:of )?(?:an)?other size\b", "differs in size"),
    Phrase(r"(?<!plane\s)(?<!plane_)(?<!plane-)\bsweeps?\b(?!/)", "scan, plane sweep",
           (("src/dvi/image/poisson", ""), ("src/dvi/regularize/", ""),  # of iterative solvers
            *_names("sweep", "python/examples/argoverse2.py", "src/dvi/datasets/read_nuscenes.cpp", "tests/layouts/layouts.py"),
            ("docs/algorithms/plane_sweep.md", "A Space-Sweep Approach"))),
    Phrase(r"\bsee_through\b", "occlusion_tolerance"),
)  # fmt: skip


def files_of(root):
    done = subprocess.run(["git", "ls-files"], cwd=root, capture_output=True, text=True)
    listed = done.stdout.splitlines() if done.returncode == 0 else [str(p.relative_to(root)) for p in root.rglob("*")]
    return [name for name in sorted(listed) if not name.startswith(EXCLUDED) and (root / name).is_file()]


def text_of(path):
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return ""  # a picture
    # The pictures in a notebook are encoded as letters.
    return re.sub(r'"image/\w+": "[^"]*"', "", text) if path.suffix == ".ipynb" else text


def prose(name, text):
    """The text with blanks for line breaks, for marks of comment lines after the first, and for code spans; as long as before."""
    lines = text.split("\n")
    marks = [re.match(r"[ \t]*(?://+|#+)", line) for line in lines]
    text = "\n".join(" " * mark.end() + line[mark.end():] if mark and before else line
                     for line, mark, before in zip(lines, marks, [None, *marks]))
    if name.endswith(".md"):
        text = re.sub(r"(?<!`)`[^`\n]+`(?!`)|\]\([^)\s]*\)", lambda m: "`" * len(m[0]), text)
    return text.replace("\n", " ")


def phrases(name, text):
    """(line, phrase, text found) of all phrases to avoid."""
    lines, plain = text.splitlines(), prose(name, text)
    for phrase in PHRASES:
        for found in re.finditer(phrase.pattern.replace(" ", " +"), plain, re.I):
            number = text.count("\n", 0, found.start() + len(found[0]) - len(found[0].lstrip())) + 1
            if not any(name.startswith(file) and part in lines[number - 1] for file, part in phrase.allowed):
                yield number, phrase, " ".join(found[0].split())


def spellings(name, text):
    for number, line in enumerate(text.splitlines(), 1):
        if not any(name.startswith(file) and part in line for file, part in NAMES):
            yield from ((number, found) for found in PATTERN.findall(line))


def breaches(root):
    for name in files_of(root):
        for found in PATTERN.findall(name):
            yield f"{name}: the name has '{found}': write '{SPELLINGS[found.lower()]}'"
        text = text_of(root / name)
        for number, found in spellings(name, text):
            yield f"{name}:{number}: '{found}': write '{SPELLINGS[found.lower()]}'"
        if PHRASE_FILES.fullmatch(name):
            for number, phrase, found in phrases(name, text):
                yield f"{name}:{number}: '{found}': write: {phrase.write}"


def count(root):
    """Prints the number of each phrase, in all and per top folder."""
    found = {phrase: Counter() for phrase in PHRASES}
    for name in files_of(root):
        for _, phrase, _ in phrases(name, text_of(root / name)):
            found[phrase][name.split("/")[0]] += 1
    for phrase, hits in found.items():
        print(f"{hits.total():5}  {phrase.write:52}  {', '.join(f'{folder} {n}' for folder, n in hits.most_common())}")


def main():
    arguments = [a for a in sys.argv[1:] if a != "--count"]
    root = Path(arguments[0] if arguments else Path(__file__).parent.parent).resolve()
    if "--count" in sys.argv:
        count(root)
        return 0
    found = list(breaches(root))
    print(*found, sep="\n", end="\n" if found else "")
    print(f"language: {len(found)} breaches" if found else "language: spelling and terms are as they should be")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
