"""The cost of runs: read from their report.json, combined, and shown as tables."""
from statistics import median

FILL = ("depth", "sample", "regularize", "harmonize", "smooth", "write")


def costs(report):
    """CPU seconds per frame by stage, in the order of the run, and the other figures of cost in a run's report.json.

    The stages of one frame, which `completion` and `fill` call, are below `fill`; the remainder of both is `else`.
    """
    cost, frames = report["cost"], report["cost"]["frames_made"]
    if frames == 0:
        raise ValueError("a run without frames has no cost")
    rows = {}
    for stage in cost["stages"]:
        rows[stage["stage"]] = stage["cpu_seconds"] / frames
        if stage["stage"] == "fill":
            booked = {name: cost["fill"][name]["cpu_seconds"] / frames for name in sorted(cost["fill"], key=fill_order)}
            rows |= {f"  {name}": seconds for name, seconds in booked.items()}
            rows["  else"] = rows.get("completion", 0) + rows["fill"] - sum(booked.values())
    rows["CPU s per frame"] = sum(stage["cpu_seconds"] for stage in cost["stages"]) / frames
    rows["wall s per frame"] = sum(stage["seconds"] for stage in cost["stages"]) / frames
    rows["peak MB"] = cost["peak_memory_bytes"] / 1e6
    rows["hole, 1000 px per frame"] = report["hole"]["pixels"] / frames / 1000
    return rows


def fill_order(stage):
    return (FILL.index(stage) if stage in FILL else len(FILL), stage)


def medians(runs):
    """One row of each name: the median of all runs that have it."""
    names = list(dict.fromkeys(name for run in runs for name in run))
    return {name: median(run[name] for run in runs if name in run) for name in names}


def number(value):
    """Three figures or so, without a power of ten."""
    return f"{value:.3f}" if abs(value) < 10 else f"{value:.1f}" if abs(value) < 1000 else f"{value:.0f}"


def ratio(after, before):
    return f"{after / before:.2f}" if before > 0 else "-"


def cost_table(title, columns):
    """One line per stage, one column per run ({heading: costs}), and the ratio of the last to the first."""
    first, last = list(columns.values())[0], list(columns.values())[-1]
    rows = [[name, *(number(column[name]) if name in column else "-" for column in columns.values()),
             ratio(last[name], first[name]) if name in first and name in last else "-"] for name in medians(columns.values())]
    return table([title, *columns, "last / first"], rows)


def ratio_table(title, names, before, after):
    """One line per row of `before` and `after`, lists of one {row: value} per round: their medians, and the ratio of these with
    the smallest and largest ratio of single rounds, which show the noise."""
    old, new, rows = medians(before), medians(after), []
    for name in medians([*before, *after]):
        if name not in old or name not in new:
            there = old.get(name, new.get(name))
            rows.append([name, *(number(there) if name in side else "-" for side in (old, new)), "-", ""])
            continue
        rounds = [new_round[name] / old_round[name] for old_round, new_round in zip(before, after)
                  if name in new_round and old_round.get(name, 0) > 0]
        spread = f"{min(rounds):.2f}..{max(rounds):.2f}" if len(rounds) > 1 else ""
        rows.append([name, number(old[name]), number(new[name]), ratio(new[name], old[name]), spread])
    return table([title, *names, "ratio", "of single rounds"], rows)


def table(head, rows):
    """The first column to the left, the others to the right, as wide as they need."""
    lines = [head, *rows]
    widths = [max(len(line[column]) for line in lines) for column in range(len(head))]
    cells = [[line[0].ljust(widths[0]), *(cell.rjust(width) for cell, width in zip(line[1:], widths[1:]))] for line in lines]
    return "\n".join("  ".join(line).rstrip() for line in cells)
