# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The rows of an experiment as tools/plot reads them, and their means with intervals."""

import csv
import json
import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from elmopp_tools.paired import half_width

TEXT_COLUMNS = ("profile", "chooser", "forecast")
COUNT_COLUMNS = ("vehicles", "trial", "seed")
METRIC_COLUMNS = (
    "throughput_veh_per_s",
    "served_share",
    "mean_delay_s",
    "longest_red_s",
    "switches",
    "figure_throughput_veh_per_s",
    "vehicles_in",
    "vehicles_out",
    "vehicles_queued",
    "vehicles_outside",
)
COLUMNS = TEXT_COLUMNS + COUNT_COLUMNS + METRIC_COLUMNS
WAIT_COLUMN = "longest_wait_s"  # of waits.csv, where there are single vehicles

COUNT_PATTERN = re.compile(r"[0-9]{1,20}")
NUMBER_PATTERN = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")
NUMBER_MAX = 1e12  # far above any result, and its square is still a number
SHOWN_LENGTH_MAX = 60


class PlotError(Exception):
    """What is wrong, with which value, and what would be right."""


@dataclass(frozen=True)
class Row:
    """One trial."""

    profile: str
    chooser: str
    forecast: str
    vehicles: int
    trial: int
    seed: int
    metrics: dict[str, float]  # METRIC_COLUMNS, and WAIT_COLUMN where single vehicles drive
    beside: bool = False  # from beside.csv

    @property
    def family(self) -> str:
        """The chooser without its options."""
        return self.chooser.partition("@")[0]

    @property
    def name(self) -> str:
        """As on the command line of host_sim."""
        return self.chooser if self.forecast == "none" else f"{self.chooser}:{self.forecast}"

    @property
    def key(self) -> tuple[str, str, int, int, int]:
        return self.profile, self.name, self.vehicles, self.trial, self.seed


@dataclass(frozen=True)
class Point:
    """The mean over the trials at one number of vehicles; half_width is that of its interval, 0 for a single trial."""

    vehicles: int
    mean: float
    half_width: float
    trials: int


def read_results(folder: Path) -> list[Row]:
    """The rows of trials.csv, with what waits.csv says of them, and of beside.csv, if these are there.

    A trial that is in both tables counts once.
    """
    trials = folder / "trials.csv"
    if not trials.exists():
        raise PlotError(f"{trials}: no such file; right would be the folder that host_sim experiment wrote")
    rows = _read(trials)
    if not rows:
        raise PlotError(f"{trials}:2: no rows; right would be one row a trial below the header")
    waits = folder / "waits.csv"
    if waits.exists():
        longest_s = {row.key: row.metrics[WAIT_COLUMN] for row in _read(waits, (WAIT_COLUMN,))}
        rows = [
            replace(row, metrics={**row.metrics, WAIT_COLUMN: longest_s[row.key]}) if row.key in longest_s else row
            for row in rows
        ]
    beside = folder / "beside.csv"
    if beside.exists():
        rows += [replace(row, beside=True) for row in _read(beside)]
    unique: dict[tuple[str, str, int, int, int], Row] = {}
    for row in rows:
        unique.setdefault(row.key, row)
    return list(unique.values())


def points_of(rows: Iterable[Row], metric: str) -> list[Point]:
    """One point for each number of vehicles, in rising order."""
    values: dict[int, list[float]] = {}
    for row in rows:
        values.setdefault(row.vehicles, []).append(row.metrics[metric])
    return [_point(vehicles, values[vehicles]) for vehicles in sorted(values)]


def trials_of(rows: Iterable[Row], metric: str) -> list[Point]:
    """One point for each trial, by rising number of vehicles."""
    ordered = sorted(rows, key=lambda row: (row.vehicles, row.trial))
    return [Point(row.vehicles, row.metrics[metric], 0.0, 1) for row in ordered]


def _point(vehicles: int, values: list[float]) -> Point:
    return Point(vehicles, math.fsum(values) / len(values), half_width(values), len(values))


def _read(path: Path, metrics: tuple[str, ...] = METRIC_COLUMNS) -> list[Row]:
    try:
        with path.open(encoding="utf-8-sig", newline="") as stream:
            return [_row(path, line, cells, metrics) for line, cells in _records(path, stream, metrics)]
    except UnicodeDecodeError:
        raise PlotError(f"{path}: is no UTF-8 text; right would be a CSV file with a header line") from None
    except OSError as error:
        raise PlotError(f"{path}: {error.strerror}; right would be a file that can be read") from None


def _records(path: Path, stream: Iterable[str], metrics: tuple[str, ...]) -> Iterator[tuple[int, dict[str, str]]]:
    """The lines below the header, each with its number and its cells by column."""
    columns = TEXT_COLUMNS + COUNT_COLUMNS + metrics
    reader = csv.reader(stream, strict=True)
    try:
        header = next(reader, [])
        for column in columns:
            if column not in header:
                raise PlotError(f"{path}:1: no column {column}; right would be {','.join(columns)}")
        for cells in reader:
            if len(cells) != len(header):
                wrong = f"{path}:{reader.line_num}: {len(cells)} values"
                raise PlotError(f"{wrong}; right would be {len(header)} as in the header")
            yield reader.line_num, dict(zip(header, cells, strict=True))
    except csv.Error as error:
        raise PlotError(f"{path}:{reader.line_num}: {error}; right would be a line of CSV") from None


def _row(path: Path, line: int, cells: dict[str, str], metrics: tuple[str, ...]) -> Row:
    for column in TEXT_COLUMNS:
        if not cells[column].isprintable() or not cells[column]:
            raise _wrong_cell(path, line, column, cells[column], "a name")
    for column in COUNT_COLUMNS:
        if not COUNT_PATTERN.fullmatch(cells[column]):
            raise _wrong_cell(path, line, column, cells[column], "a whole number")
    if int(cells["vehicles"]) > NUMBER_MAX:
        raise _wrong_cell(path, line, "vehicles", cells["vehicles"], f"at most {NUMBER_MAX:g}")
    for column in metrics:
        text = cells[column]
        if not NUMBER_PATTERN.fullmatch(text) or abs(float(text)) > NUMBER_MAX:
            raise _wrong_cell(path, line, column, text, f"a number of at most {NUMBER_MAX:g}")
    return Row(
        profile=cells["profile"],
        chooser=cells["chooser"],
        forecast=cells["forecast"],
        vehicles=int(cells["vehicles"]),
        trial=int(cells["trial"]),
        seed=int(cells["seed"]),
        metrics={column: float(cells[column]) for column in metrics},
    )


def _wrong_cell(path: Path, line: int, column: str, value: str, right: str) -> PlotError:
    shown = value if len(value) <= SHOWN_LENGTH_MAX else value[: SHOWN_LENGTH_MAX - 3] + "..."
    return PlotError(f"{path}:{line}, column {column}: {json.dumps(shown)}; right would be {right}")
