# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""Markdown tables from the results of `host_sim experiment`, written between the markers of a document.

A document holds `<!-- table: NAME -->` and `<!-- end of table -->`; what stands between is replaced. Nothing else of
the document is touched. With --check the document must hold already what would be written.
"""

from __future__ import annotations

import argparse
import csv
import json
import re
import statistics
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

RIVALS = ("itlc", "oaf", "fixed", "pressure")
MARKED = re.compile(r"(<!-- table: ([a-z-]+) -->\n).*?(<!-- end of table -->)", re.DOTALL)


class TableError(Exception):
    """The request cannot be met; the text is the one line that the user sees."""


@dataclass(frozen=True)
class Row:
    """One trial."""

    profile: str
    label: str
    vehicles: int
    values: dict[str, float]


@dataclass(frozen=True)
class Results:
    """What an experiment wrote."""

    rows: list[Row]
    claims: list[dict[str, str]]

    def values(self, profile: str, label: str, metric: str, vehicles: int | None = None) -> list[float]:
        return [
            row.values[metric]
            for row in self.rows
            if row.profile == profile and row.label == label and vehicles in (None, row.vehicles)
        ]

    def labels(self, profile: str) -> list[str]:
        return list(dict.fromkeys(row.label for row in self.rows if row.profile == profile))

    def grid(self, profile: str) -> list[int]:
        return sorted({row.vehicles for row in self.rows if row.profile == profile})

    def mean(self, profile: str, label: str, metric: str, vehicles: int | None = None) -> float:
        return statistics.fmean(self.values(profile, label, metric, vehicles))

    def sweep(self, profile: str, chooser: str) -> list[str]:
        return [name for name in self.labels(profile) if name == chooser or name.startswith(chooser + "@")]

    def best(self, profile: str, chooser: str) -> str:
        """The label of the sweep with the least mean delay over all trials."""
        return min(self.sweep(profile, chooser), key=lambda label: self.mean(profile, label, "mean_delay_s"))


def label_of(cells: dict[str, str]) -> str:
    return cells["chooser"] if cells["forecast"] == "none" else f"{cells['chooser']}:{cells['forecast']}"


def read_rows(file: Path) -> list[Row]:
    with file.open(newline="", encoding="utf-8") as stream:
        return [
            Row(
                cells["profile"],
                label_of(cells),
                int(cells["vehicles"]),
                {name: float(text) for name, text in cells.items() if name.endswith("_s") or name == "switches"},
            )
            for cells in csv.DictReader(stream)
        ]


def read_results(folder: Path) -> Results:
    try:
        rows = read_rows(folder / "trials.csv") + read_rows(folder / "beside.csv")
        claims = json.loads((folder / "claims.json").read_text(encoding="utf-8"))
    except (OSError, KeyError, ValueError) as error:
        raise TableError(f"{folder}: {error}; right would be the folder of a whole host_sim experiment") from error
    return Results(rows, claims)


def table(header: Iterable[str], lines: Iterable[Iterable[str]]) -> str:
    names = list(header)
    rule = ["---"] + ["---:"] * (len(names) - 1)
    return "".join("| " + " | ".join(cells) + " |\n" for cells in (names, rule, *lines))


def compared(results: Results, profile: str) -> list[str]:
    """The rows of the paper's table, each rival with the best value of its sweep too."""
    labels = []
    for label in results.labels(profile):
        if "@" in label:
            continue
        labels.append(label)
        best = results.best(profile, label) if label in RIVALS else label
        if best != label:
            labels.append(best)
    return labels


def spread(values: list[float], digits: int) -> str:
    mean = f"{statistics.fmean(values):.{digits}f}"
    return f"{mean} ± {statistics.stdev(values):.{digits}f}" if len(values) > 1 else mean


def main_table(results: Results, profile: str, vehicles: int) -> str:
    lines = []
    for label in compared(results, profile):
        delay = results.values(profile, label, "mean_delay_s", vehicles)
        throughput = results.values(profile, label, "throughput_veh_per_s", vehicles)
        red = results.values(profile, label, "longest_red_s", vehicles)
        switches = results.values(profile, label, "switches", vehicles)
        cells = [spread(throughput, 3), spread(delay, 1), f"{statistics.fmean(red):.0f}", f"{max(red):.0f}"]
        lines.append([f"`{label}`", *cells, f"{statistics.fmean(switches):.0f}"])
    header = ["chooser", "throughput, vehicles/s", "mean delay, s", "longest red, s", "worst, s", "switches"]
    return table(header, lines)


def by_vehicles(results: Results, profile: str, labels: list[str], metric: str, digits: int) -> str:
    grid = results.grid(profile)
    lines = [
        [f"`{label}`", *(f"{results.mean(profile, label, metric, count):.{digits}f}" for count in grid)]
        for label in labels
    ]
    return table(["chooser", *(f"N = {count}" for count in grid)], lines)


def sweeps(results: Results, profile: str) -> str:
    lines = []
    for chooser in RIVALS:
        best = results.best(profile, chooser)
        for label in results.sweep(profile, chooser):
            mark = " (best)" if label == best else ""
            delay = results.mean(profile, label, "mean_delay_s")
            throughput = results.mean(profile, label, "throughput_veh_per_s")
            red = results.mean(profile, label, "longest_red_s")
            lines.append([f"`{label}`{mark}", f"{throughput:.4f}", f"{delay:.1f}", f"{red:.0f}"])
    return table(["chooser", "throughput, vehicles/s", "mean delay, s", "longest red, s"], lines)


def claims_table(results: Results) -> str:
    lines = [
        [f"`{claim['id']}`", claim["claim"], claim["printed"], claim["measured"], claim["verdict"].replace("_", " ")]
        for claim in results.claims
    ]
    rows = [["id", "the paper's claim", "printed", "measured", "verdict"], ["---"] * 5, *lines]
    return "".join("| " + " | ".join(cells) + " |\n" for cells in rows)


TABLES: dict[str, Callable[[Results], str]] = {
    "main-paper": lambda results: main_table(results, "paper", 800),
    "main-saturation": lambda results: main_table(results, "saturation", 600),
    "delay-paper": lambda results: by_vehicles(results, "paper", compared(results, "paper"), "mean_delay_s", 1),
    "delay-saturation": lambda results: by_vehicles(
        results, "saturation", compared(results, "saturation"), "mean_delay_s", 1
    ),
    "sweeps-paper": lambda results: sweeps(results, "paper"),
    "sweeps-saturation": lambda results: sweeps(results, "saturation"),
    "figure": lambda results: by_vehicles(
        results, "figure", results.labels("figure"), "figure_throughput_veh_per_s", 4
    ),
    "literal-throughput": lambda results: by_vehicles(
        results, "literal", results.labels("literal"), "throughput_veh_per_s", 3
    ),
    "literal-switches": lambda results: by_vehicles(results, "literal", results.labels("literal"), "switches", 0),
    "claims": claims_table,
}


def fill(text: str, tables: Mapping[str, Callable[[], str]]) -> str:
    """The text of a document with each marked table made anew."""

    def replacement(match: re.Match[str]) -> str:
        if match[2] not in tables:
            raise TableError(f'unknown table "{match[2]}"; right would be one of {", ".join(tables)}')
        return f"{match[1]}\n{tables[match[2]]()}\n{match[3]}"

    return MARKED.sub(replacement, text)


def parse_arguments(arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="tools/tables",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="Exit codes: 0 done, 1 --check found a document that differs, 2 the request cannot be met.\n\n"
        "Tables: " + " ".join(TABLES),
    )
    parser.add_argument(
        "--results", type=Path, default=Path("out/experiment"), metavar="DIR", help="default: %(default)s"
    )
    parser.add_argument("--check", action="store_true", help="write nothing, compare")
    parser.add_argument("documents", nargs="+", type=Path, metavar="FILE.md")
    return parser.parse_args(arguments)


def update(document: Path, tables: Mapping[str, Callable[[], str]], check: bool) -> bool:
    """True if the document holds, or now holds, these tables."""
    try:
        before = document.read_text(encoding="utf-8")
    except OSError as error:
        raise TableError(f"{document}: {error.strerror}; right would be a Markdown file") from error
    after = fill(before, tables)
    if check and before != after:
        lines = zip(before.splitlines(), after.splitlines(), strict=False)
        number, (old, new) = next((n, pair) for n, pair in enumerate(lines, start=1) if pair[0] != pair[1])
        print(f"{document}:{number}: says\n  {old}\nbut the results say\n  {new}", file=sys.stderr)
        return False
    if before != after:
        building = document.with_suffix(".part")
        building.write_text(after, encoding="utf-8")
        building.replace(document)
    return True


def main(arguments: list[str]) -> int:
    options = parse_arguments(arguments)
    try:
        results = read_results(options.results)
        tables = {name: partial(make, results) for name, make in TABLES.items()}
        good = [update(document, tables, options.check) for document in options.documents]
    except TableError as error:
        print(f"tables: {error}", file=sys.stderr)
        return 2
    return 0 if all(good) else 1
