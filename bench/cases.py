"""The cases: drives with a truth, each made by commands of dvi that are run in the case's folder."""
from dataclasses import dataclass
from pathlib import Path

FRAMES = 20
SCENARIOS = ("lead", "oncoming", "crossing", "parked", "truck", "far", "banner")
MASK_ERRORS = ("miss", "burst", "late", "tight", "boxes", "false")
STREET = "Synthetic street"


@dataclass(frozen=True)
class Case:
    name: str  # name of its folder
    group: str  # the recording; each has a table on the page
    short: str  # column title there
    what: str
    commands: tuple[tuple[str, ...], ...]  # arguments of dvi that generate it
    truth: str  # folders inside the case's
    ignore: str = ""
    drive: str = "drive"
    sources: tuple[str, ...] = ()  # further drives given to `dvi run`
    ablated: bool = False
    true_masks: str = ""  # folder of the masks of the virtual traffic, inside the case's
    mask_errors: str = ""  # kind of `dvi holdout --mask-errors`; empty: correct masks


@dataclass(frozen=True)
class Recording:
    name: str
    path: Path
    frames: str = ""  # A:B; empty: all


HELD_OUT = {
    "lead": "a car ahead in the own lane",
    "oncoming": "an oncoming car on the left",
    "crossing": "a pedestrian walks across",
    "parked": "a car parked at the right",
    "truck": "a truck ahead at a constant distance",
    "far": "a van 25 to 40 m ahead, in front of the vanishing point",
    "banner": "a rectangle of the image",
}


def street(size: tuple[int, int] = (640, 360), frames: int = FRAMES) -> list[Case]:
    """The synthetic street: exact truth, one difficulty per case."""
    base = ("--width", str(size[0]), "--height", str(size[1]), "--frames", str(frames))

    def synth(folder: str, *more: str) -> tuple[str, ...]:
        return ("synth", "-o", folder, *base, *more)

    def case(short: str, what: str, *commands: tuple[str, ...], sources: tuple[str, ...] = ()) -> Case:
        # The other streets change by about the same amounts; they differ in the methods.
        return Case(f"street-{short}", STREET, short, what, commands, "drive/truth", sources=sources,
                    ablated=short in ("jitter", "two-days"))

    far = ("holdout", "street", "-o", "far", "--scenario", "far", "--seed", "1", "--poses", "given")
    return [
        case("exact", "constant light, exact poses and calibration", synth("drive")),
        case("drift", "the exposure drifts from -12 % to +12 %", synth("drive", "--exposure-drift", "0.12")),
        case("jitter", "yaw and pitch of each image are off by up to 0.15 degrees", synth("drive", "--jitter-deg", "0.15")),
        case("truck", "a truck stays close ahead all the time", synth("drive", "--truck")),
        Case("street-far", STREET, "far", HELD_OUT["far"], (synth("street"), far), "far/truth", "far/ignore", "far/drive"),
        case("two-days", "the same truck; a second drive on another day, in other light, to copy from",
             synth("drive", "--truck"), synth("source", "--day", "2"), sources=("source",)),
    ]


def held_out_case(recording: Recording, scenario: str, errors: str = "") -> Case:
    """Virtual traffic in a real drive: the truth is known behind it."""
    frames = ("--frames", recording.frames) if recording.frames else ()
    # With the given poses of the drive, because the comparison includes the estimation of better ones.
    command = ("holdout", str(recording.path), "-o", ".", "--scenario", scenario, "--seed", "1", "--poses", "given", *frames)
    return Case(f"{recording.name}-{scenario}{errors and '-'}{errors}", recording.name, scenario, HELD_OUT[scenario],
                ((*command, *mask_errors(errors)),), "truth", ignore="ignore", ablated=scenario == "lead" and not errors,
                true_masks="truth_masks", mask_errors=errors)


def held_out(recording: Recording) -> list[Case]:
    return [held_out_case(recording, scenario) for scenario in SCENARIOS]


def mask_errors(kind: str) -> tuple[str, ...]:
    return ("--mask-errors", kind) if kind else ()


def street_masks(size: tuple[int, int] = (640, 360), frames: int = FRAMES) -> list[Case]:
    """Virtual traffic in the synthetic street, with correct masks and with every kind of errors."""
    synth = ("synth", "-o", "street", "--width", str(size[0]), "--height", str(size[1]), "--frames", str(frames))

    def case(scenario: str, errors: str) -> Case:
        hold = ("holdout", "street", "-o", "case", "--scenario", scenario, "--seed", "1", "--poses", "given", *mask_errors(errors))
        return Case(f"street-{scenario}{errors and '-'}{errors}", STREET, scenario, HELD_OUT[scenario], (synth, hold),
                    "case/truth", "case/ignore", "case/drive", true_masks="case/truth_masks", mask_errors=errors)

    return [case(scenario, errors) for scenario in ("lead", "oncoming") for errors in ("", *MASK_ERRORS)]


def held_out_masks(recording: Recording) -> list[Case]:
    """Virtual traffic in a real drive, with correct masks and with three kinds of errors."""
    return [held_out_case(recording, scenario, errors) for scenario in ("lead", "oncoming", "crossing", "parked")
            for errors in ("", "miss", "burst", "boxes")]


def find_recordings(data: Path) -> list[Recording]:
    """KITTI raw drives below a folder, the first frames of each."""
    found = []
    for drive in sorted(data.rglob("*_drive_*_sync")):
        numbers = sorted(int(image.stem) for image in drive.glob("image_02/data/*") if image.stem.isdigit())
        if numbers:
            first = numbers[0]
            last = numbers[: FRAMES][-1]
            found.append(Recording(f"kitti-{drive.name.split('_drive_')[1].removesuffix('_sync')}", drive, f"{first}:{last}"))
    return found


def parse_recording(text: str) -> Recording:
    """NAME=PATH[@A:B]. ValueError otherwise."""
    name, equals, place = text.partition("=")
    path, _, frames = place.partition("@")
    if not (name and equals and path) or "/" in name:
        raise ValueError(f"--drive {text}: expected NAME=PATH or NAME=PATH@A:B")
    if not Path(path).is_dir():
        raise ValueError(f"--drive {text}: {path} is not a folder")
    return Recording(name, Path(path).resolve(), frames)
