# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The rules of perception/lanes.cpp about names and geometry, which a schema cannot say.

For lanes whose shape is right: `lanes` as in a lane file, or in a truth file of a clip. Needs nothing but Python.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

LEAST_LINE_PX = 4.0
LEAST_AREA_PX = 16.0
LEAST_ACROSS = 0.3
STEPS = {"up": (0, -1), "down": (0, 1), "left": (-1, 0), "right": (1, 0)}


def complaints(lanes: dict[str, Any]) -> Iterator[str]:
    """What is wrong, in the order of the lanes."""
    names = set()
    for i, lane in enumerate(lanes["lanes"]):
        key = f"lanes[{i}]"
        yield from _outside(lane["line"], f"{key}.line", lanes)
        yield from _across(lane, key)
        if "zone" in lane:
            yield from _polygon(lane["zone"], f"{key}.zone", lanes)
        for k, mask in enumerate(lane.get("mask", [])):
            yield from _polygon(mask, f"{key}.mask[{k}]", lanes)
        if lane["name"] in names:
            yield f'{key}.name "{lane["name"]}" comes twice'
        names.add(lane["name"])
    if "junction" in lanes:
        yield from _polygon(lanes["junction"], "junction", lanes)


def _outside(points: list[list[float]], key: str, lanes: dict[str, Any]) -> Iterator[str]:
    for i, (x, y) in enumerate(points):
        if x > lanes["width"] or y > lanes["height"]:
            yield f"{key}[{i}] is [{x}, {y}], outside of the picture of {lanes['width']} x {lanes['height']}"


def _polygon(points: list[list[float]], key: str, lanes: dict[str, Any]) -> Iterator[str]:
    yield from _outside(points, key, lanes)
    turned = [*points[1:], points[0]]
    if abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(points, turned, strict=True))) / 2 < LEAST_AREA_PX:
        yield f"{key} has no area"


def _across(lane: dict[str, Any], key: str) -> Iterator[str]:
    """Vehicles drive across a line, not along it."""
    (ax, ay), (bx, by) = lane["line"]
    along = math.hypot(bx - ax, by - ay)
    if along < LEAST_LINE_PX:
        yield f"{key}.line is shorter than four pixels"
    if abs(bx - ax if STEPS[lane["direction"]][0] == 0 else by - ay) < LEAST_ACROSS * along:
        yield f"{key}.direction runs along the line of the lane; right would be the way that vehicles cross it"
