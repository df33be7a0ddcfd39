# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""What tools/report reads beside the rows of an experiment: a comparison in SUMO, a decision log, paths of vehicles."""

import csv
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from elmopp_tools.sumo_compare import Cell, CompareError, read_cells

PATH_COLUMNS = ("t_s", "approach", "vehicle", "distance_m")
OURS_COLUMNS = (
    "scenario",
    "chooser",
    "best_rival",
    "seeds",
    "delay_s",
    "rival_delay_s",
    "ratio",
    "difference_s",
    "ci_low_s",
    "ci_high_s",
    "not_inserted",
    "rival_not_inserted",
    "teleports",
    "rival_teleports",
    "longest_wait_s",
    "rival_longest_wait_s",
)
LOG_KEYS = ("t_s", "stage", "aspects", "present", "arrived", "forecast")

Table = list[dict[str, str]]


class ReportError(Exception):
    """What is wrong, with which value, and what would be right."""


@dataclass(frozen=True)
class Comparison:
    """The tables of tools/sumo-compare as they stand, and its runs by scenario and controller."""

    standings: Table
    best_rivals: Table
    ours: Table
    cells: list[Cell]


@dataclass(frozen=True)
class Log:
    """A decision log, one entry a second."""

    t_s: list[float]
    stage: list[int]
    aspects: list[str]  # a digit for each group
    present: list[list[float]]  # for each movement
    arrived: list[list[float]]
    forecast: list[list[float]]  # for each approach, the sum of the next 60 s


@dataclass(frozen=True)
class Way:
    """Of one vehicle to the stop line of an approach."""

    approach: str
    vehicle: str
    t_s: list[float]
    distance_m: list[float]


def read_comparison(folder: Path) -> Comparison:
    """standings.csv, best_rivals.csv, comparison.csv and runs.csv."""
    try:
        cells = read_cells(folder / "runs.csv")
    except (CompareError, KeyError, ValueError) as error:
        raise ReportError(f"{folder / 'runs.csv'}: {error}; right would be what tools/sumo-compare wrote") from error
    except OSError as error:
        raise _unreadable(folder / "runs.csv", error, "the folder that tools/sumo-compare wrote") from error
    return Comparison(
        standings=_table(folder / "standings.csv", ("chooser", "mean_ratio", "worst_ratio", "longest_wait_s")),
        best_rivals=_table(folder / "best_rivals.csv", ("scenario", "best_rival", "delay_s")),
        ours=_table(folder / "comparison.csv", OURS_COLUMNS),
        cells=cells,
    )


def read_log(file: Path) -> Log:
    """A decision log with at least one second; each second must tell of as many movements as the first."""
    entries = []
    try:
        with file.open(encoding="utf-8") as stream:
            entries = [_entry(file, number, line) for number, line in enumerate(stream, start=1)]
    except (OSError, UnicodeDecodeError) as error:
        raise _unreadable(file, error, "a decision log of host_sim run --log") from error
    if not entries:
        raise ReportError(f"{file}: is empty; right would be a decision log of host_sim run --log")
    for number, entry in enumerate(entries, start=1):
        for key in ("present", "arrived", "forecast", "aspects"):
            if len(entry[key]) != len(entries[0][key]):
                raise ReportError(
                    f"{file}:{number}: {key} has {len(entry[key])} values; right would be {len(entries[0][key])}"
                )
    return Log(**{key: [entry[key] for entry in entries] for key in LOG_KEYS})


def _entry(file: Path, number: int, line: str) -> dict[str, Any]:
    try:
        entry = json.loads(line)
        if not isinstance(entry, dict):
            raise ValueError("no object")
        missing = [key for key in LOG_KEYS if key not in entry]
        if missing:
            raise ValueError(f"no key {missing[0]}")
        return {
            "t_s": float(entry["t_s"]),
            "stage": int(entry["stage"]),
            "aspects": _digits(entry["aspects"]),
            **{key: [float(value) for value in entry[key]] for key in ("present", "arrived", "forecast")},
        }
    except (ValueError, TypeError) as error:
        raise ReportError(f"{file}:{number}: {error}; right would be a second of a decision log") from error


def _digits(text: Any) -> str:
    if not isinstance(text, str) or not text.isdecimal():
        raise ValueError(f"aspects {text!r}")
    return text


def read_paths(file: Path) -> list[Way]:
    """Vehicles by approach and name, in the order in which they come first."""
    paths: dict[tuple[str, str], Way] = {}
    for number, cells in enumerate(_table(file, PATH_COLUMNS), start=2):
        try:
            t_s, distance_m = float(cells["t_s"]), float(cells["distance_m"])
        except ValueError:
            t_s = distance_m = math.nan
        if not (math.isfinite(t_s) and math.isfinite(distance_m)):
            raise ReportError(f"{file}:{number}: t_s and distance_m are no numbers; right would be 12.0 and 80.5")
        key = cells["approach"], cells["vehicle"]
        path = paths.setdefault(key, Way(*key, [], []))
        path.t_s.append(t_s)
        path.distance_m.append(distance_m)
    return list(paths.values())


def _table(file: Path, columns: Sequence[str]) -> Table:
    try:
        with file.open(encoding="utf-8", newline="") as stream:
            reader = csv.DictReader(stream, strict=True)
            rows = list(reader)
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise _unreadable(file, error, f"a CSV file with the columns {', '.join(columns)}") from error
    missing = [column for column in columns if column not in (reader.fieldnames or ())]
    if missing:
        raise ReportError(f"{file}: no column {missing[0]}; right would be {', '.join(columns)}")
    short = next((number for number, row in enumerate(rows, start=2) if None in row or None in row.values()), None)
    if short is not None:
        raise ReportError(f"{file}:{short}: as many values as columns would be right")
    if not rows:
        raise ReportError(f"{file}: no rows; right would be at least one below the header")
    return rows


def _unreadable(file: Path, error: Exception, right: str) -> ReportError:
    return ReportError(f"{file}: {getattr(error, 'strerror', None) or error}; right would be {right}")
