"""The variants to compare: methods, and the default method with one part switched off or in the published form."""
import subprocess
import tomllib
from dataclasses import dataclass
from pathlib import Path

from cases import Case
from constants import Change


@dataclass(frozen=True)
class Variant:
    name: str
    what: str
    arguments: tuple[str, ...] = ()  # arguments of `dvi run`
    fusion: bool = True  # whether source drives are used
    fill: str = ""  # the inpainter whose fill of the unobserved pixels is imported (fill_holes.py); empty: none
    program: Path | None = None  # a program with a changed constant; None: the program under test


DVI = Variant("dvi", "the default", ("--method", "dvi"))

AS_GIVEN = Variant("masks as given", "objects are not completed where masks lack them (`objects.complete=false`)",
                   ("--method", "dvi", "--set", "objects.complete=false"))

METHODS = (
    Variant("telea", "OpenCV's inpainting after Telea: one image", ("--method", "telea")),
    Variant("ns", "OpenCV's Navier-Stokes inpainting: one image", ("--method", "ns")),
    Variant("flow", "propagation along optical flow: images and masks", ("--method", "flow")),
    Variant("paper", "the published form of every stage", ("--method", "paper")),
    Variant("interpolate", "dvi with unobserved pixels interpolated instead of synthesized (`harmonize.unobserved=interpolate`)",
            ("--set", "harmonize.unobserved=interpolate")),
    Variant("dvi-telea", "dvi with unobserved pixels imported from OpenCV's inpainting after Telea (`dvi import-fill`)", fill="telea"),
    Variant("dvi-fsr", "the same, from OpenCV's frequency selective reconstruction", fill="fsr"),
    DVI,
)


def _off(name: str, what: str, option: str) -> Variant:
    return Variant(name, f"{what} (`{option}=false`)", ("--set", f"{option}=false"))


ABLATIONS = (
    _off("no-poisson", "colors as copied, no Poisson blending", "harmonize.poisson"),
    Variant("bp", "belief propagation (`stages.regularize=true`)", ("--set", "stages.regularize=true")),
    _off("no-exposure", "colors of the source frames, no exposure compensation", "stages.exposure"),
    Variant("membrane", "unobserved pixels interpolated equally from all directions (`harmonize.unobserved_vertical=1.0`)",
            ("--set", "harmonize.unobserved_vertical=1.0")),
    _off("no-plane-sweep", "no depth from images beyond the range of the LiDAR", "stages.plane_sweep"),
    Variant("one-source", "one source per pixel (`sample.sources=1`)", ("--set", "sample.sources=1")),
    _off("no-align", "poses as given, no refinement", "stages.align"),
    _off("no-occlusion-test", "copies also from frames in which the point is occluded", "sample.occlusion_test"),
    _off("no-smooth", "no temporal smoothing", "stages.smooth"),
    Variant("no-loam", "poses of the drive, not estimated from the scans (`--poses given`)", ("--poses", "given")),
    Variant("no-fusion", "without the second drive", fusion=False),
)


def options(dvi: Path, method: str) -> dict[str, object]:
    """Every option of a method, the developer's too, as `section.key`, without [job]."""
    dump = subprocess.run([dvi, "config", "dump", "--all", "--method", method], capture_output=True, text=True,
                          check=True).stdout
    tables = tomllib.loads(dump)
    return {f"{table}.{key}": value for table, rows in tables.items() if table != "job" for key, value in rows.items()}


def toml(value: object) -> str:
    """A value as `--set` takes it."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def differences(ours: dict[str, object], published: dict[str, object]) -> list[tuple[str, str, str]]:
    """(option, value of dvi, value of paper) where they differ: the definition of `--method paper`."""
    return [(option, toml(value), toml(published[option])) for option, value in ours.items() if value != published[option]]


def published_switches(differing: list[tuple[str, str, str]]) -> tuple[Variant, ...]:
    """dvi with one of its departures from the paper undone, except those that are variants already."""
    known = {variant.arguments for variant in (*METHODS, *ABLATIONS)}
    switches = {f"{option}={value}": option for option, _, value in differing}
    return tuple(
        Variant(f"paper-{option.replace('.', '-').replace('_', '-')}", f"as published: `{switch}`", ("--set", switch))
        for switch, option in switches.items() if ("--set", switch) not in known
    )


def changed_constant(change: Change, program: Path) -> Variant:
    """dvi, run by a program with another value of a constant."""
    constant = change.constant
    return Variant(change.label, f"constant `{constant.label}` = {change.value} instead of {constant.value} ({constant.file})",
                   program=program)


def applies(variant: Variant, case: Case) -> bool:
    """Without a second drive there is no fusion to leave out."""
    return variant.fusion or bool(case.sources)
