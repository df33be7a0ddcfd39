# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Holds our choosers against the best rival of each scenario, paired by seed.

The best rival of a scenario is the one with the lowest mean delay over all seeds. It is chosen and written down before
anything of ours is looked at; a rival that left vehicles outside is not better for it, so its count stands beside it.
Intervals are 95 % of Student's t over the seeds' differences: the same seed has the same vehicles.
"""

import csv
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from elmopp_tools.outputs import write
from elmopp_tools.paired import paired
from elmopp_tools.sumo_report import table
from elmopp_tools.tables import label_of

OURS = ("naive", "cumulative", "pressure", "priced", "rollout")


class CompareError(Exception):
    """The comparison cannot be made; the text says what is wrong and what would be right."""


@dataclass(frozen=True)
class Cell:
    """The runs of one controller in one scenario, by seed."""

    scenario: str
    name: str
    delay_s: dict[int, float]
    not_inserted: int
    teleports: int
    longest_wait_s: float
    longest_red_s: float

    @property
    def mean_s(self) -> float:
        """Mean delay over the seeds."""
        return sum(self.delay_s.values()) / len(self.delay_s)


def compare(runs: Path, folder: Path, ours: Sequence[str]) -> None:
    """Writes best_rivals.csv, comparison.csv and standings.csv into a folder, and prints all three."""
    cells = read_cells(runs)
    best = {cell.scenario: cell for cell in _best_rivals(cells, ours)}
    rivals = [_rival_row(cell) for cell in best.values()]
    _write(folder / "best_rivals.csv", rivals)
    rows = [_row(cell, best[cell.scenario]) for cell in cells if _is_ours(cell, ours) and cell.scenario in best]
    if not rows:
        raise CompareError(f"{runs} has no run of {', '.join(ours)} beside a rival ; make the campaign with both")
    rows.sort(key=lambda row: (row["chooser"], row["scenario"]))
    _write(folder / "comparison.csv", rows)
    standings = sorted(_standings(cells, best), key=lambda row: float(row["mean_ratio"]))
    _write(folder / "standings.csv", standings)
    for printed in (rivals, rows, standings):
        _print(printed)


def read_cells(runs: Path) -> list[Cell]:
    """The runs of runs.csv by scenario and controller, in the order of the file."""
    grouped: dict[tuple[str, str], list[dict[str, str]]] = {}
    with runs.open(encoding="utf-8", newline="") as file:
        for run in csv.DictReader(file):
            grouped.setdefault((run["scenario"], label_of(run)), []).append(run)
    return [
        Cell(
            scenario=scenario,
            name=name,
            delay_s={int(run["seed"]): float(run["delay_s"]) for run in members},
            not_inserted=sum(int(run["not_inserted"]) for run in members),
            teleports=sum(int(run["teleports"]) for run in members),
            longest_wait_s=max(float(run["longest_wait_s"]) for run in members),
            longest_red_s=max(float(run["longest_red_s"]) for run in members),
        )
        for (scenario, name), members in grouped.items()
    ]


def _is_ours(cell: Cell, ours: Sequence[str]) -> bool:
    return cell.name.partition(":")[0].partition("@")[0] in ours


def _best_rivals(cells: Iterable[Cell], ours: Sequence[str]) -> list[Cell]:
    best: dict[str, Cell] = {}
    for cell in cells:
        if not _is_ours(cell, ours) and (cell.scenario not in best or cell.mean_s < best[cell.scenario].mean_s):
            best[cell.scenario] = cell
    return list(best.values())


def _rival_row(cell: Cell) -> dict[str, str]:
    return {
        "scenario": cell.scenario,
        "best_rival": cell.name,
        "delay_s": f"{cell.mean_s:.2f}",
        "seeds": str(len(cell.delay_s)),
        "not_inserted": str(cell.not_inserted),
        "teleports": str(cell.teleports),
        "longest_wait_s": f"{cell.longest_wait_s:.0f}",
    }


def _row(cell: Cell, rival: Cell) -> dict[str, str]:
    seeds = sorted(cell.delay_s.keys() & rival.delay_s.keys())
    pair = paired([cell.delay_s[seed] for seed in seeds], [rival.delay_s[seed] for seed in seeds])
    if pair is None:
        raise CompareError(
            f"{cell.name} and {rival.name} share {len(seeds)} seeds in {cell.scenario} ; right would be two at least"
        )
    return {
        "scenario": cell.scenario,
        "chooser": cell.name,
        "best_rival": rival.name,
        "seeds": str(len(seeds)),
        "delay_s": f"{cell.mean_s:.2f}",
        "rival_delay_s": f"{rival.mean_s:.2f}",
        "ratio": f"{cell.mean_s / rival.mean_s:.4f}",
        "difference_s": f"{pair.mean:.2f}",
        "ci_low_s": f"{pair.low:.2f}",
        "ci_high_s": f"{pair.high:.2f}",
        "not_inserted": f"{cell.not_inserted}",
        "rival_not_inserted": f"{rival.not_inserted}",
        "teleports": f"{cell.teleports}",
        "rival_teleports": f"{rival.teleports}",
        "longest_wait_s": f"{cell.longest_wait_s:.0f}",
        "rival_longest_wait_s": f"{rival.longest_wait_s:.0f}",
    }


def _standings(cells: Sequence[Cell], best: dict[str, Cell]) -> Iterator[dict[str, str]]:
    """Everybody beside the best rival of each scenario, who is another one from scenario to scenario: nobody is he.

    Seeds that only one of the two has are left out.
    """
    for name in dict.fromkeys(cell.name for cell in cells):
        members = [cell for cell in cells if cell.name == name and cell.scenario in best]
        ratios = [ratio for cell in members if (ratio := _ratio(cell, best[cell.scenario])) is not None]
        if ratios:
            yield {
                "chooser": name,
                "scenarios": str(len(ratios)),
                "mean_ratio": f"{math.exp(sum(map(math.log, ratios)) / len(ratios)):.3f}",
                "worst_ratio": f"{max(ratios):.3f}",
                "not_inserted": str(sum(cell.not_inserted for cell in members)),
                "teleports": str(sum(cell.teleports for cell in members)),
                "longest_wait_s": f"{max(cell.longest_wait_s for cell in members):.0f}",
            }


def _ratio(cell: Cell, rival: Cell) -> float | None:
    seeds = cell.delay_s.keys() & rival.delay_s.keys()
    if not seeds:
        return None
    return sum(cell.delay_s[seed] for seed in seeds) / sum(rival.delay_s[seed] for seed in seeds)


def _write(file: Path, rows: Sequence[dict[str, str]]) -> None:
    write({file: table(rows, list(rows[0]) if rows else [])})


def _print(rows: Sequence[dict[str, str]]) -> None:
    head = list(rows[0]) if rows else []
    lines = [head, *(list(row.values()) for row in rows)]
    widths = [max(len(line[column]) for line in lines) for column in range(len(head))]
    for line in lines:
        print("  ".join(value.ljust(width) for value, width in zip(line, widths, strict=True)).rstrip())
    print()
