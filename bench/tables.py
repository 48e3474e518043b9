"""Cells and tables in Markdown."""


def cell(value: float | None, digits: int = 2) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


def percent(value: float) -> str:
    return f"{100 * value:.1f} %"


def interval(figures: dict) -> str:
    """The 95 % interval of the PSNR."""
    return f"{figures['interval']['psnr'][0]:.2f} .. {figures['interval']['psnr'][1]:.2f}" if figures["interval"] else "-"


def delta(value: float | None, base: float | None, digits: int) -> str:
    if value is None or base is None:
        return "-"
    change = round(value - base, digits)
    return f"{change:+.{digits}f}" if change else "0"


def share_of(own: dict | None) -> str:
    """The share of pixels that a method copied, and their PSNR."""
    return f"{percent(own['copied']['share'])}, {cell(own['copied']['psnr'])}" if own and own["copied"]["pixels"] else "-"


def table(header: list[str], rows: list[list[str]], words: int = 1) -> str:
    """The first columns hold words, the others numbers."""
    lines = [header, ["---"] * words + ["---:"] * (len(header) - words), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n"
