# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Draws a lane file on a picture of its camera, without a window."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn

import jsonschema
from PIL import Image, ImageDraw, UnidentifiedImageError

from elmopp_tools.lane_rules import STEPS, complaints
from elmopp_tools.outputs import why

EXIT_DONE = 0
EXIT_REFUSED = 2

SCHEMA = Path(__file__).with_name("lanes_schema.json")
GREEN = (80, 220, 80)
YELLOW = (250, 220, 60)
RED = (230, 70, 60)
ARROW_PX = 14

DESCRIPTION = """\
Draws the lanes of a lane file elmopp-lanes/1 on a picture: counting lines with the way of travel, zones, masks, the
junction."""

EPILOG = """\
Exit codes: 0 done; 2 the request cannot be run.

Example:
  tools/draw-lanes --lanes camera.lanes.json --frame picture.png --out lanes.png"""


class RequestError(Exception):
    """It cannot be run; the text says what is wrong and what would be right."""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        self.exit(EXIT_REFUSED, f"draw-lanes: {message} (draw-lanes --help)\n")


def read_lanes(file: Path) -> dict[str, Any]:
    """A lane file that keeps its schema and the rules of perception/lanes.cpp."""
    try:
        lanes = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise RequestError(
            f"--lanes {file}: cannot be read as JSON: {why(error)}; right would be a lane file"
        ) from None
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    errors = sorted(jsonschema.Draft202012Validator(schema).iter_errors(lanes), key=lambda e: list(map(str, e.path)))
    if errors:
        where = "".join(f"[{p}]" if isinstance(p, int) else f".{p}" for p in errors[0].path).lstrip(".") or "the file"
        raise RequestError(f"--lanes {file}: {where}: {errors[0].message}")
    for complaint in complaints(lanes):
        raise RequestError(f"--lanes {file}: {complaint}")
    return dict(lanes)


def draw(picture: Image.Image, lanes: dict[str, Any]) -> None:
    pen = ImageDraw.Draw(picture)

    def outline(corners: list[list[float]], colour: tuple[int, int, int]) -> None:
        pen.line([tuple(c) for c in [*corners, corners[0]]], fill=colour, width=1)

    for lane in lanes["lanes"]:
        if "zone" in lane:
            outline(lane["zone"], YELLOW)
        for mask in lane.get("mask", []):
            outline(mask, RED)
        (x0, y0), (x1, y1) = lane["line"]
        pen.line([(x0, y0), (x1, y1)], fill=GREEN, width=2)
        x, y = (x0 + x1) / 2, (y0 + y1) / 2
        dx, dy = STEPS[lane["direction"]]
        tip = (x + dx * ARROW_PX, y + dy * ARROW_PX)
        pen.line([(x, y), tip], fill=GREEN, width=2)
        pen.ellipse([tip[0] - 2, tip[1] - 2, tip[0] + 2, tip[1] + 2], fill=GREEN)
        pen.text((min(x0, x1) + 2, min(y0, y1) - 12), lane["name"], fill=GREEN)
    if "junction" in lanes:
        outline(lanes["junction"], YELLOW)


def run(request: argparse.Namespace) -> None:
    lanes = read_lanes(Path(request.lanes))
    try:
        picture = Image.open(request.frame).convert("RGB")
    except (OSError, UnidentifiedImageError) as error:
        raise RequestError(f"--frame {request.frame}: is no picture that can be read: {why(error)}") from None
    if picture.size != (lanes["width"], lanes["height"]):
        size = f"{picture.size[0]} x {picture.size[1]}"
        raise RequestError(
            f"--frame {request.frame}: is {size} and the lane file is for {lanes['width']} x {lanes['height']}"
        )
    draw(picture, lanes)
    try:
        picture.save(request.out, format="PNG")
    except OSError as error:
        raise RequestError(f"--out {request.out}: cannot be written: {error.strerror}") from None


def main(arguments: Sequence[str] | None = None) -> int:
    parser = _Parser(
        prog="draw-lanes",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--lanes", metavar="FILE", required=True, help="lane file elmopp-lanes/1")
    parser.add_argument("--frame", metavar="IMAGE", required=True, help="a picture of the camera")
    parser.add_argument("--out", metavar="PNG", required=True, help="where to draw")
    try:
        run(parser.parse_args(arguments))
    except RequestError as error:
        print(f"draw-lanes: {error}", file=sys.stderr)
        return EXIT_REFUSED
    return EXIT_DONE
