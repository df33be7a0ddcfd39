# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Reads a truth file `lane-count-truth/1`, and refuses what is none before anything runs.

Checked is all that a score or a copy of the clip looks at; other keys are for people.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from elmopp_tools.lane_rules import STEPS, complaints

FORMAT = "lane-count-truth/1"
LEAST_PX, MOST_PX = 16, 16384  # as perception/lanes.cpp


class RequestError(Exception):
    """It cannot be run; the text says what is wrong and what would be right."""


class _WrongError(Exception):
    """Somewhere in the file; the text names the key."""


def _need(found: bool, key: str, value: object, right: str) -> None:
    if not found:
        raise _WrongError(f"{key} is {json.dumps(value)[:60]}; right would be {right}")


def _is_whole(value: object, least: int, most: int | None = None) -> bool:
    return type(value) is int and value >= least and (most is None or value <= most)


def _is_number(value: object) -> bool:
    return type(value) in (int, float)


def _is_points(value: object, least: int, most: int | None = None) -> bool:
    return (
        isinstance(value, list)
        and len(value) >= least
        and (most is None or len(value) <= most)
        and all(isinstance(p, list) and len(p) == 2 and all(_is_number(c) and c >= 0 for c in p) for p in value)
    )


def _lane(lane: Any, key: str) -> None:
    _need(isinstance(lane, dict), key, lane, "a lane with name, line and direction")
    for need in ("name", "line", "direction"):
        _need(need in lane, key, lane, f"a lane with name, line and direction; {need} is missing")
    name = lane["name"]
    _need(isinstance(name, str) and name != "", f"{key}.name", name, "a text")
    _need(_is_points(lane["line"], 2, 2), f"{key}.line", lane["line"], "two points [x, y]")
    _need(lane["direction"] in STEPS, f"{key}.direction", lane["direction"], "up, down, left or right")
    polygon = "a polygon of three points or more"
    _need(_is_points(lane.get("zone", [[0, 0]] * 3), 3), f"{key}.zone", lane.get("zone"), polygon)
    masks = lane.get("mask", [])
    _need(isinstance(masks, list) and all(_is_points(m, 3) for m in masks), f"{key}.mask", masks, "a list of polygons")


def _rows(truth: Mapping[str, Any], key: str, right: str, is_row: Callable[[dict[str, Any]], bool]) -> None:
    rows = truth.get(key, [])
    _need(isinstance(rows, list), key, rows, "a list")
    for i, row in enumerate(rows):
        good = isinstance(row, dict) and _is_whole(row.get("frame"), 0) and is_row(row)
        _need(good, f"{key}[{i}]", row, right)


def _check(truth: Mapping[str, Any]) -> None:
    """Raises _WrongError at the first that is wrong."""
    needed = ("video", "width", "height", "frames", "lanes", "crossings", "count_from", "count_to", "frame_tolerance")
    for key in (*needed, "total", "totals"):
        if key not in truth:
            raise _WrongError(f"{key} is missing")
    _need(isinstance(truth["video"], str) and truth["video"] != "", "video", truth["video"], "the name of a video")
    for key in ("width", "height"):
        _need(_is_whole(truth[key], LEAST_PX, MOST_PX), key, truth[key], f"a whole number from {LEAST_PX} to {MOST_PX}")
    for key in ("frames", "count_from", "count_to", "frame_tolerance", "total"):
        _need(_is_whole(truth[key], 0), key, truth[key], "a whole number from 0 on")
    lanes = truth["lanes"]
    _need(isinstance(lanes, list) and lanes != [], "lanes", lanes, "a list of one lane or more")
    for i, lane in enumerate(lanes):
        _lane(lane, f"lanes[{i}]")
    for complaint in complaints({key: truth[key] for key in ("width", "height", "lanes")}):
        raise _WrongError(complaint)
    _check_counts(truth, {lane["name"] for lane in lanes})


def _check_counts(truth: Mapping[str, Any], names: set[str]) -> None:
    totals = truth["totals"]
    good = isinstance(totals, dict) and set(totals) <= names and all(_is_whole(v, 0) for v in totals.values())
    _need(good, "totals", totals, "a whole number for each lane")
    for key in ("crossings", "uncertain"):
        _rows(truth, key, "a frame and the name of a lane", lambda row: row.get("lane") in names)

    def is_present(row: dict[str, Any]) -> bool:
        return all(key in {*names, "all_lanes", "frame"} and _is_number(v) for key, v in row.items())

    _rows(truth, "present", "a frame and a number for each lane, or for all_lanes", is_present)
    doubt = truth.get("present_uncertainty", 0)
    _need(_is_number(doubt), "present_uncertainty", doubt, "a number of vehicles")


def read_truth(file: Path) -> dict[str, Any]:
    """A truth file; RequestError naming it if it is none."""
    try:
        truth = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise RequestError(f"{file}: cannot be read as JSON: {error}") from None
    if not isinstance(truth, dict) or truth.get("format") != FORMAT:
        raise RequestError(f"{file}: is no truth file; right would be format {FORMAT}")
    try:
        _check(truth)
    except _WrongError as wrong:
        raise RequestError(f"{file}: {wrong}") from None
    return truth
