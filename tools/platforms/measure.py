"""Figures from the logs of the steps, and the table of all systems."""
import re
from dataclasses import dataclass, field

# Warnings of the compiler, in any file that our code includes, and those of CMake.
WARNING = re.compile(r"^(?:\S+:\d+(?::\d+)?: warning: .*|CMake (?:Deprecation )?Warning.*)$", re.M)
SUMMARY = re.compile(r"(\d+) tests? failed out of (\d+)")
SKIPPED = re.compile(r"^\s*\d+ - .* \(Skipped\)\s*$", re.M)
LINTIAN = re.compile(r"^([EW]): .*$", re.M)


@dataclass
class Result:
    """The column of one system: figures by row, reasons why it failed, or the reason why it was not tested."""
    system: str
    figures: dict[str, str] = field(default_factory=dict)
    failures: list[str] = field(default_factory=list)
    untested: str = ""

    def outcome(self):
        return "untested" if self.untested else "failed" if self.failures else "passed"


def warnings_in(text):
    """The distinct warnings."""
    return list(dict.fromkeys(match[0] for match in WARNING.finditer(text)))


def tests_in(text):
    """(passed, failed, skipped) as ctest summarizes them, or None without a summary."""
    summary = SUMMARY.search(text)
    if not summary:
        return None
    failed, total, skipped = int(summary[1]), int(summary[2]), len(SKIPPED.findall(text))
    return total - failed - skipped, failed, skipped


def lintian_in(text):
    """The lines of errors, and those of warnings."""
    lines = {kind: [match[0] for match in LINTIAN.finditer(text) if match[1] == kind] for kind in "EW"}
    return lines["E"], lines["W"]


def table(results):
    """Markdown, one column per system."""
    rows = list(dict.fromkeys(row for result in results for row in result.figures))
    lines = [["", *(result.system for result in results)], ["result", *(result.outcome() for result in results)]]
    lines += [[row, *(result.figures.get(row, "-") for result in results)] for row in rows]
    widths = [max(len(line[column]) for line in lines) for column in range(len(results) + 1)]
    shown = ["| " + " | ".join(cell.ljust(width) for cell, width in zip(line, widths)) + " |" for line in lines]
    shown.insert(1, "|" + "|".join("-" * (width + 2) for width in widths) + "|")
    return "\n".join(shown)
