"""Writes the tables of the transfer stand-in in docs/results.md from benchmarks/scores/transfer.csv.

    python -m benchmarks.transfer --out OUT
    python -m benchmarks.transfer --out OUT --add
    python -m benchmarks.transfer_page

The first command drives what OUT does not have yet (`--rows transfer` of `benchmarks.campaign` does the same), the
second writes the rows, the third the tables. Rates are over all episodes of the places that a row has, with 95 %
intervals from a bootstrap over places; of fewer than `FEW` places the interval is Wilson's, as if episodes of one place
were independent. Places and rows that are missing are named.
"""

import collections
import csv
import pathlib
import sys
from collections.abc import Mapping, Sequence
from typing import Any

from benchmarks import results, transfer
from benchmarks.lib.transfer_places import FILMED
from urbanverse_mjx.evaluation.metrics import wilson_interval

MARKS = "<!-- transfer: python -m benchmarks.transfer_page -->", "<!-- end of transfer -->"
#: Number of places below which there is no bootstrap over them.
FEW = 8
#: (policy, robot, shift) -> rows of its places.
Rows = dict[tuple[str, str, str], list[dict[str, str]]]


def read(folder: pathlib.Path) -> Rows:
    """Returns the rows of transfer.csv."""
    found: Rows = collections.defaultdict(list)
    with (folder / "transfer.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            found[row["policy"], row["robot"], row["shift"]].append(row)
    return dict(found)


def wanted() -> list[tuple[str, str, str]]:
    """The rows of both tables."""
    rows = [(*tested, "all") for tested in transfer.POLICIES]
    return rows + [(*tested, shift) for tested in transfer.SINGLE for shift in transfer.s.ALONE]


def _cells(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    said = transfer.summary(rows)
    rate, failures = said["SR"], "{:.2f} [{:.2f}, {:.2f}]".format(*said["failures_per_100m"])
    if len(rows) < FEW:
        good = sum(int(r["goal"]) for r in rows)
        rate = [rate[0], *(100.0 * x for x in wilson_interval(good, said["episodes"]))]
        failures = f"{said['failures_per_100m'][0]:.2f}"
    ends = [sum(int(r[end]) for r in rows) for end in transfer.ENDS[1:]]
    return [
        str(said["places"]),
        str(said["episodes"]),
        "{:.1f} [{:.1f}, {:.1f}]".format(*rate),
        failures,
        " / ".join(map(str, ends)),
    ]


_HEAD = ["places", "episodes", "SR, %", "failures per 100 m", "contact / off / fall / time"]


def _markdown(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [f"| {' | '.join(head)} |", f"|{' --- |' * len(head)}"]
    return "\n".join([*lines, *(f"| {' | '.join(row)} |" for row in rows)])


def text(rows: Rows) -> str:
    """Markdown of the part of the page between the marks."""
    titles = {"coco": "COCO", "go2": "Go2"}
    together = [
        [name, titles[robot], *_cells(rows[name, robot, "all"])]
        for name, robot in sorted((*transfer.POLICIES, *transfer.SEEDS, *transfer.FORMER), key=lambda tested: tested[1])
        if (name, robot, "all") in rows
    ]
    alone = [
        [shift, name, *_cells(rows[name, robot, shift])]
        for shift in transfer.s.ALONE
        for name, robot in (*transfer.FORMER, *transfer.SINGLE)
        if (name, robot, shift) in rows
    ]
    parts = []
    if together:
        parts += ["All shifts together:", _markdown(["policy", "robot", *_HEAD], together)]
    if alone:
        parts += ["Each shift alone:", _markdown(["shift", "policy", *_HEAD], alone)]
    absent = [row for row in wanted() if row not in rows]
    partly = [row for row in wanted() if row in rows and len(rows[row]) < len(transfer.place_names())]
    command = "`python -m benchmarks.transfer --out OUT` runs what is missing."
    if absent:
        who: dict[str, list[str]] = {}
        for shift in ("all", *transfer.s.ALONE):
            names = ", ".join(f"{name} ({titles[robot]})" for name, robot, its in absent if its == shift)
            who.setdefault(names, []).append(shift)
        said = "; ".join(f"{', '.join(shifts)}: {names}" for names, shifts in who.items() if names)
        parts.append(f"Not run yet: {said}. {command}")
    missing = sorted(set(FILMED) - set(transfer.place_names()))
    if missing:
        parts.append(
            f"Not filmed yet, so in no row: {', '.join(missing)}; "
            "`python -m benchmarks.transfer_recordings --out benchmarks/transfer_graphs` does it."
        )
    if partly:
        parts.append(
            f"Rows with fewer than {len(transfer.place_names())} places are not finished, or a place had no space for "
            f"routes (left_out.json). {command}"
        )
    return "\n\n".join(parts)


def main() -> int:
    page = results.with_table(results.PAGE.read_text(encoding="utf-8"), text(read(results.SCORES)), MARKS)
    results.PAGE.write_text(page, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
